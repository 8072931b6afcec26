#pragma once
// Reads a Klartext program: from the text to statements and words.
#include <string_view>

#include "base/diagnostics.h"
#include "nc/heidenhain/klartext_tree.h"

namespace camber::nc::heidenhain {

/// Finds the statements of the text and reads the words of those that have some. What is wrong with words is said at
/// them; unknown statements are Kind::refused.
Program read_text(SourceText source, Diagnostics& diagnostics);

/// Returns what to say of a statement that is refused, and the name of the check.
struct Refusal {
  std::string message;
  std::string check;
  std::string alike{};  ///< what counts as the same
};
Refusal refusal_of(std::string_view statement);

}  // namespace camber::nc::heidenhain
