#include "feedmodel/timed_path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "base/cancel.h"
#include "base/units.h"
#include "feedmodel/axes.h"
#include "feedmodel/motion_plan.h"
#include "kinematics/joint_map.h"

namespace camber::feedmodel {
namespace {

/// Summed up from segments in order.
class FeedSum {
 public:
  explicit FeedSum(const nc::Interpretation& program);
  void add(const SegmentTime& time);
  const FeedSummary& summary() const { return summary_; }

 private:
  FeedSummary summary_;
};

std::size_t count_blocks(const nc::Interpretation& program) {
  std::size_t blocks = 0, next_turn = 0;
  std::uint32_t last = nc::Move::kNoArc;
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& move = program.moves[i];
    while (next_turn < program.rotary.size() && program.rotary[next_turn].move < i) ++next_turn;
    const bool turns = next_turn < program.rotary.size() && program.rotary[next_turn].move == i;
    if (move.kind == nc::MoveKind::dwell || move.block == last || (!turns && length_mm(program, move) == 0)) continue;
    ++blocks;
    last = move.block;
  }
  return blocks;
}

FeedSum::FeedSum(const nc::Interpretation& program) { summary_.blocks = count_blocks(program); }

void FeedSum::add(const SegmentTime& time) {
  if (time.cutting) summary_.cutting_time_s += time.end_s() - summary_.time_s;
  summary_.time_s = time.end_s();
}

constexpr double kArm = PoseContour::kAxisArmMm;

double square_distance(const ToolPose& a, const ToolPose& b) {
  return (a.tip_mm - b.tip_mm).squaredNorm() + kArm * kArm * (a.axis - b.axis).squaredNorm();
}

/// The nearest pose between two neighbours.
ToolPose nearest_between(const ToolPose& a, const ToolPose& b, const ToolPose& pose) {
  const double square = square_distance(a, b);
  if (square == 0) return a;
  const double along =
      (pose.tip_mm - a.tip_mm).dot(b.tip_mm - a.tip_mm) + kArm * kArm * (pose.axis - a.axis).dot(b.axis - a.axis);
  const double u = std::clamp(along / square, 0.0, 1.0);
  return {a.tip_mm + u * (b.tip_mm - a.tip_mm), a.axis + u * (b.axis - a.axis)};
}

}  // namespace

PoseContour::Error PoseContour::operator()(const ToolPose& command, const ToolPose& actual) {
  commands_.push_back(command);
  const auto nearer = [&](const ToolPose& a, const ToolPose& b) {
    return square_distance(a, actual) < square_distance(b, actual);
  };
  const auto nearest = std::min_element(commands_.begin(), commands_.end(), nearer);
  // The one before it stays: the nearest place may lie between the two.
  if (nearest != commands_.begin()) commands_.erase(commands_.begin(), nearest - 1);
  ToolPose best = commands_.front();
  for (std::size_t i = 0; i + 1 < std::min<std::size_t>(commands_.size(), 3); ++i) {
    const ToolPose place = nearest_between(commands_[i], commands_[i + 1], actual);
    if (nearer(place, best)) best = place;
  }
  const Vec3 axis = best.axis.normalized();
  return {(actual.tip_mm - best.tip_mm).norm(), std::atan2(axis.cross(actual.axis).norm(), axis.dot(actual.axis))};
}

void PoseContourSum::add(const PoseContour::Error& error) {
  sum_.tip_max_mm = std::max(sum_.tip_max_mm, error.tip_mm);
  sum_.axis_max_rad = std::max(sum_.axis_max_rad, error.axis_rad);
  sum_.tip_rms_mm += error.tip_mm * error.tip_mm;
  sum_.axis_rms_rad += error.axis_rad * error.axis_rad;
  ++count_;
}

PoseContourFigures PoseContourSum::figures() const {
  PoseContourFigures out = sum_;
  if (count_ == 0) return out;
  out.tip_rms_mm = std::sqrt(sum_.tip_rms_mm / static_cast<double>(count_));
  out.axis_rms_rad = std::sqrt(sum_.axis_rms_rad / static_cast<double>(count_));
  return out;
}

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
