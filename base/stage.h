#pragma once
// How far long work has come: the work names its stages and counts, whoever waits is shown the share.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>
#include <thread>

namespace camber {

/// Receives the stage that runs and the fraction of it that is done, 0 to 1. Called by the thread that opened the
/// StageScope.
using StageSink = std::function<void(const std::string& what, double share)>;

/// During its lifetime the stages that this thread begins are shown to `sink`. A scope inside another one takes its
/// place for a while; with an empty sink it changes nothing.
class StageScope {
 public:
  explicit StageScope(StageSink sink);
  ~StageScope();
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageSink sink_;
  const StageSink* before_;
};

/// A step of long work. A stage that begins while another one of the same thread goes on is part of that one and is not
/// shown.
class Stage {
 public:
  /// total: of the work, in whatever is counted; may be an estimate.
  Stage(std::string what, std::size_t total);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// So much more is done. Thread safe, and a cancellation point (base/cancel.h); the sink is called on the thread that
  /// began the stage alone, a few times a second.
  void advance(std::size_t work = 1);

 private:
  void show();

  std::string what_;
  double total_;
  std::atomic<std::size_t> done_{0};
  const StageSink* sink_;  ///< null: not shown
  std::thread::id thread_;
  std::chrono::steady_clock::time_point shown_;
};

}  // namespace camber
