#pragma once
// What the page asks for, without HTTP: each function answers one request with JSON.
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "ui/commands.h"
#include "ui/runs.h"

namespace camber::ui {

/// Functions throw Refused, or what Folder throws. Thread safe.
class Bench {
 public:
  /// `changed`: see Runs. The folder outlives it.
  Bench(const Folder& folder, std::string executable, std::function<void()> changed);
  ~Bench();

  /// Presets of machines and materials, commands, the folder's path, the version.
  nlohmann::json about() const;
  /// Every job with its state, its last results and their figures.
  nlohmann::json jobs() const;
  /// Text, settings, programs, files beside it, results.
  nlohmann::json job(const std::string& name) const;
  /// A program that was put in a folder of its own, and the job that camber init made of it.
  nlohmann::json begin(const std::string& program, const Options& options);
  /// A new job in place of the old one, as camber init proposes it.
  nlohmann::json init(const std::string& job, const Options& options);
  /// The job with these lines changed: "set\tTABLE\tKEY\tVALUE", "remove\tTABLE\tKEY", "confirm\tTABLE\tKEY". Written
  /// only where the job can be read then; else Refused 422, and the messages say why.
  nlohmann::json edit(const std::string& job, const std::string& edits);
  /// The same with a whole text.
  nlohmann::json replace(const std::string& job, const std::string& text);
  /// camber check of a job. A check of it that still goes on is stopped.
  nlohmann::json check(const std::string& job);
  nlohmann::json check_program(const std::string& program, const Options& options);
  /// Queues a run.
  nlohmann::json run(const std::string& job, const std::string& command, const Options& options);
  nlohmann::json runs() const;
  nlohmann::json run(int id) const;
  nlohmann::json cancel(int id);
  /// Hunks between two programs of the folder.
  nlohmann::json difference(const std::string& before, const std::string& after) const;

 private:
  struct Outcome {
    Ended ended;
    nlohmann::json messages = nlohmann::json::array();
  };
  Outcome do_now(const Command& command, const std::string& key = {});
  nlohmann::json checked(const Command& command, const std::string& stem, const std::string& key);
  nlohmann::json save(const std::string& job, const std::string& text);
  std::string next_stem();

  const Folder& folder_;
  const std::string executable_;
  std::mutex mutex_;                                                       ///< guards the two below
  std::map<std::string, std::shared_ptr<Process>, std::less<>> going_on_;  ///< what the next of its key stops
  int last_stem_ = 0;
  std::mutex saving_;  ///< one edit after the other
  Runs runs_;
};

// Two programs line by line: which lines of the one stand in place of which lines of the other.

/// `before_lines` lines from `before` on are replaced by `after_lines` lines from `after` on; from 0.
struct Hunk {
  std::size_t before = 0, before_lines = 0, after = 0, after_lines = 0;
  bool operator==(const Hunk&) const = default;
};

/// The hunks that differ, in order; between hunks the texts are equal, line for line. Lines that both programs have
/// once, in the same order, anchor the comparison (patience diff); time and memory grow with the number of lines.
std::vector<Hunk> difference(std::string_view before, std::string_view after);

}  // namespace camber::ui
