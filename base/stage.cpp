#include "base/stage.h"

#include <algorithm>
#include <utility>

#include "base/cancel.h"

namespace camber {
namespace {

constexpr std::chrono::milliseconds kShowEvery{50};

thread_local const StageSink* current_sink = nullptr;
thread_local bool stage_goes_on = false;

}  // namespace

StageScope::StageScope(StageSink sink)
    : sink_(std::move(sink)), before_(std::exchange(current_sink, sink_ ? &sink_ : current_sink)) {}
StageScope::~StageScope() { current_sink = before_; }

Stage::Stage(std::string what, std::size_t total)
    : what_(std::move(what)),
      total_(static_cast<double>(std::max<std::size_t>(total, 1))),
      sink_(stage_goes_on ? nullptr : current_sink),
      thread_(std::this_thread::get_id()) {
  if (!sink_) return;
  show();
  stage_goes_on = true;
}

Stage::~Stage() {
  if (sink_) stage_goes_on = false;
}

void Stage::advance(std::size_t work) {
  cancellation_point();
  done_.fetch_add(work, std::memory_order_relaxed);
  if (!sink_ || std::this_thread::get_id() != thread_ || std::chrono::steady_clock::now() - shown_ < kShowEvery) return;
  show();
}

void Stage::show() {
  shown_ = std::chrono::steady_clock::now();
  (*sink_)(what_, std::min(1.0, static_cast<double>(done_.load(std::memory_order_relaxed)) / total_));
}

}  // namespace camber
