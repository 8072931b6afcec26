#pragma once
// Several things are to be done although one of them fails.
#include <exception>
#include <mutex>

namespace camber {

/// Keeps the first exception of several pieces of work, of one thread or of many, until all of them have ended. In a
/// tbb::task_group an exception that leaves a task stops the parallel loops of the others half way, and what they were
/// computing would be written as if it were whole.
class FirstFailure {
 public:
  /// Does `work`; does not throw.
  template <typename Work>
  void guard(const Work& work) noexcept {
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!first_) first_ = std::current_exception();
    }
  }

  /// Throws what the first piece that failed has thrown. Called after all have ended.
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;
};

}  // namespace camber
