#pragma once
// An NC program in memory.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camber/export.h"

namespace camber {
inline namespace v0 {

/// How the text is to be read, where neither the text nor a machine says so.
struct ReadOptions {
  std::optional<bool> inch{};        ///< unit of a program without G20 and G21; not given: mm, with a warning
  bool skip_slash_blocks = false;    ///< leave out blocks that begin with / or /1 to /9
  std::vector<int> skip_switches{};  ///< leave out blocks that begin with /N, N = 1 to 9; / is /1
  std::string dialect{};          ///< fanuc, haas, mazak, linuxcnc, ...; empty: the machine's, or what the text shows
  bool least_increments = false;  ///< X1000 without a point is 1000 least increments (1 mm), not 1000 mm
};

/// A value; copies share the text.
class CAMBER_API Program {
 public:
  /// The file's name, as it stands in diagnostics.
  const std::string& path() const;
  const std::string& text() const;

  struct Impl;
  explicit Program(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Reads the file. Faults in its text are found by the functions that take the program, together with those of its
/// meaning. Throws InputError where the file cannot be read or an option has no such value.
CAMBER_API Program read_program(const std::string& path, const ReadOptions& options = {});

/// The same for text in memory; `name` stands for the file's name in diagnostics.
CAMBER_API Program program_from_text(std::string name, std::string text, const ReadOptions& options = {});

}  // namespace v0
}  // namespace camber
