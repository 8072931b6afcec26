#include "removal/tool_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace camber::removal {

using feedmodel::TimedSample;

namespace {

constexpr double kStill_mm = 1e-6;
constexpr double kStill = 1e-9;  // axis and spin

bool still(const Stamp& stamp, const Stamp& before) {
  return stamp.feed_per_tooth_mm.norm() < kStill_mm && (stamp.pose.axis - before.pose.axis).norm() < kStill &&
         std::abs(stamp.pose.spin_rad - before.pose.spin_rad) < kStill;
}

double passing_s_of(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools,
                    const nc::Move& move) {
  const nc::ModalState& state = program.state_of(move);
  return 60.0 / (state.spindle_speed_rpm * tools.at(state.tool).flutes);
}

/// Room for the stamps of moves that are cut at their programmed feeds, and some more, since axes brake. A list that
/// doubles would be in memory one and a half times; room that is not written to takes none. 0 where they are too many.
std::size_t room_for(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools,
                     const std::vector<bool>& selected) {
  constexpr double kMore = 1.25, kMax = 3e7;
  double passings = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    const nc::Move& move = program.moves[i];
    if (selected[i] && move.feed_mm_per_s > 0)
      passings += nc::length_mm(program, move) / (move.feed_mm_per_s * passing_s_of(program, tools, move));
  }
  return passings < kMax ? static_cast<std::size_t>(kMore * passings) : 0;
}

/// Tips go straight, the frame turns about one axis.
ToolPose between(const ToolPose& a, const ToolPose& b, double u) {
  const Vec3 tip = (1 - u) * a.tip_mm + u * b.tip_mm;
  if (a.axis == b.axis && a.spin_rad == b.spin_rad) return {tip, a.axis, a.spin_rad};
  const Eigen::Quaterniond from(tool_frame(a)), to(tool_frame(b));
  const Mat3 frame = from.slerp(u, to).toRotationMatrix();
  return pose_of_frame(tip, frame.col(2), frame.col(0));
}

}  // namespace

ToothMotion motion_in_tool(std::span<const Stamp> stamps, std::size_t k) {
  const Stamp& stamp = stamps[k];
  ToothMotion out{direction_in_tool(stamp.pose, stamp.feed_per_tooth_mm)};
  const std::size_t to = stamp.first ? k + 1 : k;
  if (to == 0 || to >= stamps.size() || stamps[to].first) return out;
  const ToolPose &a = stamps[to - 1].pose, &b = stamps[to].pose;
  if (a.axis == b.axis && a.spin_rad == b.spin_rad) return out;
  const Eigen::AngleAxisd turn(Mat3(tool_frame(a).transpose() * tool_frame(b)));
  out.turn_rad = turn.angle() * turn.axis();
  return out;
}

bool in_operations(const nc::Interpretation& program, const nc::Move& m, const machine::Operations& operations) {
  const int tool = program.state_of(m).tool;
  if (!operations.tools.empty() && std::ranges::find(operations.tools, tool) == operations.tools.end()) return false;
  const int line = static_cast<int>(m.block) + 1;
  return operations.blocks.empty() ||
         std::ranges::any_of(operations.blocks, [&](const auto& r) { return line >= r[0] && line <= r[1]; });
}

std::vector<bool> selected_moves(const nc::Interpretation& program, const machine::Operations& operations) {
  const auto wanted = [&](const nc::Move& m) {
    if (m.kind != nc::MoveKind::linear && m.kind != nc::MoveKind::arc) return false;
    const bool of_hole = m.canned && m.cycle != 0;  // see hole_moves()
    return !m.reference && !of_hole && in_operations(program, m, operations);
  };
  std::vector<bool> out;
  out.reserve(program.moves.size());
  for (const auto& m : program.moves) out.push_back(wanted(m));
  return out;
}

