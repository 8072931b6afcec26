#include "nc/canned_cycles.h"

#include <algorithm>
#include <cmath>

namespace camber::nc {
namespace {

/// Collects steps and keeps the tool's place.
class HoleWriter {
 public:
  HoleWriter(const CycleHole& hole, const PlaneAxes& axes) : hole_(hole), axes_(axes), at_(hole.from_mm) {}

  std::vector<CycleStep> run() {
    if (height() < hole_.retract_mm && hole_.g != 87) go(CycleStep::Kind::rapid, hole_.retract_mm);
    approach();
    if (hole_.g == 87) return bore_back();
    if (pecked())
      drill_in_pecks();
    else
      go(CycleStep::Kind::feed, hole_.bottom_mm);
    if (dwells() && hole_.dwell_s > 0) steps_.push_back({CycleStep::Kind::dwell, at_, hole_.dwell_s});
    if (feeds_out()) go(CycleStep::Kind::feed, hole_.retract_mm);
    if (hole_.g == 76) shift(1);
    go(CycleStep::Kind::rapid, hole_.clear_mm);
    if (hole_.g == 76) shift(-1);
    return std::move(steps_);
  }

 private:
  double height() const { return at_[axes_.normal]; }
  bool pecked() const { return (hole_.g == 73 || hole_.g == 83) && hole_.peck_mm > 0; }
  bool feeds_out() const { return hole_.g == 84 || hole_.g == 74 || hole_.g == 85 || hole_.g == 89; }
  bool dwells() const { return hole_.g != 81 && hole_.g != 83 && hole_.g != 73 && hole_.g != 85; }

  void approach() {
    Vec3 over = at_;
    over[axes_.first] = hole_.place_mm[axes_.first];
    over[axes_.second] = hole_.place_mm[axes_.second];
    if (over != at_) steps_.push_back({CycleStep::Kind::rapid, over, 0});
    at_ = over;
    if (hole_.g != 87) go(CycleStep::Kind::rapid, hole_.retract_mm);
  }

  std::vector<CycleStep> bore_back() {
    shift(1);
    go(CycleStep::Kind::rapid, hole_.retract_mm);
    shift(-1);
    go(CycleStep::Kind::feed, hole_.bottom_mm);
    if (hole_.dwell_s > 0) steps_.push_back({CycleStep::Kind::dwell, at_, hole_.dwell_s});
    shift(1);
    go(CycleStep::Kind::rapid, hole_.clear_mm);
    shift(-1);
    return std::move(steps_);
  }

  void shift(double sign) {
    if (hole_.shift_mm == Vec3::Zero()) return;
    at_ += sign * hole_.shift_mm;
    steps_.push_back({CycleStep::Kind::rapid, at_, 0});
  }

  void drill_in_pecks() {
    double depth = hole_.retract_mm, peck = hole_.peck_mm, cleared = depth;
    bool out = false;  // at R
    while (depth > hole_.bottom_mm) {
      const double next = std::max(depth - peck, hole_.bottom_mm);
      peck = std::max(peck - hole_.peck_less_mm, hole_.peck_less_mm > 0 ? hole_.least_peck_mm : peck);
      if (out && depth < hole_.retract_mm)
        go(CycleStep::Kind::rapid, std::min(depth + hole_.peck_clearance_mm, hole_.retract_mm));
      go(CycleStep::Kind::feed, next);
      depth = next;
      if (depth <= hole_.bottom_mm) break;
      constexpr double kRounding_mm = 1e-9;
      out = hole_.g == 83 || (hole_.clear_every_mm > 0 && cleared - depth >= hole_.clear_every_mm - kRounding_mm);
      if (out) cleared = depth;
      go(CycleStep::Kind::rapid, out ? hole_.retract_mm : std::min(depth + hole_.peck_clearance_mm, hole_.retract_mm));
    }
  }

  void go(CycleStep::Kind kind, double height_mm) {
    if (height() == height_mm) return;
    at_[axes_.normal] = height_mm;
    steps_.push_back({kind, at_, 0});
  }

