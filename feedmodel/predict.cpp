#include <cmath>
#include <optional>
#include <vector>

#include "feedmodel/axes.h"
#include "feedmodel/path_builder.h"
#include "feedmodel/plan.h"
#include "feedmodel/timed_path.h"

namespace camber::feedmodel {
namespace {

constexpr std::size_t kRun = 1024;  // samples handed out at once

/// Samples the segments at the control's period and sends the commands through the axes.
class Sampler {
 public:
  Sampler(const machine::Machine& machine, const SampleSink& sink)
      : machine_(machine), period_s_(machine.control.period_s), sink_(sink), clock_(machine.control.period_s) {
    buffer_.reserve(kRun);
  }

  void pass(const Segment& segment, const Trapezoid& profile) {
    if (!axes_) axes_.emplace(machine_, segment.start_mm);
    const double start_s = clock_.begin(profile);
    clock_.advance(segment.length_mm > 0 ? profile.duration_s() : segment.dwell_s);
    for (double t = time_of(next_); t < clock_.now_s(); t = time_of(++next_)) {
      const double s = segment.length_mm > 0 ? profile.distance_at(t - start_s) : 0.0;
      put(t, segment.point_at(s), segment.feed_command_mm_per_s, segment.move);
    }
    end_mm_ = segment.point_at(segment.length_mm);
    move_ = segment.move;
  }

  /// The command rests; the axes come up.
  void settle() {
    if (!axes_) return;
    const double end_s = clock_.now_s() + axes_->settling_time_s() + period_s_;
    for (double t = time_of(next_); t < end_s; t = time_of(++next_)) put(t, end_mm_, 0.0, move_);
    flush();
  }

  double time_s() const { return clock_.now_s(); }

 private:
  double time_of(std::uint64_t k) const { return static_cast<double>(k) * period_s_; }

  void put(double t_s, const Vec3& command_mm, double feed_mm_per_s, std::uint32_t move) {
    TimedSample sample;
    sample.t_s = t_s;
    sample.command_mm = command_mm;
    sample.position_mm = (*axes_)(command_mm);
    sample.velocity_mm_per_s = axes_->velocity_mm_per_s();
    sample.feed_command_mm_per_s = feed_mm_per_s;
    sample.move = move;
    buffer_.push_back(sample);
    if (buffer_.size() == kRun) flush();
  }

  void flush() {
    if (!buffer_.empty()) sink_(buffer_);
    buffer_.clear();
  }

  const machine::Machine& machine_;
  double period_s_;
  const SampleSink& sink_;
  std::optional<Axes> axes_;
  std::vector<TimedSample> buffer_;
  PlanClock clock_;
  std::uint64_t next_ = 0;  // sample to come
  Vec3 end_mm_ = Vec3::Zero();
  std::uint32_t move_ = 0;
};

std::size_t count_blocks(const nc::Interpretation& program) {
  std::size_t blocks = 0;
  std::uint32_t last = nc::Move::kNoArc;
  for (const nc::Move& move : program.moves) {
    if (move.kind == nc::MoveKind::dwell || move.block == last || length_mm(program, move) == 0) continue;
    ++blocks;
    last = move.block;
  }
  return blocks;
}

}  // namespace

FeedSummary predict_feed(const nc::Interpretation& program, const machine::Machine& machine, const SampleSink& sink) {
  const std::vector<PlanRow> rows = plan_path(program, machine);
  FeedSummary summary;
  summary.blocks = count_blocks(program);
  Sampler sampler(machine, sink);
  std::size_t i = 0;
  build_segments(program, machine, [&](const Segment& segment) {
    const Trapezoid profile = profile_of(rows, i++);
    if (segment.cutting) summary.cutting_time_s += segment.length_mm > 0 ? profile.duration_s() : segment.dwell_s;
    sampler.pass(segment, profile);
  });
  summary.time_s = sampler.time_s();
  sampler.settle();
  return summary;
}

}  // namespace camber::feedmodel