StampBuilder::StampBuilder(const nc::Interpretation& program, const std::map<int, machine::Tool>& tools,
                           std::vector<bool> selected, std::vector<HoleMove> holes, const kinematics::PartPath* rotary,
                           StampSink sink)
    : program_(program),
      tools_(tools),
      selected_(std::move(selected)),
      holes_(std::move(holes)),
      rotary_(rotary),
      sink_(std::move(sink)),
      tracker_(program, measure_of(rotary)) {
  assert(selected_.size() == program.moves.size());
  assert(holes_.empty() || holes_.size() == program.moves.size());
  assert(std::ranges::all_of(program.moves, [&, i = std::size_t{0}](const nc::Move& move) mutable {
    const bool stamped = selected_[i] || makes_hole(static_cast<std::uint32_t>(i));
    ++i;
    const nc::ModalState& state = program.state_of(move);
    return !stamped || (tools.contains(state.tool) && state.spindle_speed_rpm > 0);
  }));
  if (!sink_) path_.stamps.reserve(room_for(program, tools, selected_));
}

feedmodel::PathMeasure StampBuilder::measure_of(const kinematics::PartPath* rotary) const {
  if (!rotary) return {};
  return {.closest =
              [this, rotary](std::uint32_t move, double from_u, double to_u) {
                return feedmodel::closest_on_part(*rotary, program_, move, tool_, from_u, to_u);
              },
          .length_mm = [rotary](std::uint32_t move) { return rotary->length_mm(move); }};
}

void StampBuilder::add(std::span<const TimedSample> samples) {
  assert(!rotary_);
  for (const TimedSample& s : samples) add(s);
}

void StampBuilder::add(const feedmodel::PartSamples& samples) {
  assert(rotary_);
  for (std::size_t i = 0; i < samples.samples().size(); ++i) {
    last_tool_ = have_last_ ? tool_ : samples.tools()[i];
    tool_ = samples.tools()[i];
    add(samples.samples()[i]);
  }
}

void StampBuilder::add(const TimedSample& sample) {
  const feedmodel::PathPlace place = tracker_(sample);
  for (; next_move_ <= place.move; ++next_move_)
    if (program_.moves[next_move_].kind == nc::MoveKind::rapid) path_.rapids.push_back({next_move_, sample.t_s});
  for (; next_hole_ < place.move; ++next_hole_)
    if (makes_hole(next_hole_)) finish_hole(next_hole_, sample.t_s);
  if (makes_hole(place.move)) {
    drill(sample, place);
  } else if (!selected_[place.move]) {
    cutting_ = false;
  } else {
    const nc::ModalState& state = program_.state_of(program_.moves[place.move]);
    if (!cutting_ || path_.runs.empty() || path_.runs.back().tool != state.tool ||
        path_.runs.back().kind != RunKind::milling) {
      next_s_ = sample.t_s;
      cutting_ = false;
    }
    const double passing = passing_s(place.move);
    for (; next_s_ <= sample.t_s; next_s_ += passing) stamp_at(next_s_, sample, place, state.tool);
  }
  last_ = sample;
  have_last_ = true;
}

feedmodel::ToolPlace StampBuilder::tool_between(double u) const {
  const kinematics::Joints &a = last_tool_.joints, &b = tool_.joints;
  return {between(last_tool_.tool, tool_.tool, u),
          {(1 - u) * a.linear_mm + u * b.linear_mm, (1 - u) * a.rotary_rad + u * b.rotary_rad}};
}

ToolPose StampBuilder::pose_at(const TimedSample& sample, const feedmodel::PathPlace& place, double u) const {
  if (rotary_) return tool_between(u).tool;
  ToolPose pose = nc::pose_at(program_, program_.moves[place.move], place.u);
  pose.tip_mm = have_last_ ? Vec3((1 - u) * last_.position_mm + u * sample.position_mm) : sample.position_mm;
  return pose;
}

double StampBuilder::fraction_of(const ToolPose& pose, double u, std::uint32_t move, double from, double to) const {
  return rotary_ ? feedmodel::closest_on_part(*rotary_, program_, move, tool_between(u), from, to).u
                 : feedmodel::closest_on_move(program_, move, pose.tip_mm, from, to).u;
}

