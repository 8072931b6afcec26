#pragma once
// Runs of commands, one after the other: what waits, what goes on and how far, how it ended.
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "ui/commands.h"
#include "ui/process.h"

namespace camber::ui {

/// done: status 0; doubtful: 3, the numbers did not work out; failed: the input or the command line is wrong; crashed:
/// a signal that nobody here has sent.
enum class RunState { queued, running, done, doubtful, failed, cancelled, crashed };
std::string_view name_of(RunState state);

struct CommandRun {
  int id = 0;
  std::string job, name;  ///< names of the job's file and of the command
  Command command{};
  RunState state = RunState::queued;
  std::string step{};                       ///< that goes on
  std::optional<double> share{}, left_s{};  ///< progress of the step: fraction done, seconds left
  int status = -1, signal = 0;
  pid_t pid = -1;
  std::time_t begun = 0, ended = 0;
  nlohmann::json messages = nlohmann::json::array();  ///< as --events writes diagnostics and errors
};

/// With all messages, or only their number.
nlohmann::json json_of(const CommandRun& run, bool with_messages);

/// Takes a line of a process's standard error: progress, or a message that is added to `messages`.
void take_event(std::string_view line, nlohmann::json& messages, CommandRun* progress = nullptr);

/// How a command runs that is over in seconds: `camber ARGUMENTS --events --only-in .` in the folder.
std::vector<std::string> command_line(const std::string& executable, const Command& command);

class Runs {
 public:
  /// `changed` is called from another thread after every change, without a lock.
  Runs(std::string executable, const Folder& folder, std::function<void()> changed);
  /// Stops what goes on; what waits never begins.
  ~Runs();

  int add(std::string job, std::string name, Command command);
  /// false: there is no such run, or it has ended.
  bool cancel(int id);
  std::vector<CommandRun> all() const;
  std::optional<CommandRun> find(int id) const;

  static constexpr std::size_t kMaxRuns = 500;      ///< the oldest that have ended are forgotten
  static constexpr std::size_t kMaxMessages = 500;  ///< most messages that are kept of a run

 private:
  void work();
  void execute(int id);
  void update(int id, const std::function<void(CommandRun&)>& change);
  void finish(int id, const Ended& ended);
  void fail(int id, const std::string& why);

  const std::string executable_;
  const Folder& folder_;
  const std::function<void()> changed_;
  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable wake_;
  std::vector<CommandRun> runs_;
  std::unique_ptr<Process> process_;  ///< process of the run that goes on
  int running_ = 0, last_id_ = 0;
  bool stop_ = false;
  std::thread worker_;
};

}  // namespace camber::ui
