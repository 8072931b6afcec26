#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/cancel.h"
#include "feedmodel/axes.h"
#include "feedmodel/plan.h"
#include "feedmodel/summary.h"
#include "feedmodel/timed_path.h"
#include "kinematics/joint_map.h"

namespace camber::feedmodel {
namespace {

constexpr std::size_t kRun = 1024;  // samples handed out at once

/// The path that the segments lay jumps by more than this only where the program does not say where the axes went.
constexpr double kJumpMm = 0.1;

/// Samples the segments at the control's period and sends the commands through the axes.
class Sampler {
 public:
  Sampler(const machine::Machine& machine, const SampleSink& sink)
      : machine_(machine), period_s_(machine.control.period_s), sink_(sink) {
    buffer_.reserve(kRun);
  }

  /// next_start_s: of the segment after it, which may begin before this one ends.
  void pass(const Segment& segment, const SegmentMotion& motion, const SegmentTime& time, double next_start_s) {
    if (!axes_ || (segment.start_mm - end_mm_).norm() > kJumpMm) axes_.emplace(machine_, segment.start_mm);
    const double moves_until_s = time.start_s + motion.duration_s, end_s = std::min(time.end_s(), next_start_s);
    for (double t = time_of(next_); t < end_s; t = time_of(++next_)) {
      const Vec3 command_mm = motion.point_at(segment, t - time.start_s) + left_of_previous(t);
      put(t, command_mm, t < moves_until_s ? segment.feed_command_mm_per_s : 0.0, segment.move);
    }
    end_mm_ = motion.point_at(segment, motion.duration_s);
    end_s_ = time.end_s();
    move_ = segment.move;
    previous_.reset();
    if (next_start_s < moves_until_s) previous_ = {segment, motion, time.start_s};
  }

  /// The command rests; the axes come up.
  void settle() {
    if (!axes_) return;
    const double end_s = end_s_ + settling_time_s(machine_) + period_s_;
    for (double t = time_of(next_); t < end_s; t = time_of(++next_)) put(t, end_mm_, 0.0, move_);
    flush();
  }

 private:
  struct Overlapping {
    Segment segment;
    SegmentMotion motion;
    double start_s = 0;
  };

  double time_of(std::uint64_t k) const { return static_cast<double>(k) * period_s_; }

  /// Returns the rest of a positioning that has not ended yet, as an offset.
  Vec3 left_of_previous(double t_s) const {
    if (!previous_) return Vec3::Zero();
    const SegmentMotion& motion = previous_->motion;
    return motion.point_at(previous_->segment, t_s - previous_->start_s) -
           motion.point_at(previous_->segment, motion.duration_s);
  }

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
    cancellation_point();
    if (!buffer_.empty()) sink_(buffer_);
    buffer_.clear();
  }

  const machine::Machine& machine_;
  double period_s_;
  const SampleSink& sink_;
  std::optional<Axes> axes_;
  std::optional<Overlapping> previous_;
  std::vector<TimedSample> buffer_;
  std::uint64_t next_ = 0;  // sample to come
  Vec3 end_mm_ = Vec3::Zero();
  double end_s_ = 0;
  std::uint32_t move_ = 0;
};

}  // namespace

FeedSummary predict_feed(const nc::Interpretation& program, const machine::Machine& machine, const SampleSink& sink) {
  if (kinematics::has_rotary_motion(program, machine))
    return predict_joints(program, machine,
                          [&](std::span<const TimedSample> samples, std::span<const JointSample>) { sink(samples); });
  FeedSum sum(program);
  Sampler sampler(machine, sink);
  follow_motion(program, machine,
                [&](const Segment& segment, const SegmentMotion& motion, const SegmentTime& time, double next_start_s) {
                  sum.add(time);
                  sampler.pass(segment, motion, time, next_start_s);
                });
  sampler.settle();
  return sum.summary();
}

}  // namespace camber::feedmodel