void StampBuilder::stamp_at(double t_s, const TimedSample& sample, const feedmodel::PathPlace& place, int tool) {
  Stamp stamp;
  stamp.t_s = t_s;
  stamp.move = place.move;
  stamp.first = !cutting_;
  const double span = have_last_ ? sample.t_s - last_.t_s : 0;
  const double u = span > 0 ? std::clamp((t_s - last_.t_s) / span, 0.0, 1.0) : 1.0;
  stamp.pose = pose_at(sample, place, u);
  // `place` is that of the sample, up to a period later.
  const double from = cutting_ && path_.stamps.back().move == place.move ? path_.stamps.back().fraction : 0.0;
  stamp.fraction = fraction_of(stamp.pose, u, place.move, std::min(from, place.u), place.u);
  if (cutting_) {
    stamp.feed_per_tooth_mm = stamp.pose.tip_mm - path_.stamps.back().pose.tip_mm;
    if (still(stamp, path_.stamps.back())) return;
  } else {
    stamp.feed_per_tooth_mm = sample.velocity_mm_per_s * passing_s(place.move);
  }
  append(stamp, tool, RunKind::milling);
}

void StampBuilder::append(const Stamp& stamp, int tool, RunKind kind) {
  const std::size_t number = path_.runs.empty() ? 0 : path_.runs.back().from + path_.runs.back().count;
  if (path_.runs.empty() || path_.runs.back().tool != tool || path_.runs.back().kind != kind)
    path_.runs.push_back({tool, number, 0, kind});
  ++path_.runs.back().count;
  if (sink_) {
    path_.stamps.clear();
    sink_(path_.runs.back(), number, stamp);
  }
  path_.stamps.push_back(stamp);
  cutting_ = true;
}

double StampBuilder::passing_s(std::uint32_t move) const {
  return passing_s_of(program_, tools_, program_.moves[move]);
}

void StampBuilder::drill(const TimedSample& sample, const feedmodel::PathPlace& place) {
  if (!cutting_ || path_.stamps.back().move != place.move) {
    next_s_ = sample.t_s;
    hole_fraction_ = place.u;
    cutting_ = false;
  }
  // After a rapid the following error of the feed model still shrinks; a cycle has waited for it.
  const nc::Move& m = program_.moves[place.move];
  const double passing = passing_s(place.move), span = have_last_ ? sample.t_s - last_.t_s : 0;
  const double feed_fraction = m.feed_mm_per_s * passing / (m.end_mm - m.start_mm).norm();
  for (; next_s_ <= sample.t_s; next_s_ += passing) {
    const double u = span > 0 ? std::clamp((next_s_ - last_.t_s) / span, 0.0, 1.0) : 1.0;
    const double fraction = (1 - u) * hole_fraction_ + u * place.u;
    hole_stamp(place.move, cutting_ ? std::min(fraction, path_.stamps.back().fraction + feed_fraction) : fraction,
               next_s_);
  }
  hole_fraction_ = place.u;
}

/// The rest of the way to the bottom, in steps of the programmed feed per tooth.
void StampBuilder::finish_hole(std::uint32_t move, double t_s) {
  const nc::Move& m = program_.moves[move];
  const bool begun = cutting_ && path_.stamps.back().move == move;
  if (!begun) cutting_ = false;
  const double length = (m.end_mm - m.start_mm).norm(), from = begun ? path_.stamps.back().fraction : 0.0;
  const double feed = m.feed_mm_per_s * passing_s(move);
  const int steps = feed > 0 ? std::max(1, static_cast<int>(std::ceil((1 - from) * length / feed - 1e-9))) : 1;
  for (int i = begun ? 1 : 0; i <= steps; ++i) hole_stamp(move, from + (1 - from) * i / steps, t_s);
  cutting_ = false;
}

