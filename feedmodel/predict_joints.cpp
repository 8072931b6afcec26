#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "base/cancel.h"
#include "base/units.h"
#include "feedmodel/axes.h"
#include "feedmodel/plan.h"
#include "feedmodel/summary.h"
#include "feedmodel/timed_path.h"
#include "kinematics/joint_map.h"

namespace camber::feedmodel {
namespace {

constexpr std::size_t kSamplesTogether = 1024;
/// Joints that jump by more (mm, degrees): the program does not say how the axes went there.
constexpr double kJointJump = 0.1;

/// Samples the segments at the control's period in program coordinates, and sends the joints through the drives.
class JointSampler {
 public:
  JointSampler(const machine::Machine& machine, const nc::Interpretation& program, const JointSampleSink& sink)
      : machine_(machine), map_(machine, program), period_s_(machine.control.period_s), sink_(sink) {}

  /// next_start_s: of the segment after it, which may begin before this one ends.
  void pass(const Segment& segment, const SegmentMotion& motion, const SegmentTime& time, double next_start_s) {
    if (turn_ && turn_->tool_length_mm != segment.turn->tool_length_mm) tip_mm_.reset();  // another tip
    turn_ = segment.turn;
    move_ = segment.move;
    cutting_ = segment.cutting;
    start_at(joints_of(map_, motion.pose_at(segment, 0), *turn_));
    const double moves_until_s = time.start_s + motion.duration_s, end_s = std::min(time.end_s(), next_start_s);
    for (double t = time_of(next_); t < end_s; t = time_of(++next_)) {
      ProgramPose pose = motion.pose_at(segment, t - time.start_s);
      add_rest_of_previous(t, pose);
      put(t, pose, t < moves_until_s ? segment.feed_command_mm_per_s : 0.0);
    }
    end_ = motion.pose_at(segment, motion.duration_s);
    end_joints_ = joints_of(map_, end_, *turn_);
    end_s_ = time.end_s();
    previous_.reset();
    if (next_start_s < moves_until_s) previous_ = {segment, motion, time.start_s};
  }

  /// The command rests; the axes come up.
  void settle() {
    if (!axes_) return;
    const double end_s = end_s_ + joint_settling_time_s(machine_) + period_s_;
    for (double t = time_of(next_); t < end_s; t = time_of(++next_)) put(t, end_, 0.0);
    flush();
  }

  PoseContourFigures contour() const { return errors_.figures(); }

 private:
  struct Overlapping {
    Segment segment;
    SegmentMotion motion;
    double start_s = 0;
  };

  double time_of(std::uint64_t k) const { return static_cast<double>(k) * period_s_; }

  void start_at(const kinematics::Joints& start) {
    if (axes_ && !jumps(start, end_joints_)) return;
    axes_.emplace(machine_, start);
    contour_ = {};
    tip_mm_.reset();
  }

  static bool jumps(const kinematics::Joints& a, const kinematics::Joints& b) {
    return (a.linear_mm - b.linear_mm).norm() > kJointJump ||
           deg_from_rad((a.rotary_rad - b.rotary_rad).norm()) > kJointJump;
  }

  /// Returns the rest of a segment that has not ended yet, as an offset.
  void add_rest_of_previous(double t_s, ProgramPose& pose) const {
    if (!previous_) return;
    const SegmentMotion& motion = previous_->motion;
    const ProgramPose now = motion.pose_at(previous_->segment, t_s - previous_->start_s),
                      end = motion.pose_at(previous_->segment, motion.duration_s);
    pose.xyz_mm += now.xyz_mm - end.xyz_mm;
    pose.rotary_rad += now.rotary_rad - end.rotary_rad;
  }

  void put(double t_s, const ProgramPose& pose, double feed_mm_per_s) {
    const kinematics::Joints command = joints_of(map_, pose, *turn_), actual = (*axes_)(command),
                             velocity = axes_->velocity_per_s();
    samples_.push_back({.t_s = t_s,
                        .command_mm = command.linear_mm,
                        .position_mm = actual.linear_mm,
                        .velocity_mm_per_s = velocity.linear_mm,
                        .feed_command_mm_per_s = feed_mm_per_s,
                        .move = move_});
    JointSample joints{.command_rad = command.rotary_rad,
                       .position_rad = actual.rotary_rad,
                       .velocity_rad_per_s = velocity.rotary_rad,
                       .command_tool = map_.tool(command, turn_->tool_length_mm),
                       .tool = map_.tool(actual, turn_->tool_length_mm)};
    joints.feed_mm_per_s = feed_of(velocity, joints.tool.tip_mm);
    const PoseContour::Error error = contour_(joints.command_tool, joints.tool);
    if (cutting_) errors_.add(error);
    joint_samples_.push_back(joints);
    if (samples_.size() == kSamplesTogether) flush();
  }

  double feed_of(const kinematics::Joints& velocity, const Vec3& tip_mm) {
    const double tip_speed = tip_mm_ ? (tip_mm - *tip_mm_).norm() / period_s_ : 0.0;
    tip_mm_ = tip_mm;
    const double linear = velocity.linear_mm.norm(), turning = deg_from_rad(velocity.rotary_rad.norm());
    switch (turn_->feed) {
      case kinematics::FeedMeaning::degrees:
        return turning;
      case kinematics::FeedMeaning::joints:
        return std::hypot(linear, turning);
      case kinematics::FeedMeaning::linear:
      case kinematics::FeedMeaning::tip:
      case kinematics::FeedMeaning::inverse:
        break;
    }
    return turn_->tip_control ? tip_speed : linear;
  }

  void flush() {
    cancellation_point();
    if (!samples_.empty()) sink_(samples_, joint_samples_);
    samples_.clear();
    joint_samples_.clear();
  }

  const machine::Machine& machine_;
  kinematics::JointMap map_;
  double period_s_;
  const JointSampleSink& sink_;
  std::optional<JointAxes> axes_;
  std::optional<Overlapping> previous_;
  PoseContour contour_;
  PoseContourSum errors_;
  std::vector<TimedSample> samples_;
  std::vector<JointSample> joint_samples_;
  std::shared_ptr<const Turn> turn_;
  std::optional<Vec3> tip_mm_;  // of the last sample
  std::uint64_t next_ = 0;      // sample to come
  ProgramPose end_;             // of the last segment, and its joints
  kinematics::Joints end_joints_;
  double end_s_ = 0;
  std::uint32_t move_ = 0;
  bool cutting_ = false;
};

}  // namespace

FeedSummary predict_joints(const nc::Interpretation& program, const machine::Machine& machine,
                           const JointSampleSink& sink) {
  FeedSum sum(program);
  JointSampler sampler(machine, program, sink);
  follow_motion(program, machine,
                [&](const Segment& segment, const SegmentMotion& motion, const SegmentTime& time, double next_start_s) {
                  sum.add(time);
                  sampler.pass(segment, motion, time, next_start_s);
                });
  sampler.settle();
  FeedSummary summary = sum.summary();
  summary.contour = sampler.contour();
  return summary;
}

}  // namespace camber::feedmodel
