#include "feedmodel/path_builder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/cancel.h"
#include "base/units.h"
#include "feedmodel/axis_places.h"
#include "feedmodel/corner.h"
#include "feedmodel/limits.h"
#include "feedmodel/modes.h"
#include "feedmodel/move_turns.h"
#include "feedmodel/overlap.h"
#include "feedmodel/rapid.h"
#include "feedmodel/rests.h"
#include "feedmodel/yan_shirase.h"

namespace camber::feedmodel {
namespace {

using machine::CornerLaw;
using machine::kNoLimit;

/// LinuxCNC, G64 without P: the rounding may reach this fraction of the shorter side (and never past its middle).
constexpr double kOpenToleranceFraction = 0.25;
/// A block gives at most this fraction of its length to the rounding of one end.
constexpr double kBlendRoomFraction = 0.5;
/// 1 + cos of the angle between the directions under which the corner is a reversal: the axes stop.
constexpr double kReversal = 1e-6;
/// Shorter pieces than this (mm) are rounding of numbers, not path.
constexpr double kNoLength = 1e-9;

/// A block (or a run of merged blocks) before its ends are rounded.
struct Element {
  Segment segment;
  bool line = true;
  const machine::Control* settings = nullptr;  ///< the control's, in the mode that the program has selected
  nc::PathControl control = nc::PathControl::blend;
  double tolerance_mm = 0;
  bool stops = false;           ///< G9
  bool taps = false;            ///< runs in synchronism with the spindle, from rest to rest
  double from_s = 0;            ///< length at which the rounding at its start ends
  double less_fraction = 0;     ///< fraction of its acceleration reserved for the speed steps at corners
  double planned_fraction = 1;  ///< fraction of its acceleration that the lookahead counts on
  /// The limits count for its joints, which are not its X Y Z: under tool-centre-point control, unless the control does
  /// not look at them.
  bool joint_limits = false;

  bool turns() const { return segment.turn && segment.turn->turns(); }
};

/// Transition from one element to the next.
struct Junction {
  double speed_mm_per_s = 0;
  double less_fraction = 0;
  double wait_s = 0;  ///< time of a stop
  std::optional<Blend> blend;
  double trim = 0;        ///< length that a turning rounding takes off; 0: none
  bool overlaps = false;  ///< the next element begins while this one brakes, from this speed at most
  double overlap_speed_mm_per_s = kNoLimit;
};

double axis_speed_limit(const Segment& s, const Vec3& velocity) {
  if (s.radius_mm == 0) return limit_along(s.along, velocity);
  const Vec3 normal = s.along.cross(s.across);
  const double in_plane = s.in_plane();
  return std::min(limit_in_plane(normal, velocity) / in_plane, limit_along(s.rise, velocity));
}

/// Limits of an arc. Along it a fraction of the acceleration is left beside the one that turns the motion: the
/// given share where the axes could reach the speed at which the turning takes its whole share, else
/// sqrt(1 - (v^2 / (r a))^2) with the axes' top speed v.
void set_arc_limits(Segment& s, const Vec3& acceleration, const machine::Control& control) {
  const Vec3 normal = s.along.cross(s.across);
  const double in_plane = s.in_plane();
  const double plane = std::min(limit_in_plane(normal, acceleration), control.path_acceleration_mm_per_s2);
  const double a = std::min({limit_in_plane(normal, acceleration) / in_plane, limit_along(s.rise, acceleration),
                             control.path_acceleration_mm_per_s2});
  const double rise_per_rad = s.rise.norm() / s.turn_rad_per_mm;
  const double curvature_radius = helix_curvature_radius(s.radius_mm, rise_per_rad);
  const double turning = arc_speed(curvature_radius, plane, control.arc_normal_fraction);
  double fraction = control.arc_tangential_fraction;
  if (s.speed_limit_mm_per_s < turning && !std::isinf(a)) {
    const double used = s.speed_limit_mm_per_s * s.speed_limit_mm_per_s / (curvature_radius * a);
    fraction = std::max(fraction, std::sqrt(std::max(0.0, 1.0 - used * used)));
  } else if (control.kind.helix_rise_frees_acceleration && rise_per_rad > 0 && fraction < 1) {
    // The traced helices leave more to the path the more the whole arc rises (not the rise of one radian).
    const double used =
        control.arc_normal_fraction / (helix_curvature_radius(s.radius_mm, s.rise.norm() * s.length_mm) / s.radius_mm);
    fraction = std::max(fraction, std::sqrt(std::max(0.0, 1.0 - used * used)));
  }
  s.acceleration_mm_per_s2 = std::isinf(a) ? a : a * fraction;
  s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, turning);
}

/// The control's own limits on a programmed arc, beside those of its axes. Source: Takata 1999, eqs. 2.9, 2.10.
void set_control_arc_limits(Segment& s, const machine::Machine& machine) {
  const machine::Cycle& cycle = machine.cycle;
  const double r = helix_curvature_radius(s.radius_mm, s.rise.norm() / s.turn_rad_per_mm);
  s.acceleration_mm_per_s2 = std::min(s.acceleration_mm_per_s2, cycle.arc_acceleration_mm_per_s2);
  s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, arc_speed(r, cycle.arc_acceleration_mm_per_s2, 1));
  if (std::isinf(cycle.arc_tolerance_mm)) return;
  for (const machine::Axis& axis : machine.axis)
    s.speed_limit_mm_per_s =
        std::min(s.speed_limit_mm_per_s, arc_servo_speed(r, cycle.arc_tolerance_mm, axis.position_gain_per_s,
                                                         axis.feed_forward_percent, cycle.arc_loop_factor));
}

