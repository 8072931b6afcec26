#pragma once
// Options of all long-running functions: progress, cancellation, threads, strictness.
#include <functional>
#include <stop_token>
#include <string_view>
#include <vector>

#include "camber/diagnostics.h"

namespace camber {
inline namespace v0 {

struct RunOptions {
  /// Called from the calling thread with the name of the current step ("cutting") and its completed fraction, 0 to 1.
  /// Returns false to stop: the function then throws Cancelled. Exceptions propagate to the caller. Last of all, when
  /// the function has succeeded: ("done", 1).
  std::function<bool(std::string_view what, double fraction)> progress{};
  /// `progress` is called with NaN where the fraction of a step is not known; else with 0.
  bool nan_where_unknown = false;
  /// Called from the calling thread, all at once or in parts, with the warnings that are known before the long part of
  /// the work; the result's `diagnostics` begin with them. Exceptions propagate to the caller.
  std::function<void(const std::vector<Diagnostic>& warnings)> warn{};
  std::stop_token stop{};  ///< a request makes the function throw Cancelled, usually within a tenth of a second
  bool strict = false;     ///< warnings are errors: the function throws InputError where there is one
  int threads = 0;         ///< 0: all processors. Results do not depend on it
};

/// "0.3.0".
CAMBER_API const char* version();

}  // namespace v0
}  // namespace camber
