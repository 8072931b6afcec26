#pragma once
// One call of the library: its threads, its stop token, its progress.
#include <chrono>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "camber/run.h"

namespace camber::api {

class Run {
 public:
  explicit Run(const RunOptions& options) : options_(options) {}

  /// Calls `work` on this thread; it and every thread that it uses are stopped by the options' token, by progress that
  /// returns false, and limited to their number of threads. Exceptions of `work` pass through.
  void execute(const std::function<void()>& work);

  /// Tells the caller's progress, and stops where it says so.
  void show(std::string_view what, double fraction);
  std::function<void(const std::string& what, double fraction)> progress();

  /// The same for steps of which the fraction that is done may not be known.
  std::function<void(const std::string& what, std::optional<double> fraction)> steps();

  /// Throws where there are errors or, strict, warnings.
  void settle(const Diagnostics& diagnostics) const;
  /// The same of what is known before the long part of the work: the caller is told.
  void settle_first(const Diagnostics& diagnostics) const;

  /// Since the call began.
  double seconds() const;

 private:
  const RunOptions& options_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::stop_source stop_;
};

/// As they are printed.
std::vector<std::string> texts_of(const Diagnostics& diagnostics);

}  // namespace camber::api
