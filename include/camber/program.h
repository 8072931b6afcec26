#pragma once
// An NC program in memory.
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camber/export.h"

namespace camber {
inline namespace v0 {

/// Options for reading where neither the text nor a machine determines them.
struct ReadOptions {
  std::optional<bool> inch{};        ///< unit of a program without G20 and G21; not given: mm, with a warning
  bool skip_slash_blocks = false;    ///< skip blocks that begin with / or /1 to /9
  std::vector<int> skip_switches{};  ///< skip blocks that begin with /N, N = 1 to 9; / is /1
  std::string dialect{};  ///< fanuc, haas, mazak, linuxcnc, ...; empty: the machine's, or what the text shows
  /// X1000 without a point is 1000 least increments (1 mm), not 1000 mm; not given: as the machine has it
  std::optional<bool> least_increments{};
  std::map<int, double> tool_lengths_mm{};  ///< lengths by H, gauge line to tip; to check travel
  /// Machine coordinates of work offsets, by name ("G54", "G59.1", "G54.1P7"): X, Y, Z in mm; A, B, C in degrees may
  /// follow.
  std::map<std::string, std::vector<double>> work_offsets{};
};

/// Blocks that hold a word; cutting moves that are lines and arcs, and their length.
struct ProgramCounts {
  std::size_t blocks = 0, lines = 0, arcs = 0;
  double length_mm = 0;
};

/// A value; copies share the text.
class CAMBER_API Program {
 public:
  /// File name, as used in diagnostics.
  const std::string& path() const;
  const std::string& text() const;

  struct Impl;
  explicit Program(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Reads the file. Errors in the text are reported by the functions that use the program. Throws InputError if the file
/// cannot be read or an option has an invalid value.
CAMBER_API Program read_program(const std::string& path, const ReadOptions& options = {});

/// The same for text in memory; `name` is the file name in diagnostics.
CAMBER_API Program program_from_text(std::string name, std::string text, const ReadOptions& options = {});

}  // namespace v0
}  // namespace camber
