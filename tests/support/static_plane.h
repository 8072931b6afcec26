#pragma once
// Ball finishing of an inclined plane with a bending tool: the simulation in time (time_domain_milling.h) and Camber's
// static coupling, figure by figure.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/support/inclined_plane.h"
#include "tests/support/time_domain_milling.h"

namespace camber::testing {

inline EdgeLaw edge_law_of(const machine::Material& m, double ramp_mm) {
  EdgeLaw law{m.ktc_MPa, m.krc_MPa, m.kac_MPa, m.kte_N_per_mm, m.kre_N_per_mm, m.kae_N_per_mm};
  if (m.law == machine::ForceLaw::kienzle)
    law.kt = m.kc1_1_MPa, law.kr = m.kr1_1_MPa, law.ka = m.ka1_1_MPa, law.mt = m.mc, law.mr = m.mr, law.ma = m.ma;
  law.ramp_mm = ramp_mm;
  return law;
}

/// How finely the judge goes.
struct JudgeSteps {
  double rotation_deg = 0.25, edge_mm = 0.03, grid_mm = 0.02;
  int bent_rows = 8;     ///< after rows that an unbent tool has cut
  double length_mm = 5;  ///< length of the plane along the rows
  double ramp_mm = 0.002;
};

struct JudgedFigures : CutFigures {
  double chips_of_surface = 1;  ///< over all rows
  int unsettled_steps = 0;
};

namespace detail {

/// The judge's rows lie along the chart's u, their contacts at v = 0, row, ...
class PlaneJudge {
 public:
  PlaneJudge(const InclinedPlane& p, const JudgeSteps& s) : p_(p), s_(s), slope_(rad_from_deg(p.slope_deg)) {
    tool_.radius = p.radius_mm, tool_.corner = p.corner();
    tool_.flutes = p.flutes, tool_.helix_rad = rad_from_deg(p.helix_deg);
    tool_.edge_step = s.edge_mm;
    tool_.run_out_mm = p.run_out_mm, tool_.run_out_rad = rad_from_deg(p.run_out_deg);
    double at = 0;
    for (const double pitch : p.pitch_deg) tool_.tooth_rad.push_back(at), at += rad_from_deg(pitch);
    tool_.overhang = 40;
    tool_.bending_stiffness_N_mm2 = p.young_MPa * kPi / 64 * std::pow(0.8 * 2 * p.radius_mm, 4);
    tool_.top = drawn(p).top + 0.1;
    chart_.v = Vec3(0, std::cos(slope_), std::sin(slope_)), chart_.n = Vec3(0, -std::sin(slope_), std::cos(slope_));
  }

  JudgedFigures figures() {
    HeightMap bent = blank(), rigid = blank(), before = bent;
    JudgedFigures f;
    std::vector<Period> read;
    double chips = 0;
    for (const bool bends : {false, true}) {
      TurningTool tool = tool_;
      if (!bends) tool.run_out_mm = 0;  // errors hold the run-out
      TimeDomainMilling milling(tool, edge_law_of(p_.material, s_.ramp_mm), bends ? bent : rigid,
                                static_cast<int>(std::lround(360 / s_.rotation_deg / p_.flutes)));
      milling.rigid = !bends;
      for (int row = 0; row < s_.bent_rows; ++row) {
        const auto periods = run(milling, row);
        if (!bends) continue;
        for (const Period& q : periods) {
          chips += q.chip_mm3, f.unsettled_steps += q.unsettled;
          if (row >= s_.bent_rows - (p_.along_x == 0 ? 3 : 2) && row < s_.bent_rows - 1 && q.tip.x() > from() &&
              q.tip.x() < to())
            read.push_back(q);
        }
        while (!p_.pitch_deg.empty() && read.size() % p_.pitch_deg.size() != 0) read.pop_back();  // whole turns
      }
    }
    f.chips_of_surface = chips / before.volume_above(bent);
    const bool even = p_.pitch_deg.empty();
    for (const Period& q : read) {
      const double fraction = 1.0 / static_cast<double>(read.size());
      f.lateral_max_N =
          even ? f.lateral_max_N + fraction * q.lateral_max_N : std::max(f.lateral_max_N, q.lateral_max_N);
      f.mean_N += fraction * q.mean_N;
      f.chip_mm3 += fraction * q.chip_mm3;
    }
    std::vector<std::pair<double, double>> error;
    // Two rows' pitch of finished surface, behind the last row.
    const double end = row_at(s_.bent_rows - 1) - 1.5 * p_.row_mm * way(), begin = end - 2 * p_.row_mm * way();
    for (int i = 0; i < bent.nu(); ++i)
      for (int j = 0; j < bent.nv(); ++j)
        if (bent.u(i) > from() && bent.u(i) < to() && bent.v(j) > std::min(begin, end) &&
            bent.v(j) < std::max(begin, end))
          error.push_back({bent.height(i, j) - rigid.height(i, j), 1.0});
    detail::set_error(f, std::move(error));
    return f;
  }

