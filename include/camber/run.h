#pragma once
// What every function that works for long takes: progress, stopping, threads, strictness.
#include <functional>
#include <stop_token>
#include <string_view>

#include "camber/diagnostics.h"

namespace camber {
inline namespace v0 {

struct RunOptions {
  /// Called now and then from the thread that called the library, with a few words ("cutting") and the fraction of
  /// that step that is done, 0 to 1. Returns false to stop: the function then throws Cancelled. May throw; the
  /// exception reaches the caller.
  std::function<bool(std::string_view what, double fraction)> progress{};
  std::stop_token stop{};  ///< a request makes the function throw Cancelled, usually within a tenth of a second
  bool strict = false;     ///< warnings are errors: the function throws InputError where there is one
  int threads = 0;         ///< 0: as many as the computer has. Results do not depend on it
};

/// "0.2.0".
CAMBER_API const char* version();

}  // namespace v0
}  // namespace camber
