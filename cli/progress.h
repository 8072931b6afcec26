#pragma once
// How far long work has come: one line on stderr, only where that is a terminal.
#include <chrono>
#include <functional>
#include <string>
#include <string_view>

#include "cli/global_options.h"

namespace camber::cli {

/// what: a few words ("round 2: carving"); share of it that is done, 0 to 1. To be called from one thread.
using ProgressCallback = std::function<void(std::string_view what, double share)>;

/// Rewrites its line a few times a second and removes it at the end.
class ProgressLine {
 public:
  /// Silent with -q and where stderr is not a terminal.
  explicit ProgressLine(const GlobalOptions& options);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(std::string_view what, double share);
  /// To be called before anything else is printed.
  void clear();
  ProgressCallback callback();

 private:
  using Clock = std::chrono::steady_clock;
  bool enabled_ = false;
  bool shown_ = false;
  std::string what_;
  Clock::time_point begin_, last_;
};

/// " 43 % [##########..............] round 2: carving, 12 s left": seconds_so_far were needed for the share.
std::string progress_text(std::string_view what, double share, double seconds_so_far);

}  // namespace camber::cli