void StampBuilder::hole_stamp(std::uint32_t move, double fraction, double t_s) {
  const nc::Move& m = program_.moves[move];
  const Vec3 way = m.end_mm - m.start_mm;
  Stamp stamp;
  stamp.t_s = t_s;
  stamp.fraction = fraction;
  stamp.move = move;
  stamp.first = !cutting_;
  stamp.pose = {m.start_mm + fraction * way, nc::pose_at(program_, m, fraction).axis};
  stamp.feed_per_tooth_mm = cutting_ ? Vec3(stamp.pose.tip_mm - path_.stamps.back().pose.tip_mm)
                                     : Vec3(way.normalized() * m.feed_mm_per_s * passing_s(move));
  if (cutting_ && stamp.feed_per_tooth_mm.norm() < kStill_mm) return;
  append(stamp, program_.state_of(m).tool, holes_[move] == HoleMove::tapped ? RunKind::tapping : RunKind::drilling);
}

StampPath StampBuilder::take() {
  for (; next_hole_ < holes_.size(); ++next_hole_)
    if (makes_hole(next_hole_)) finish_hole(next_hole_, last_.t_s);
  return std::move(path_);
}

namespace {

constexpr double kSame_mm = 1e-6;  // rounding of a turned frame

bool same_place(const Vec3& a, const Vec3& b) { return (a - b).head<2>().norm() <= kSame_mm; }

/// Down (-1) or up (1) along the tool's axis; 0: not along it.
int straight(const nc::Move& m) {
  if (!same_place(m.start_mm, m.end_mm) || m.start_mm.z() == m.end_mm.z()) return 0;
  return m.end_mm.z() < m.start_mm.z() ? -1 : 1;
}

bool taps(const nc::Move& m) { return m.cycle == 74 || m.cycle == 84; }

}  // namespace

std::vector<HoleMove> hole_moves(const nc::Interpretation& program, const machine::Operations& operations,
                                 const std::map<int, machine::Tool>& tools) {
  std::vector<HoleMove> out(program.moves.size(), HoleMove::none);
  const nc::Move* hole = nullptr;  // the last move down
  for (std::size_t i = 0; i < program.moves.size(); ++i) {
    const nc::Move& m = program.moves[i];
    if (m.kind != nc::MoveKind::linear || m.reference || !in_operations(program, m, operations)) continue;
    const int way = straight(m);
    if (m.cycle == 0) {
      const auto tool = tools.find(program.state_of(m).tool);
      if (way == 0 || tool == tools.end() || tool->second.type != machine::ToolType::drill) continue;
      out[i] = way < 0 ? HoleMove::drilled : HoleMove::way_out;
    } else if (way < 0) {
      out[i] = taps(m) ? HoleMove::tapped : HoleMove::drilled;
    } else if (way > 0 && hole && hole->block == m.block && same_place(hole->end_mm, m.start_mm)) {
      out[i] = HoleMove::way_out;
    } else {
      out[i] = HoleMove::not_carved;
    }
    if (makes_hole(out[i])) hole = &m;
  }
  return out;
}

HoleCount count_holes(const nc::Interpretation& program, const std::vector<HoleMove>& holes) {
  HoleCount count;
  const nc::Move* last = nullptr;
  for (std::size_t i = 0; i < holes.size(); ++i) {
    if (!makes_hole(holes[i])) continue;
    const nc::Move& m = program.moves[i];
    const bool deeper = last && same_place(last->end_mm, m.start_mm) &&
                        program.state_of(*last).tool == program.state_of(m).tool &&
                        (m.cycle == 0 || last->block == m.block);
    if (!deeper) ++(holes[i] == HoleMove::tapped ? count.tapped : count.drilled);
    last = &m;
  }
  return count;
}

StampPath stamps_where(const StampPath& path, const std::function<bool(std::size_t)>& keep) {
  StampPath out;
  for (const ToolRun& run : path.runs) {
    bool open = false;
    for (std::size_t k = run.from; k < run.from + run.count; ++k) {
      if (!keep(k)) {
        open = false;
        continue;
      }
      if (!open) out.runs.push_back({run.tool, out.stamps.size(), 0, run.kind});
      out.stamps.push_back(path.stamps[k]);
      out.stamps.back().first = out.stamps.back().first || !open;
      ++out.runs.back().count;
      open = true;
    }
  }
  return out;
}

}  // namespace camber::removal