Vec3 speed_differences_mm_per_s(const machine::Machine& machine, const machine::Corner& corner) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) {
    const double own = machine.axis[i].speed_difference_mm_per_s;
    out[i] = std::isinf(own) ? corner.speed_difference_mm_per_s : own;
  }
  return out;
}

/// Returns the speed difference of rotary axes: each one's own, or the number of the corner law in degrees.
Vec3 rotary_differences_rad_per_s(const machine::Machine& machine, const machine::Corner& corner) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) {
    const double own = machine.rotary[static_cast<std::size_t>(i)].speed_difference_rad_per_s;
    out[i] = std::isinf(own) ? rad_from_deg(corner.speed_difference_mm_per_s) : own;
  }
  return out;
}

class Builder {
 public:
  Builder(const nc::Interpretation& program, const machine::Machine& machine, const SegmentSink& sink)
      : program_(program),
        machine_(machine),
        control_(machine.control),
        sink_(sink),
        rests_(rests_of(program, machine.cycle)),
        velocity_(velocity_limits_mm_per_s(machine)),
        acceleration_(acceleration_limits_mm_per_s2(machine)),
        rapid_velocity_(rapid_speeds_mm_per_s(machine)),
        rapid_acceleration_(rapid_accelerations_mm_per_s2(machine)),
        feed_factor_(machine.cycle.feed_override_percent / 100.0),
        places_(machine, kinematics::has_rotary_motion(program, machine)) {
    if (kinematics::has_rotary_motion(program, machine)) turns_.emplace(program, machine);
  }

  void run() {
    const auto& moves = program_.moves;
    int tool = moves.empty() ? 0 : program_.state_of(moves.front()).tool;
    std::size_t next_rest = 0;
    bool tip_control = false;
    std::optional<double> tool_length_mm;
    for (std::size_t i = 0; i < moves.size();) {
      cancellation_point();
      const nc::Move& move = moves[i];
      const nc::ModalState& state = program_.state_of(move);
      turning_ = turns_ && turns_->at(i).turns();
      const bool asked = next_rest < rests_.size() && rests_[next_rest] <= i;
      while (next_rest < rests_.size() && rests_[next_rest] <= i) ++next_rest;
      // X, Y and Z get another meaning: the control stops where axes are turned.
      const bool switched = (state.tip_control != nc::TipControl::off) != tip_control;
      tip_control ^= switched;
      const bool other_length = tool_length_mm && state.tool_length_mm != tool_length_mm;
      tool_length_mm = state.tool_length_mm;
      if (turns_ && (other_length || (switched && turns_->at(i).start_rad != Vec3::Zero()))) rest(0, i, move.start_mm);
      if (state.tool != tool || asked) rest(0, i, move.start_mm);
      tool = state.tool;
      std::size_t end = i + 1;
      const AxisPlaces::Way way = places_.pass(move);
      if (move.kind == nc::MoveKind::dwell) {
        rest(move.dwell_s, i, move.start_mm);
      } else if (unplaced(move) && turning_ && move.kind == nc::MoveKind::rapid) {
        turn_to_reference(i, way);
      } else if (unplaced(move) || (dog_leg_ && move.kind == nc::MoveKind::rapid && !moves_together(state))) {
        position(i, way);
      } else {
        end = run_end(i, state);
        if (next_rest < rests_.size()) end = std::min<std::size_t>(end, rests_[next_rest]);
        for (std::size_t k = i + 1; k < end; ++k) places_.pass(moves[k]);
        add(i, end);
      }
      i = end;
    }
    if (!moves.empty()) rest(0, moves.size() - 1, moves.back().end_mm, false, true);
  }

