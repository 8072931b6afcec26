#pragma once
// Cancellation of long calculations (camber/run.h). Each thread has a stop token; whoever starts threads passes it on,
// so that concurrent calls are independent.
#include <stop_token>

namespace camber {

/// During its lifetime cancellation_point() on this thread checks `token`.
class CancelScope {
 public:
  explicit CancelScope(std::stop_token token);
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  std::stop_token before_;
};

/// Sets the token permanently, for worker threads that serve several callers.
void set_stop_token(std::stop_token token);

/// Throws Cancelled if a stop was requested. Takes a few nanoseconds; to be called in loops that run longer than a
/// tenth of a second.
void cancellation_point();

}  // namespace camber