 private:
  static constexpr double kBeside = 1.5;
  double from() const { return 0.36 * s_.length_mm; }
  double to() const { return 0.64 * s_.length_mm; }
  double way() const { return p_.upwards ? 1 : -1; }
  double row_at(int row) const { return way() * p_.row_mm * row; }
  Vec3 tip(double u, double v, double corner) const {
    const double bottom = p_.radius_mm - p_.corner();
    return u * chart_.u + v * chart_.v + corner * chart_.n - Vec3(0, bottom, p_.corner());
  }

  /// Height of what rows of an unbent cutter leave whose rounding ends `above` the plane: cylinders' and feed marks'.
  double rows_left(double v, double above, int first, int last) const {
    const double r = p_.corner() - above;
    double low = 1e9;
    for (int row = first; row <= last; ++row) {
      const double d = v - row_at(row);
      if (std::abs(d) < r) low = std::min(low, p_.corner() - std::sqrt(r * r - d * d));
    }
    return low;
  }

  HeightMap blank() const {
    constexpr int kMany = 12;
    const int last = s_.bent_rows - 1;
    const double end = row_at(last) + kBeside * way();
    const double begin = -1.5 * p_.row_mm * way() - 0.2 * way();
    const HeightMap::Window w{0, s_.length_mm, std::min(begin, end), std::max(begin, end), s_.grid_mm, s_.grid_mm};
    return {chart_, w, [&](double, double v) {
              return std::min(rows_left(v, p_.allowance_mm, -kMany, last + kMany), rows_left(v, 0, -kMany, -1));
            }};
  }

  std::vector<Period> run(TimeDomainMilling& milling, int row) const {
    const double along = p_.along_x != 0 ? p_.along_x : row % 2 ? 1 : -1;
    const Vec3 left = tip(-1.4, row_at(row), p_.corner()), right = tip(s_.length_mm + 1.4, row_at(row), p_.corner());
    return milling.run(along > 0 ? left : right, along > 0 ? right : left, p_.feed_mm);
  }

  InclinedPlane p_;
  JudgeSteps s_;
  double slope_;
  TurningTool tool_;
  Chart chart_;
};

}  // namespace detail

inline JudgedFigures judged_figures(const InclinedPlane& p, const JudgeSteps& s = {}) {
  return detail::PlaneJudge(p, s).figures();
}

/// Chips of a tooth passing over what the finished surface says that it has taken: the allowance less the error, and
/// the cusps that the blank and the surface have.
inline double chips_over_surface(const InclinedPlane& p, const CutFigures& f) {
  const double cusps = (p.feed_mm * p.feed_mm + p.row_mm * p.row_mm) / 24;
  const double blank = p.allowance_mm + cusps / (p.radius_mm - p.allowance_mm), left = cusps / p.radius_mm;
  return f.chip_mm3 / (p.feed_mm * p.row_mm * (blank - left - f.error_mean_um / 1000));
}

}  // namespace camber::testing