 private:
  /// Returns whether the move's start or end is not known, and kinematics::place_moves has not assumed one.
  bool unplaced(const nc::Move& move) const { return move.reference && !(turns_ && has_placed_ends(move)); }

  /// A positioning of which the axes end together: one that turns, or under tool-centre-point control.
  bool moves_together(const nc::ModalState& state) const {
    return turns_ && (turning_ || state.tip_control != nc::TipControl::off);
  }

  /// Returns the index after the last move that is driven as one with move i. Moves that turn are not merged.
  std::size_t run_end(std::size_t i, const nc::ModalState& state) const {
    if (turning_) return i + 1;
    const std::span<const nc::Move> moves = program_.moves;
    const std::size_t end = turns_ ? turns_->next_turning(i + 1, moves.size()) : moves.size();
    return merged_run_end(moves.first(end), i, merge_tolerance_mm(state, settings_of(machine_, state)));
  }

  void add(std::size_t first, std::size_t end) {
    Element element = element_of(first, end);
    if (element.segment.length_mm < kNoLength) return;
    if (previous_) join(*previous_, element);
    if (positioned_ && element.segment.cutting && control_.rapid_change_s > 0)
      wait(control_.rapid_change_s, *positioned_);
    positioned_.reset();
    previous_ = element;
  }

  /// A positioning with every axis on its own, from rest to rest.
  void position(std::size_t move, const AxisPlaces::Way& way) {
    const bool rapid = program_.moves[move].kind == nc::MoveKind::rapid;
    Segment s = line_segment(way.from_mm, way.to_mm);
    if (turns_) s.turn = turns_->rest(true);
    if (!rapid || s.length_mm < kNoLength) {
      if (unplaced(program_.moves[move])) rest(0, move, way.to_mm, true, true);
      return;
    }
    if (previous_) {
      const bool cutting = previous_->segment.cutting;
      emit(*previous_, previous_->segment.length_mm,
           previous_->segment.acceleration_mm_per_s2 * (1.0 - previous_->less_fraction));
      if (cutting && control_.rapid_change_s > 0) wait(control_.rapid_change_s, previous_->segment);
      previous_.reset();
    }
    s.axes_apart = true;
    s.way_mm = way.to_mm - way.from_mm;
    s.axis_speed_mm_per_s = rapid_velocity_;
    if (program_.moves[move].creeps)
      s.axis_speed_mm_per_s = rapid_velocity_.cwiseMin(machine_.cycle.creep_feed_mm_per_s);
    s.axis_acceleration_mm_per_s2 = rapid_acceleration_;
    s.feed_command_mm_per_s = limit_along(s.along, rapid_velocity_);
    s.move = static_cast<std::uint32_t>(move);
    sink_(s);
    positioned_ = s;
  }

  /// On a way to or from a reference point rotary axes turn, together with the axes whose way is known.
  void turn_to_reference(std::size_t move, const AxisPlaces::Way& way) {
    rest(0, move, way.from_mm);
    previous_ = element_between(move, move + 1, way.from_mm, way.to_mm);
    rest(0, move, way.to_mm, true, true);
  }

  Element element_of(std::size_t first, std::size_t end) const {
    return element_between(first, end, program_.moves[first].start_mm, program_.moves[end - 1].end_mm);
  }

