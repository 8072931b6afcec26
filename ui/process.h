#pragma once
// A command of Camber as a process of its own: what it does wrong, it does to itself alone.
#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

namespace camber::ui {

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

}  // namespace camber::ui