  const CycleHole& hole_;
  const PlaneAxes& axes_;
  Vec3 at_;
  std::vector<CycleStep> steps_;
};

}  // namespace

std::vector<CycleStep> hole_steps(const CycleHole& hole, const PlaneAxes& axes) { return HoleWriter(hole, axes).run(); }

// --- pockets

bool mill_pocket_level(const PocketCycle& pocket, const PlaneAxes& axes, double height_mm, double from_mm, double to_mm,
                       const PocketMoves& moves) {
  const double c = std::cos(pocket.angle_rad), s = std::sin(pocket.angle_rad);
  const auto at = [&](double x, double y) {
    Vec3 p = pocket.middle_mm;
    p[axes.first] += c * x - s * y;
    p[axes.second] += s * x + c * y;
    p[axes.normal] = height_mm;
    return p;
  };
  const auto line = [&](const Vec3& end) { moves.line(end, pocket.feed_mm_per_s); };
  const double way = from_mm - to_mm;
  if (const double x = pocket.half_mm[0] - from_mm, y = pocket.half_mm[1] - from_mm; !pocket.round && way > 0) {
    // The long way of the middle first, which no ring reaches.
    line(at(-x, -y));
    line(at(x, y));
    if (y > 0) line(at(0, 0));
  }
  const double count = std::max(1.0, std::ceil(way / pocket.sideways_mm - 1e-9));
  if (!(count <= kMaxPecks)) return false;
  const int rings = static_cast<int>(count);
  for (int i = 1; i <= rings; ++i) {
    const double inside = from_mm - way * i / rings;
    const double x = pocket.half_mm[0] - inside, y = pocket.half_mm[1] - inside, f = pocket.sense;
    if (pocket.round && x < 1e-6) continue;
    line(at(x, 0));
    if (pocket.round) {
      moves.circle(pocket.middle_mm, f * 2 * kPi, pocket.feed_mm_per_s);
      continue;
    }
    const double corner = std::max(0.0, std::min({pocket.corner_mm - inside, x, y}));
    // Half a side, then corner and side four times, the last one again half.
    const double corners[4][2] = {{1, f}, {-1, f}, {-1, -f}, {1, -f}};
    for (int k = 0; k < 4; ++k) {
      const double px = corners[k][0], py = corners[k][1];
      const bool along_y = k % 2 == 0;  // comes in along the second side, leaves along the first
      line(along_y ? at(px * x, py * (y - corner)) : at(px * (x - corner), py * y));
      if (corner > 1e-6) moves.circle(at(px * (x - corner), py * (y - corner)), f * kPi / 2, pocket.feed_mm_per_s);
    }
    line(at(x, 0));
  }
  return true;
}

bool mill_pocket(const PocketCycle& given, const PlaneAxes& axes, const Vec3& from_mm, const PocketMoves& moves) {
  constexpr double kRapid = std::numeric_limits<double>::infinity();
  PocketCycle pocket = given;
  Vec3 here = from_mm;  // end of the last line
  const auto line = [&](const Vec3& end, double feed) { moves.line(here = end, feed); };
  const PocketMoves noted{line, moves.circle};
  const auto over_middle = [&](double height) {
    Vec3 p = pocket.middle_mm;
    p[axes.normal] = height;
    return p;
  };
  const auto up = [&](double height) {
    here[axes.normal] = height;
    line(here, kRapid);
    line(over_middle(height), kRapid);
  };
  const double surface = pocket.surface_mm, bottom = pocket.bottom_mm, clear = pocket.clearance_mm,
               least = pocket.least_mm(), rough_bottom = bottom + pocket.floor_mm;
  if ((surface - bottom) / pocket.step_mm > kMaxPecks) return false;
  line(over_middle(here[axes.normal]), kRapid);
  for (double z = surface; pocket.roughs && z > rough_bottom + 1e-9;) {
    line(over_middle(z + (clear - surface)), kRapid);
    z = std::max(z - pocket.step_mm, rough_bottom);
    line(over_middle(z), pocket.plunge_mm_per_s);
    if (!mill_pocket_level(pocket, axes, z, least, pocket.side_mm, noted)) return false;
    up(z + (clear - surface));  // off the wall, back to the middle
  }
  if (pocket.finishes && (pocket.side_mm > 0 || pocket.floor_mm > 0)) {
    pocket.feed_mm_per_s = pocket.finishing_mm_per_s;
    const double infeed = pocket.finishing_step_mm > 0 ? pocket.finishing_step_mm : surface - bottom;
    for (double z = surface; pocket.side_mm > 0 && z > bottom + 1e-9;) {
      z = std::max(z - infeed, bottom);
      line(over_middle(z), pocket.plunge_mm_per_s);
      mill_pocket_level(pocket, axes, z, 0, 0, noted);
      line(over_middle(z), pocket.finishing_mm_per_s);
    }
    if (pocket.floor_mm > 0) {
      line(over_middle(bottom), pocket.plunge_mm_per_s);
      if (!mill_pocket_level(pocket, axes, bottom, least, 0, noted)) return false;
    }
  }
  up(clear);
  return true;
}

}  // namespace camber::nc