  Element element_between(std::size_t first, std::size_t end, const Vec3& from_mm, const Vec3& to_mm) const {
    const nc::Move& move = program_.moves[first];
    const nc::Move& last = program_.moves[end - 1];
    const nc::ModalState& state = program_.state_of(move);
    Element e;
    e.line = move.arc == nc::Move::kNoArc;
    if (e.line) {
      e.segment = line_segment(from_mm, to_mm);
    } else {
      const nc::Arc& arc = program_.arcs[move.arc];
      const auto radius_at = [&](const Vec3& p) { return arc.normal.cross(p - arc.center_mm).norm(); };
      e.segment = arc_segment(from_mm, arc.center_mm, arc.normal, arc.sweep_rad,
                              arc.normal.dot(move.end_mm - move.start_mm), radius_at(to_mm) - radius_at(from_mm));
    }
    if (turns_) set_turn(e, from_mm);
    e.segment.mode = static_cast<std::uint8_t>(mode_of(machine_, state));
    e.settings = &settings_of(machine_, std::size_t{e.segment.mode});
    e.control = path_control_of(machine_, state);
    e.tolerance_mm = state.blend_tolerance_mm > 0 ? state.blend_tolerance_mm : e.settings->corner.tolerance_mm;
    e.stops = last.exact_stop;
    e.taps = move.kind == nc::MoveKind::linear && (move.cycle == 84 || move.cycle == 74);
    e.segment.exact = e.stops || e.control == nc::PathControl::exact_stop;
    e.segment.move = static_cast<std::uint32_t>(end - 1);
    if (e.segment.length_mm >= kNoLength) set_limits(e, move);
    return e;
  }

  /// The rotary axes along the element; where only they move, its length is in degrees.
  void set_turn(Element& e, const Vec3& from_mm) const {
    Segment& s = e.segment;
    if (s.length_mm < kNoLength && turning_) {
      const kinematics::MoveJoints& now = turns_->now();
      s.along = Vec3::Zero();
      s.length_mm = deg_from_rad((now.end_rad - now.start_rad).norm());
    }
    s.turn = turns_->turn_along(s.length_mm);
    e.joint_limits = s.turn->tip_control && control_.joint_limits && s.length_mm >= kNoLength;
    s.start_mm = from_mm;
  }

  void set_limits(Element& e, const nc::Move& move) const {
    if (e.joint_limits) {
      set_open_limits(e, move);
    } else {
      set_axis_limits(e, move);
      if (e.turns()) limit_rotary_axes(e);
    }
    set_feed(e, move);
  }

  /// Limits of the joints follow when the element is handed out (hand_out_within_limits).
  void set_open_limits(Element& e, const nc::Move& move) const {
    Segment& s = e.segment;
    s.cutting = move.kind != nc::MoveKind::rapid;
    s.speed_limit_mm_per_s = s.axis_limit_mm_per_s = kNoLimit;
    s.acceleration_mm_per_s2 = e.settings->path_acceleration_mm_per_s2;
    if (s.cutting)
      s.acceleration_mm_per_s2 = std::min(s.acceleration_mm_per_s2, machine_.cycle.linear_acceleration_mm_per_s2);
    if (s.radius_mm > 0) set_control_arc_limits(s, machine_);
  }

