#pragma once
// The main program and the subprograms beside it: who finds O1234, o<name> sub and N100.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "nc/program_text.h"

namespace camber::nc {

/// A block of one of the files.
struct BlockPlace {
  const Program* file = nullptr;
  std::uint32_t block = 0;
  std::uint32_t part = 0;  ///< part of a divided block: 0 before the first `;`
};

/// Reads subprogram files when they are first asked for: O1234, O1234.nc, 1234.nc, name.ngc and the like, in the main
/// program's folder. What is wrong with such a file goes to the diagnostics.
class ProgramFiles {
 public:
  ProgramFiles(const Program& main, Diagnostics& diagnostics);
  ~ProgramFiles();

  const Program& main() const { return main_; }
  /// The program O1234: in the file itself, in the main program, in a file of its own.
  std::optional<BlockPlace> find_program(const Program& from, std::uint32_t number);
  /// The sub of an O-word: its statement's block.
  std::optional<BlockPlace> find_sub(const Program& from, const std::string& label);
  /// The block N`number` of the program that `from` is in: the next one behind it, else the first one.
  std::optional<std::uint32_t> find_block(BlockPlace from, double number);
  /// Blocks of the file that begin a program (O1234), ascending.
  const std::vector<std::uint32_t>& program_starts(const Program& file);
  /// Number of times each block of the file was run; counts stop at 255.
  std::vector<std::uint8_t>& runs(const Program& file);
  /// Counts begin anew: the program is interpreted once more.
  void forget_runs();

 private:
  struct Index;
  Index& index(const Program& file);
  const Program* file_named(const std::vector<std::string>& names);

  const Program& main_;
  Diagnostics& diagnostics_;
  std::unordered_map<const Program*, std::unique_ptr<Index>> indexes_;
  std::map<std::string, std::unique_ptr<Program>> files_;  ///< files by their first candidate name; null: there is none
};

/// The number of the program that begins in a block, if any: its first word but N is an O.
std::optional<std::uint32_t> program_number(const Program& file, std::uint32_t block);

}  // namespace camber::nc
