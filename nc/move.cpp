#include "nc/move.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/units.h"

namespace camber::nc {
namespace {

/// The arc in its own frame: `out` and `along` span its plane at the start, the radius runs from one end's to the
/// other's (they differ by what the text's decimals leave).
struct ArcFrame {
  Vec3 out, along;
  double start_radius, end_radius, rise;
};

ArcFrame frame_of(const Arc& arc, const Move& move) {
  const auto radial = [&](const Vec3& p) -> Vec3 {
    const Vec3 r = p - arc.center_mm;
    return r - r.dot(arc.normal) * arc.normal;
  };
  ArcFrame f;
  const Vec3 start = radial(move.start_mm);
  f.start_radius = start.norm();
  f.end_radius = radial(move.end_mm).norm();
  f.out = f.start_radius > 0 ? Vec3(start / f.start_radius) : Vec3(arc.normal.unitOrthogonal());
  f.along = arc.normal.cross(f.out);
  f.rise = (move.end_mm - move.start_mm).dot(arc.normal);
  return f;
}

}  // namespace

void ReliedEnds::add(std::span<const Move> moves) {
  for (std::size_t i = moves.size(); i-- > 0;) {
    if (moves[i].kind == MoveKind::dwell) continue;
    if (blocks_.empty() || blocks_.back() != moves[i].block) blocks_.push_back(moves[i].block);
    return;
  }
}

void ReliedEnds::add_direction(std::span<const Move> moves) {
  add(moves);
  while (!moves.empty() && moves.back().kind == MoveKind::dwell) moves = moves.first(moves.size() - 1);
  if (!moves.empty()) add(moves.first(moves.size() - 1));
}

void ReliedEnds::fix(Interpretation& program) {
  if (blocks_.empty()) return;
  std::ranges::sort(blocks_);
  auto& moves = program.moves;
  const auto ends_as_it_starts = [](const Move& m) {
    constexpr double kNoLengthMm = 1e-6;
    return m.kind == MoveKind::arc && (m.end_mm - m.start_mm).norm() < kNoLengthMm;
  };
  std::size_t done = 0;
  for (std::size_t behind = 1; behind <= moves.size(); ++behind) {
    const std::uint32_t block = moves[behind - 1].block;
    if (behind < moves.size() && moves[behind].block == block) continue;
    if (!std::ranges::binary_search(blocks_, block)) continue;
    const auto known = static_cast<std::ptrdiff_t>(program.fixed_ends.size());
    for (std::size_t i = behind; i-- > done;) {
      if (!moves[i].editable || moves[i].kind == MoveKind::dwell) continue;
      moves[i].editable = false;
      program.fixed_ends.push_back(static_cast<std::uint32_t>(i));
      if (!ends_as_it_starts(moves[i])) break;
    }
    std::reverse(program.fixed_ends.begin() + known, program.fixed_ends.end());
    done = behind;
  }
}

bool only_turns(const Interpretation& program, std::size_t move) {
  constexpr double kNoLengthMm = 1e-9;
  const Move& m = program.moves[move];
  if (m.kind != MoveKind::linear || program.state_of(m).feed_mode == FeedMode::inverse_time) return false;
  const auto turn = std::ranges::lower_bound(program.rotary, move, {}, &RotaryTarget::move);
  return turn != program.rotary.end() && turn->move == move && length_mm(program, m) < kNoLengthMm;
}

double feed_deg_per_min(const Interpretation& program, const Move& move) {
  const double per_min = mm_per_min_from_mm_per_s(move.feed_mm_per_s);
  return program.state_of(move).inch ? per_min / kMmPerInch : per_min;
}

double length_mm(const Interpretation& program, const Move& move) {
  if (move.kind == MoveKind::dwell) return 0;
  if (move.arc == Move::kNoArc) return (move.end_mm - move.start_mm).norm();
  const Arc& arc = program.arcs[move.arc];
  const ArcFrame f = frame_of(arc, move);
  return std::hypot(0.5 * (f.start_radius + f.end_radius) * arc.sweep_rad, f.rise);
}

Vec3 point_at(const Interpretation& program, const Move& move, double u) {
  if (u <= 0) return move.start_mm;
  if (u >= 1) return move.end_mm;
  if (move.arc == Move::kNoArc) return move.start_mm + u * (move.end_mm - move.start_mm);
  const Arc& arc = program.arcs[move.arc];
  const ArcFrame f = frame_of(arc, move);
  const double radius = f.start_radius + u * (f.end_radius - f.start_radius);
  const double angle = u * arc.sweep_rad;
  const double height = (move.start_mm - arc.center_mm).dot(arc.normal) + u * f.rise;
  return arc.center_mm + radius * (std::cos(angle) * f.out + std::sin(angle) * f.along) + height * arc.normal;
}

ToolPose pose_at(const Interpretation& program, const Move& move, double u) {
  return {point_at(program, move, u), Vec3::UnitZ()};
}

Vec3 direction_at(const Interpretation& program, const Move& move, double u) {
  Vec3 direction = move.end_mm - move.start_mm;
  if (move.arc != Move::kNoArc) {
    const Arc& arc = program.arcs[move.arc];
    const ArcFrame f = frame_of(arc, move);
    const double radius = f.start_radius + u * (f.end_radius - f.start_radius);
    const double angle = u * arc.sweep_rad;
    const Vec3 out = std::cos(angle) * f.out + std::sin(angle) * f.along;
    const Vec3 along = std::cos(angle) * f.along - std::sin(angle) * f.out;
    direction = (f.end_radius - f.start_radius) * out + radius * arc.sweep_rad * along + f.rise * arc.normal;
  }
  const double length = direction.norm();
  return length > 0 && move.kind != MoveKind::dwell ? Vec3(direction / length) : Vec3(Vec3::Zero());
}

}  // namespace camber::nc