  void limit_rotary_axes(Element& e) const {
    Segment& s = e.segment;
    const JointLimits& limits = s.cutting ? feed_limits_ : rapid_limits_;
    const AxisValues rate{Vec3::Zero(), s.turn->rate};
    s.axis_limit_mm_per_s = std::min(s.axis_limit_mm_per_s, limit_along_joints(rate, limits.speed));
    s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, s.axis_limit_mm_per_s);
    s.acceleration_mm_per_s2 = std::min(s.acceleration_mm_per_s2, limit_along_joints(rate, limits.acceleration));
  }

  void set_axis_limits(Element& e, const nc::Move& move) const {
    Segment& s = e.segment;
    s.cutting = move.kind != nc::MoveKind::rapid;
    s.speed_limit_mm_per_s = s.axis_limit_mm_per_s = axis_speed_limit(s, s.cutting ? velocity_ : rapid_velocity_);
    if (s.radius_mm == 0) {
      s.acceleration_mm_per_s2 = std::min(limit_along(s.along, s.cutting ? acceleration_ : rapid_acceleration_),
                                          e.settings->path_acceleration_mm_per_s2);
      if (s.cutting)
        s.acceleration_mm_per_s2 = std::min(s.acceleration_mm_per_s2, machine_.cycle.linear_acceleration_mm_per_s2);
    } else {
      set_arc_limits(s, acceleration_, *e.settings);
      set_control_arc_limits(s, machine_);
    }
  }

  double feed_of(const nc::Move& move) const {
    if (!turns_) return move.feed_mm_per_s;
    const kinematics::MoveJoints& now = turns_->now();
    return kinematics::feed_along_path(program_, move, now.end_rad - now.start_rad, now.g93_time_s, control_);
  }

  void set_feed(Element& e, const nc::Move& move) const {
    Segment& s = e.segment;
    const double feed = feed_of(move) * feed_factor_;
    s.feed_command_mm_per_s = s.cutting ? feed : s.speed_limit_mm_per_s;
    s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, block_time_speed(s.length_mm, e.settings->block_time_s));
    if (s.cutting) s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, feed);
    if (move.creeps) s.speed_limit_mm_per_s = std::min(s.speed_limit_mm_per_s, machine_.cycle.creep_feed_mm_per_s);
    if (e.taps) limit_to_spindle(s, program_.state_of(move).spindle_speed_rpm);
  }

  /// A tap feeds in step with the spindle, which runs up and stops within each stroke.
  void limit_to_spindle(Segment& s, double spindle_speed_rpm) const {
    const double start_s = spindle_start_s(machine_.spindle, spindle_speed_rpm);
    if (start_s > 0) s.acceleration_mm_per_s2 = std::min(s.acceleration_mm_per_s2, s.speed_limit_mm_per_s / start_s);
  }

  // --- corners ---------------------------------------------------------------------------------------------

  /// The speed steps that the axes take in one period without being asked to round the corner.
  Junction step_junction(const Element& a, const Element& b, const Vec3& from, const Vec3& to) const {
    Junction j;
    const double fraction = a.settings->corner.step_fraction;
    const double arc_factor = a.line && b.line ? 1.0 : 0.5;
    Vec3 permitted = Vec3::Zero();
    if (fraction > 0) permitted = fraction * arc_factor * control_.period_s * acceleration_;
    j.speed_mm_per_s = speed_difference_limit(from, to, permitted);
    // A step that is less than what the path gains in a period is none: the control stops and starts anew.
    const double least = std::min(a.segment.acceleration_mm_per_s2, b.segment.acceleration_mm_per_s2);
    if (j.speed_mm_per_s < least * control_.period_s) j.speed_mm_per_s = 0;
    const double reference = std::min(a.segment.speed_limit_mm_per_s, b.segment.speed_limit_mm_per_s);
    j.less_fraction = fraction * (j.speed_mm_per_s > reference ? reference / j.speed_mm_per_s : 1.0);
    return j;
  }

  Junction blend_junction(const Element& a, const Element& b, const Vec3& from, const Vec3& to) const {
    BlendOptions options;
    const double shorter = std::min(a.segment.length_mm, b.segment.length_mm);
    options.tolerance_mm = std::min(a.tolerance_mm, b.tolerance_mm);
    if (std::isinf(options.tolerance_mm)) options.tolerance_mm = kOpenToleranceFraction * shorter;
    options.room_mm = std::min(kBlendRoomFraction * shorter, a.segment.length_mm - a.from_s);
    options.goal_speed_mm_per_s = std::max(a.segment.feed_command_mm_per_s, b.segment.feed_command_mm_per_s);
    options.normal_fraction = a.settings->arc_normal_fraction;
    options.velocity_mm_per_s = velocity_;
    options.acceleration_mm_per_s2 = acceleration_.cwiseMin(a.settings->path_acceleration_mm_per_s2);
    Junction j;
    j.blend = blend_corner(from, to, options);
    if (j.blend)
      j.speed_mm_per_s = j.blend->speed_mm_per_s =
          std::min(j.blend->speed_mm_per_s, std::max(a.segment.speed_limit_mm_per_s, b.segment.speed_limit_mm_per_s));
    return j;
  }

  /// Handles a transition without a corner: only the limits of the two sides apply.
  static Junction pass() {
    Junction j;
    j.speed_mm_per_s = kNoLimit;
    return j;
  }

  static Junction stop(double wait_s) {
    Junction j;
    j.wait_s = wait_s;
    return j;
  }

  Junction junction(const Element& a, const Element& b) const {
    const Vec3 from = a.segment.direction_at(a.segment.length_mm), to = b.segment.direction_at(0);
    const machine::Control& settings = *a.settings;
    const machine::Corner& corner = settings.corner;
    const bool changes = a.segment.cutting != b.segment.cutting;
    if (settings.rapid_change_s > 0 && changes) return stop(settings.rapid_change_s);
    if (changes && (control_.kind.stops_between_rapid_and_feed || std::isfinite(control_.in_position_mm))) return {};
    if (a.stops || a.taps || b.taps || a.control == nc::PathControl::exact_stop) return {};
    if (a.turns() || b.turns() || a.joint_limits || b.joint_limits) return turning_junction(a, b);
    if (corner.threshold_rad > 0 && from.dot(to) > std::cos(std::min(corner.threshold_rad, kPi))) return pass();
    const bool turns_round = from.dot(to) < -1.0 + kReversal;
    if (turns_round && corner.law != CornerLaw::speed_difference && corner.law != CornerLaw::angle)
      return stop(corner.stop_time_s);
    if (from.dot(to) < std::cos(std::min(corner.stop_angle_rad, kPi))) return stop(corner.stop_time_s);
    const bool exact = a.control == nc::PathControl::exact_path || b.control == nc::PathControl::exact_path;
    if (exact) return step_junction(a, b, from, to);
    Junction j;
    switch (corner.law) {
      case CornerLaw::exact_stop:
        return j;
      case CornerLaw::speed_difference:
        j.speed_mm_per_s = speed_difference_limit(from, to, speed_differences_mm_per_s(machine_, corner));
        return j;
      case CornerLaw::radius:
        j.speed_mm_per_s = arc_speed(
            three_point_radius(a.segment.point_at(0), b.segment.point_at(0), b.segment.point_at(b.segment.length_mm)),
            corner.acceleration_mm_per_s2, 1);
        return j;
      case CornerLaw::angle:
        j.speed_mm_per_s = angle_limit(
            from, to, std::min(a.segment.acceleration_mm_per_s2, b.segment.acceleration_mm_per_s2), corner.time_s);
        return j;
      case CornerLaw::blend:
        break;
    }
    const Junction step = step_junction(a, b, from, to), blend = blend_junction(a, b, from, to);
    return blend.speed_mm_per_s > step.speed_mm_per_s ? blend : step;
  }

  // --- corners with rotary axes

  /// On the exact path (G61) blocks that turn stop.
  Junction turning_junction(const Element& a, const Element& b) const {
    const machine::Corner& corner = a.settings->corner;
    const bool blends = corner.law == CornerLaw::blend;
    if (a.control == nc::PathControl::exact_path || corner.law == CornerLaw::exact_stop) return {};
    if (control_.kind.turning_blocks_overlap && !control_.joint_limits)
      return blends ? overlap_junction(a, b) : Junction{};
    const Vec3 from = a.segment.direction_at(a.segment.length_mm), to = b.segment.direction_at(0);
    const bool turns_round = from.dot(to) < -1.0 + kReversal;
    if (turns_round || from.dot(to) < std::cos(std::min(corner.stop_angle_rad, kPi))) return stop(corner.stop_time_s);
    Junction j;
    if (!blends) {
      j.speed_mm_per_s = step_speed(a, b);
      return j;
    }
    if (!a.line || !b.line) return j;
    const double shorter = std::min(a.segment.length_mm, b.segment.length_mm);
    const CornerRoom room{std::min(a.tolerance_mm, b.tolerance_mm),
                          std::min(kBlendRoomFraction * shorter, a.segment.length_mm - a.from_s)};
    j.trim = corner_trim(a.segment, b.segment, room);
    j.speed_mm_per_s = j.trim > kNoLength ? kNoLimit : 0;
    return j;
  }

  Junction overlap_junction(const Element& a, const Element& b) const {
    const auto direction = [](const Segment& s) { return s.along.isZero(0) ? Vec3(Vec3::UnitX()) : s.along; };
    const double cosine = std::clamp(direction(a.segment).dot(direction(b.segment)), -1.0, 1.0);
    Junction j;
    j.overlaps = true;
    j.overlap_speed_mm_per_s = overlap_corner_speed(
        std::acos(cosine), a.segment.acceleration_mm_per_s2 * a.settings->stop_acceleration_fraction, a.tolerance_mm);
    return j;
  }

  /// Speed at which no joint steps by more than the corner law permits.
  double step_speed(const Element& a, const Element& b) const {
    const machine::Corner& corner = a.settings->corner;
    const AxisValues from = joint_rates(a.segment, a.segment.length_mm, turns_->map()),
                     to = joint_rates(b.segment, 0, turns_->map());
    if (corner.law == CornerLaw::speed_difference)
      return joint_step_speed(
          from, to, {speed_differences_mm_per_s(machine_, corner), rotary_differences_rad_per_s(machine_, corner)});
    const AxisValues& acceleration = feed_limits_.acceleration;
    if (corner.law == CornerLaw::radius)  // q'' = dq' / ((L1 + L2) / 2), v^2 |q''| <= A
      return std::sqrt((a.segment.length_mm + b.segment.length_mm) / 2 * joint_step_speed(from, to, acceleration));
    if (corner.time_s <= 0) return 0;
    return joint_step_speed(from, to, {acceleration.linear * corner.time_s, acceleration.rotary * corner.time_s});
  }

  void hand_out(const Segment& s, bool joint_limits) const {
    if (!joint_limits) return sink_(s);
    hand_out_within_limits(s, turns_->map(), s.cutting ? feed_limits_ : rapid_limits_, sink_);
  }

  void emit_with_turning_corner(const Element& a, Element& b, double trim) {
    const double end_s = a.segment.length_mm - trim;
    emit(a, end_s, a.segment.acceleration_mm_per_s2);
    hand_out(rounded_corner(a.segment, end_s, b.segment, trim), true);
    b.from_s = trim;
  }

  void emit_overlapping(Element& a, const Junction& j) {
    a.segment.overlaps = true;
    a.segment.overlap_speed_mm_per_s = j.overlap_speed_mm_per_s;
    emit(a, a.segment.length_mm, a.segment.acceleration_mm_per_s2 * a.settings->stop_acceleration_fraction);
  }

  void join(Element& a, Element& b) {
    const Junction j = junction(a, b);
    b.segment.entry_limit_mm_per_s = j.speed_mm_per_s;
    a.less_fraction = std::max(a.less_fraction, j.less_fraction);
    b.less_fraction = j.less_fraction;
    if (j.overlaps) return emit_overlapping(a, j);
    if (j.trim > kNoLength) return emit_with_turning_corner(a, b, j.trim);
    if (j.blend && a.line && b.line && j.blend->trim_mm > kNoLength) {
      emit_with_blend(a, b, *j.blend);
    } else {
      emit(a, a.segment.length_mm, a.segment.acceleration_mm_per_s2 * (1.0 - a.less_fraction));
    }
    if (j.wait_s > 0) wait(j.wait_s, a.segment);
  }

  /// A stop within the path that lasts.
  void wait(double wait_s, const Segment& after) {
    Segment s;
    s.start_mm = after.point_at(after.length_mm);
    s.dwell_s = wait_s;
    s.move = after.move;
    s.mode = after.mode;
    s.cutting = after.cutting;
    if (turns_) s.turn = turns_->rest(false);
    sink_(s);
  }

  void emit_with_blend(Element& a, Element& b, const Blend& blend) {
    const Vec3 &from = a.segment.along, &to = b.segment.along;
    const double end_s = a.segment.length_mm - blend.trim_mm;
    const Vec3 touch = a.segment.point_at(end_s);
    const Vec3 normal = from.cross(to).normalized();
    Segment arc = arc_segment(touch, touch + blend.radius_mm * normal.cross(from), normal, blend.turn_rad, 0);
    arc.acceleration_mm_per_s2 = blend.acceleration_mm_per_s2 * a.settings->arc_tangential_fraction;
    arc.speed_limit_mm_per_s =
        std::min(blend.speed_mm_per_s, std::max(a.segment.speed_limit_mm_per_s, b.segment.speed_limit_mm_per_s));
    arc.entry_limit_mm_per_s = arc.axis_limit_mm_per_s = arc.speed_limit_mm_per_s;
    arc.feed_command_mm_per_s = std::max(a.segment.feed_command_mm_per_s, b.segment.feed_command_mm_per_s);
    arc.move = b.segment.move;
    arc.mode = a.segment.mode;
    if (turns_) arc.turn = part_of(a.segment, a.segment.length_mm, a.segment.length_mm).turn;
    arc.cutting = a.segment.cutting || b.segment.cutting;
    const double left = std::max(0.0, end_s - a.from_s);
    const bool absorbed = left < a.settings->corner.short_line_time_s * blend.speed_mm_per_s;
    const double whole = absorbed ? left + arc.length_mm : arc.length_mm;
    arc.speed_limit_mm_per_s = std::min(arc.speed_limit_mm_per_s, block_time_speed(whole, a.settings->block_time_s));
    if (absorbed) {
      a.segment.joined = true;
      a.segment.speed_limit_mm_per_s = std::min(a.segment.speed_limit_mm_per_s, arc.speed_limit_mm_per_s);
      emit(a, end_s, arc.acceleration_mm_per_s2);
    } else {
      emit(a, end_s, a.segment.acceleration_mm_per_s2 * (1.0 - a.less_fraction));
    }
    sink_(arc);
    b.from_s = blend.trim_mm;
  }

  void emit(const Element& element, double end_s, double acceleration) {
    if (end_s - element.from_s < kNoLength) return;
    Segment s = element.from_s > 0 || end_s < element.segment.length_mm
                    ? part_of(element.segment, element.from_s, end_s)
                    : element.segment;
    s.acceleration_mm_per_s2 = acceleration;
    s.planned_fraction = element.planned_fraction;
    hand_out(s, element.joint_limits);
  }

  void rest(double dwell_s, std::size_t move, const Vec3& where_mm, bool gap = false, bool at_end = false) {
    if (previous_) {
      const bool blended =
          previous_->control == nc::PathControl::blend && previous_->settings->corner.law == CornerLaw::blend;
      const double fraction =
          (1.0 - previous_->less_fraction) * (blended ? previous_->settings->stop_acceleration_fraction : 1.0);
      previous_->planned_fraction = blended ? previous_->settings->stop_acceleration_fraction : 1.0;
      emit(*previous_, previous_->segment.length_mm, previous_->segment.acceleration_mm_per_s2 * fraction);
    }
    previous_.reset();
    positioned_.reset();
    Segment s;
    s.gap = gap;
    s.start_mm = where_mm;
    s.dwell_s = dwell_s > 0 ? dwell_s + control_.rest_latency_s : 0.0;
    s.move = static_cast<std::uint32_t>(move);
    if (turns_) s.turn = turns_->rest(at_end);
    sink_(s);
  }

  const nc::Interpretation& program_;
  const machine::Machine& machine_;
  const machine::Control& control_;
  const SegmentSink& sink_;
  const std::vector<std::uint32_t> rests_;
  const Vec3 velocity_, acceleration_, rapid_velocity_, rapid_acceleration_;
  const double feed_factor_;
  const bool dog_leg_ = machine_.cycle.rapid_path == machine::RapidPath::dogleg;
  AxisPlaces places_;
  std::optional<MoveTurns> turns_;  ///< only for a program with rotary motion
  bool turning_ = false;            ///< the move under way
  const JointLimits feed_limits_ = feed_limits(machine_), rapid_limits_ = rapid_limits(machine_);
  std::optional<Element> previous_;
  std::optional<Segment> positioned_;  ///< the positioning just before
};

}  // namespace

void build_segments(const nc::Interpretation& program, const machine::Machine& machine, const SegmentSink& sink) {
  Builder(program, machine, sink).run();
}

}  // namespace camber::feedmodel
