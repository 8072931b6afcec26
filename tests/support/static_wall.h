#pragma once
// A flat end mill along a wall or through a slot with a bending tool: the simulation in time (time_domain_milling.h),
// beside Camber's cut of the same job (finished_wall.h).
#include <cmath>
#include <vector>

#include "tests/support/finished_wall.h"
#include "tests/support/static_plane.h"

namespace camber::testing {

/// Slices of the surface's height have the mean error of a stretch of the wall.
struct JudgedWall : WallFigures {
  double chips_of_surface = 1;
  int unsettled_steps = 0;
};

struct WallJudgeSteps {
  double rotation_deg = 0.25, edge_mm = 0.1, around_mm = 0.02, up_mm = 0.1;
  double run_mm = 1.5;  ///< to both sides of the place at which the wall is read
  double ramp_mm = 0.002;
  int give_up_after = 1 << 30;  ///< steps without a balance
};

/// One cut along the wall.
struct WallPass {
  double offset_mm = 0;  ///< shift of the path towards the wall
  double feed_mm = 0;    ///< per tooth
};

namespace detail {

/// The map stands around a fixed axis through the middle of the path: what the tool clears is seen whole from there.
class WallJudge {
 public:
  WallJudge(const FinishedWall& w, const WallJudgeSteps& s) : w_(w), s_(s), job_(drawn(w)) {
    tool_.radius = job_.radius, tool_.corner = 0;
    tool_.flutes = w.flutes, tool_.helix_rad = job_.helix_rad;
    // Elements end where the block does.
    tool_.bottom = kBelow - 2 * s.edge_mm, tool_.top = kBelow + w.height_mm + 2 * s.edge_mm,
    tool_.edge_step = s.edge_mm;
    tool_.run_out_mm = w.run_out_mm, tool_.run_out_rad = rad_from_deg(w.run_out_deg);
    tool_.tooth_rad = job_.tooth_at_rad;
    tool_.overhang = job_.overhang, tool_.bending_stiffness_N_mm2 = job_.bending_stiffness_N_mm2;
    tool_.levels = std::clamp(static_cast<int>(tool_.top) + 2, 4, 12);
    chart_.radius = job_.radius;
    chart_.origin = Vec3(0, -job_.radius, 0);
    chart_.middle_rad = (angles().first + angles().second) / 2;
  }

  JudgedWall figures() { return figures({{0, w_.feed_mm}}); }

  /// The wall that `passes` leave, one after the other, less the one that a stiff tool would leave.
  JudgedWall figures(const std::vector<WallPass>& passes) {
    HeightMap bent = blank(), rigid = blank(), before = bent;
    JudgedWall f;
    double chips = 0;
    for (const bool bends : {false, true}) {
      TurningTool tool = tool_;
      if (!bends) tool.run_out_mm = 0;  // errors hold the run-out
      TimeDomainMilling milling(tool, edge_law_of(w_.material, s_.ramp_mm), bends ? bent : rigid,
                                static_cast<int>(std::lround(360 / s_.rotation_deg / w_.flutes)));
      milling.rigid = !bends;
      milling.give_up_after = s_.give_up_after;
      const Vec3 from(-s_.run_mm * way(), -job_.radius, -kBelow), to(s_.run_mm * way(), -job_.radius, -kBelow);
      if (!bends) {
        milling.run(from, to, w_.feed_mm);
        continue;
      }
      std::vector<Period> periods;
      for (const WallPass& pass : passes) {
        for (const Period& p : periods) chips += p.chip_mm3, f.unsettled_steps += p.unsettled;
        const Vec3 beside(0, pass.offset_mm, 0);
        periods = milling.run(from + beside, to + beside, pass.feed_mm);
      }
      // Whole turns about the middle, where the wall is read.
      const std::size_t count = static_cast<std::size_t>(3 * w_.flutes), first = periods.size() / 2;
      for (std::size_t k = 0; k < periods.size(); ++k) {
        chips += periods[k].chip_mm3, f.unsettled_steps += periods[k].unsettled;
        if (k < first || k >= first + count) continue;
        const double fraction = 1.0 / static_cast<double>(count), peak = periods[k].lateral_max_N;
        f.lateral_max_N = w_.pitch_deg.empty() ? f.lateral_max_N + fraction * peak : std::max(f.lateral_max_N, peak);
        f.mean_N += fraction * periods[k].mean_N;
      }
    }
    f.chips_of_surface = chips / before.volume_above(bent);
    Slices slices(w_);
    for (int i = 0; i < bent.nu(); ++i)
      for (int j = 0; j < bent.nv(); ++j) {
        const double angle = bent.u(i) / chart_.radius;
        if (std::abs(chart_.radius * std::cos(angle)) > kRead || std::sin(angle) < 0) continue;
        slices.add(bent.v(j), (bent.height(i, j) - rigid.height(i, j)) * std::sin(angle), 1);
      }
    f.error_um = slices.means();
    return f;
  }

 private:
  static constexpr double kBelow = 0.53;  ///< the tip runs below the block
  static constexpr double kRead = 0.2;
  double way() const { return w_.up ? 1 : -1; }

  /// Material beyond the face at y = -radial that an unbent tool has cleared up to the start.
  double cleared(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle), r = job_.radius, start = -s_.run_mm * way();
    // Out of the disc at the start; behind it, out of the strip that it has come along.
    const double ahead = c * start + std::sqrt(std::max(0.0, r * r - start * start * s * s));
    const bool behind = way() * (ahead * c - start) < 0;
    const double disc = behind ? r / std::max(std::abs(s), 1e-9) : ahead;
    const double face = r - w_.radial_mm;
    if (face <= -r) return -disc;
    if (face > 0) return s <= face / (10 * r) ? HeightMap::kAir : -std::max(disc, face / s);
    // The face lies on the other side of the axis: material up to it.
    if (s < 0 && face / s < disc) return HeightMap::kAir;
    return face == 0 && s < 0 ? HeightMap::kAir : -disc;
  }

  /// Ahead of the tool and towards the wall y = 0.
  std::pair<double, double> angles() const {
    const double beyond = rad_from_deg(20);
    const double entry = std::asin(std::clamp(1 - w_.radial_mm / job_.radius, -1.0, 1.0));
    const double from = std::max(entry - 2 * beyond, -kPi / 2 - beyond), to = kPi / 2 + beyond;
    return w_.up ? std::pair(from, to) : std::pair(kPi - to, kPi - from);
  }

  HeightMap blank() const {
    const double r = job_.radius;
    const auto [from, to] = angles();
    const HeightMap::Window window{from * r, to * r, s_.up_mm / 2, w_.height_mm - s_.up_mm / 2, s_.around_mm, s_.up_mm};
    return {chart_, window, [&](double u, double) { return cleared(u / r); }};
  }

  FinishedWall w_;
  WallJudgeSteps s_;
  DrawnCut job_;
  TurningTool tool_;
  Chart chart_;
};

}  // namespace detail

inline JudgedWall judged_figures(const FinishedWall& w, const WallJudgeSteps& s = {}) {
  return detail::WallJudge(w, s).figures();
}

/// Result for a wall that several cuts finish. Loads are those of the last cut.
inline JudgedWall judged_figures(const FinishedWall& w, const std::vector<WallPass>& passes,
                                 const WallJudgeSteps& s = {}) {
  return detail::WallJudge(w, s).figures(passes);
}

}  // namespace camber::testing
