#pragma once
// How far long work has come: one line on stderr, only where that is a terminal.
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "camber/run.h"
#include "cli/global_options.h"

namespace camber::cli {

/// what: a few words ("round 2: carving"); share of it that is done, 0 to 1. To be called from one thread.
using ProgressCallback = std::function<void(std::string_view what, double share)>;

/// Rewrites its line a few times a second and removes it at the end. What takes less than a second is not shown.
/// Steps whose share of work is not known show for how long they have been going on.
class ProgressLine {
 public:
  /// Begins with `what`. Silent with -q and where stderr is not a terminal; with --events lines of JSON instead.
  ProgressLine(const GlobalOptions& options, std::string what);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::string_view what, double share);
  /// The same of several steps together: the time counts from the first of them.
  void show_whole(std::string_view what, double share);
  /// A step whose share of work is not known begins.
  void show(std::string_view what);
  /// To be called before anything else is printed; nothing is shown until the next show().
  void clear();
  ProgressCallback callback();

 private:
  using Clock = std::chrono::steady_clock;
  void take(std::string_view what, std::optional<double> share, bool whole);
  void redraw_until_stopped();
  void draw(Clock::time_point now);

  bool enabled_ = false;
  std::mutex mutex_;  ///< guards all below
  std::condition_variable wake_;
  bool stop_ = false, quiet_ = false, shown_ = false, whole_ = false;
  std::string what_;
  std::optional<double> share_;
  Clock::time_point begin_;
  std::thread drawing_;  ///< steps that never call show() are seen to go on as well
};

/// Options of a call of the library: the line shows its progress, and its warnings are settled as settle() does;
/// `settled`: how many.
RunOptions run_options(ProgressLine& line, const GlobalOptions& options, std::size_t* settled = nullptr);

/// " 43 % [##########..............] round 2: carving, 12 s left": seconds_so_far were needed for the share. Without a
/// share "reading, 12 s so far".
std::string progress_text(std::string_view what, std::optional<double> share, double seconds_so_far);

}  // namespace camber::cli
