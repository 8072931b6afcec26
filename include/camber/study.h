#pragma once
// A study: one job varied over a grid of its keys, as study.toml says.
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "camber/diagnostics.h"

namespace camber {
inline namespace v0 {

struct StudyCase {
  std::string hash{};                 ///< checksum over all that the result depends on, the same in any study
  std::string job_path{};             ///< its job.toml, for read_job
  std::string folder{};               ///< folder of its files; predict writes its results here
  std::string output{};               ///< the new program of compensate and adapt; empty for predict
  std::string report{};               ///< the case's page
  std::string json{};                 ///< the case's figures: what study.json reads
  std::vector<std::string> values{};  ///< one per key
  bool done = false;                  ///< page and figures are there
  std::string command_line{};         ///< its command for a shell
};

struct Study {
  std::string command{};            ///< "predict", "compensate" or "adapt"
  std::vector<std::string> keys{};  ///< dotted keys of the job
  std::vector<StudyCase> cases{};
  std::vector<Diagnostic> diagnostics{};  ///< warnings
  std::string csv{};                      ///< the table of what is done so far
  std::string json{};                     ///< the same, as `camber study --json` writes it
  std::string page{};                     ///< the same as study.html
  std::string printed{};                  ///< the same, as `camber study` prints it
  std::size_t doubtful = 0;               ///< cases whose numbers did not work out

  /// Reads what has been done since: the table and the cases' `done`.
  CAMBER_API void read_results();

  struct Impl;
  std::shared_ptr<const Impl> impl{};
};

/// Reads a study and writes the job of each case into `folder`; computes nothing. Cases that are done, by this library
/// or by the command line, are known by their hash. Throws InputError.
CAMBER_API Study open_study(const std::string& path, const std::string& folder);

}  // namespace v0
}  // namespace camber
