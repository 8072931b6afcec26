#pragma once
// Explains words of letters that are no NC words: macro statements, subprograms and the languages of other controls.
#include <string>
#include <string_view>

namespace camber::nc {

struct ForeignWord {
  std::string message;          ///< what it is and what was expected
  std::string check;            ///< name of the check
  bool other_language = false;  ///< the whole file is of another language: reading on makes no sense
};

/// Returns what to say of two or more letters, e.g. "SUPA", "GOTO", "XY"; `name` is in upper case.
ForeignWord explain_letters(std::string_view name);

/// A letter or an address with `=` behind it, e.g. `T="MILL"`, `R1=5`.
ForeignWord explain_assignment(std::string_view address);

}  // namespace camber::nc
