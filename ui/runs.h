#pragma once
// Runs of commands, one after the other: what waits, what goes on and how far, how it ended.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <ctime>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <sys/types.h>
#include <nlohmann/json.hpp>

#include "ui/commands.h"

namespace camber::ui {

// A command of Camber as a process of its own: what it does wrong, it does to itself alone.

/// How a process ended.
struct Ended {
  int status = -1;       ///< exit status; -1: a signal ended it
  int signal = 0;        ///< that ended it; 0: none
  bool stopped = false;  ///< stop() was called
};

class Process {
 public:
  /// Starts `arguments[0]` in `folder` with these arguments, in a process group of its own, without input; its standard
  /// output is discarded. It ends with the process that started it. Throws std::runtime_error.
  Process(const std::vector<std::string>& arguments, const std::string& folder);
  /// Stops and waits.
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  /// Waits for the end; `line` gets the lines of its standard error without their ends. To be called once.
  Ended wait(const std::function<void(std::string_view)>& line);
  /// Asks it to end (SIGTERM); wait() ends it for good after kPatience. From any thread.
  void stop();

  static constexpr std::chrono::seconds kPatience{5};

 private:
  void signal(int number);

  pid_t pid_ = -1;
  int errors_ = -1;  ///< its standard error
  std::atomic<bool> stopped_{false};
  std::mutex mutex_;  ///< guards ended_: no signal goes to a number that another process may have by now
  bool ended_ = false;
};

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
