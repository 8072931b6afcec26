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

}  // namespace camber::nc
