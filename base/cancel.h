#pragma once
// Long work that a caller may stop (camber/run.h). The stop token belongs to a thread; whoever starts work gives it to
// every thread that works for it, so that calls at the same time do not stop one another.
#include <stop_token>

namespace camber {

/// While it lives, cancellation_point() on this thread asks `token`.
class CancelScope {
 public:
  explicit CancelScope(std::stop_token token);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  std::stop_token before_;
};

/// The same from now on, for threads that work for one caller after another.
void set_stop_token(std::stop_token token);

/// Throws Cancelled where a stop was requested of this thread's work. Takes a few nanoseconds; loops that run for
/// longer than a tenth of a second call it.
void cancellation_point();

}  // namespace camber
