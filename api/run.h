#pragma once
// One call of the library: its threads, its stop token, its progress.
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>

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

  /// The command line's settle(): throws where there are errors or, strict, warnings.
  void settle(const Diagnostics& diagnostics) const;

 private:
  const RunOptions& options_;
  std::stop_source stop_;
};

}  // namespace camber::api
