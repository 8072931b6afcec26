#pragma once
// A second way to force, deflection and form error of the uncoupled ("rigid") cut, slow and obvious: chips are lengths
// of rays through what is in the blank and in none of the cutters that stood there before; the surface is the lower
// hull of the envelopes, drawn as facets whose corners are moved by the deflection of the instant at which an edge
// passes them. No field, no carving, no formula for a chip; of Camber only the list of stamps is taken.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Geometry>

#include "tests/support/ray_traced_cutting.h"

namespace camber::testing {

/// A cut: the cutter, where it stands at every tooth passing, and what it meets.
struct DrawnCut {
  double radius = 3, corner = 3;  ///< radii of the cutter; corner = radius: ball, 0: flat
  double taper_rad = 0;           ///< angle of a ball's wall from the axis
  int flutes = 2;
  double helix_rad = 0;
  /// Where teeth that are not even stand from the first one, against the turning direction; empty: even teeth.
  std::vector<double> tooth_at_rad{};
  double run_out_mm = 0, run_out_rad = 0;  ///< offset of the axis, its direction from the first tooth; with the former
  double top = 1;                          ///< nothing is cut higher than this above the tip
  std::vector<removal::Stamp> stamps;
  Vec3 lo = Vec3::Constant(-1e9), hi = Vec3::Constant(1e9);  ///< corners of the blank's box
  /// What the pass before has left: the same stamps with the cutter smaller by this; 0: the whole box.
  double allowance = 0;
  std::vector<removal::Stamp> pass_before{};  ///< where that pass went, if not along `stamps`
  DrawnCoefficients k{};
  /// A straight bar of one diameter, held at `overhang`: its bending stiffness E I, and the stiffness at its root.
  double overhang = 40, bending_stiffness_N_mm2 = 1, root_stiffness_N_per_mm = 1e300;
  int steps_per_pitch = 360;
  double edge_step = 0.03;

  bool even() const { return tooth_at_rad.empty(); }
  int steps() const { return steps_per_pitch * flutes; }  ///< a turn
  /// Rotation steps of a turn, after which the force is the same again.
  int instants() const { return even() ? steps_per_pitch : steps(); }
  std::size_t tooth_of(std::size_t passing) const { return even() ? 0 : passing % tooth_at_rad.size(); }
  double tooth_rad(std::size_t tooth) const { return even() ? 0.0 : tooth_at_rad[tooth]; }
  double lag_rad(double z) const { return z * std::tan(helix_rad) / radius; }
  /// How much further out than the cutter's own radius a tooth turns.
  double tooth_runout_mm(std::size_t tooth, double z) const {
    return even() ? 0.0 : run_out_mm * std::cos(tooth_at_rad[tooth] + lag_rad(z) - run_out_rad);
  }
  /// Where the tip stands as the tooth of a passing cuts: a late tooth comes when the tool is further on.
  Vec3 tip(std::size_t passing) const {
    const removal::Stamp& s = stamps[passing];
    if (even()) return s.pose.tip_mm;
    const auto tooth = static_cast<double>(tooth_of(passing));
    return s.pose.tip_mm + (tooth_rad(tooth_of(passing)) * flutes / (2 * kPi) - tooth) * s.feed_per_tooth_mm;
  }
  DrawnCutter cutter(double smaller, double step) const {
    const double r = radius - smaller, inner = std::max(0.0, corner - smaller);
    return taper_rad > 0 ? drawn_tapered_ball(r, taper_rad, top, step) : drawn_end_mill(r, inner, top, step);
  }
};

/// Deflection at z_out under a unit force at z_force, both from the tip: textbook cantilever. Of a tapered bar, whose
/// stiffness is that of the ball's diameter, by the unit load.
inline double bar_compliance(const DrawnCut& c, double z_out, double z_force) {
  if (c.taper_rad > 0) {
    constexpr int kSlices = 400;
    const double from = std::max(z_out, z_force), ds = (c.overhang - from) / kSlices;
    const double wall = std::cos(c.taper_rad) - (1 - std::sin(c.taper_rad)) * std::tan(c.taper_rad);
    double sum = 1 / c.root_stiffness_N_per_mm;
    for (int i = 0; i < kSlices; ++i) {
      const double at = from + (i + 0.5) * ds, wider = wall + at * std::tan(c.taper_rad) / c.radius;
      sum += (at - z_out) * (at - z_force) * ds / (c.bending_stiffness_N_mm2 * std::pow(wider, 4));
    }
    return sum;
  }
  const double a = c.overhang - z_force, x = c.overhang - z_out;  // from the root
  const double bent = x <= a ? x * x * (3 * a - x) : a * a * (3 * x - a);
  return bent / (6 * c.bending_stiffness_N_mm2) + 1 / c.root_stiffness_N_per_mm;
}

/// One tooth passing; of teeth that are not even one turn.
struct DrawnPass {
  std::vector<Vec3> force_N;               ///< by instant
  std::vector<std::vector<Vec2>> bend_mm;  ///< [height, 0 to top in equal steps][instant]
  double height_step = 0;
  Vec3 mean_N = Vec3::Zero();
  double lateral_max_N = 0, chip_mm3 = 0;

  /// Where the cutter's axis is bent to at height z as the edge of a tooth passes the direction phi.
  Vec2 bend(double z, double phi, const DrawnCut& c, std::size_t tooth = 0) const {
    const int n = c.instants();
    double at = (phi - c.tooth_rad(tooth) - c.lag_rad(z)) * c.steps() / (2 * kPi);
    at -= n * std::floor(at / n);
    const int m = static_cast<int>(at) % n, next = (m + 1) % n;
    const double f = at - std::floor(at);
    const double up = std::clamp(z / height_step, 0.0, static_cast<double>(bend_mm.size() - 1) - 1e-9);
    const auto r = static_cast<std::size_t>(up);
    const double g = up - static_cast<double>(r);
    const auto level = [&](const std::vector<Vec2>& v) {
      return Vec2((1 - f) * v[static_cast<std::size_t>(m)] + f * v[static_cast<std::size_t>(next)]);
    };
    return (1 - g) * level(bend_mm[r]) + g * level(bend_mm[r + 1]);
  }
};

namespace detail {

/// Adds what the edge of passing `now`'s tooth does all around.
inline void add_tooth(const DrawnCut& c, std::size_t now, DrawnPass& out) {
  constexpr double kStep = 0.004;
  const DrawnCutter cutter = c.cutter(0, c.edge_step);
  const Vec3 tip = c.tip(now), feed = c.stamps[now].feed_per_tooth_mm;
  const std::size_t tooth = c.tooth_of(now);
  // Cutters that stand too far away to have cut anything that this one meets are left out.
  struct Before {
    Vec3 tip;
    std::size_t tooth;
  };
  std::vector<Before> before;
  std::vector<Vec3> any;
  const double far = 2 * (c.radius + c.top * std::tan(c.taper_rad)) + 0.1;
  for (std::size_t i = 0; i < c.stamps.size(); ++i) {
    if ((c.stamps[i].pose.tip_mm - tip).norm() > far) continue;
    if (c.pass_before.empty()) any.push_back(c.stamps[i].pose.tip_mm);
    if (i < now) before.push_back({c.tip(i), c.tooth_of(i)});
  }
  for (const removal::Stamp& s : c.pass_before)
    if ((s.pose.tip_mm - tip).norm() <= far) any.push_back(s.pose.tip_mm);
  const auto nearer = [&](const Vec3& a, const Vec3& b) { return (a - tip).norm() < (b - tip).norm(); };
  std::sort(before.begin(), before.end(), [&](const Before& a, const Before& b) { return nearer(a.tip, b.tip); });
  std::sort(any.begin(), any.end(), nearer);
  const DrawnCutter smaller = c.cutter(c.allowance, 1);
  const auto in_material = [&](const Vec3& q) {
    if ((q.array() < c.lo.array()).any() || (q.array() > c.hi.array()).any()) return false;
    for (const Before& b : before) {
      const double z = q.z() - b.tip.z();
      if (cutter.inside(std::hypot(q.x() - b.tip.x(), q.y() - b.tip.y()) - c.tooth_runout_mm(b.tooth, z), z))
        return false;
    }
    if (c.allowance > 0)
      for (const Vec3& t : any)
        if (smaller.inside(std::hypot(q.x() - t.x(), q.y() - t.y()), q.z() - t.z() - c.allowance)) return false;
    return true;
  };
  const auto ray = [&](const Vec3& p, const Vec3& back, double longest) {
    double length = 0;
    while (length < longest && in_material(p - (length + kStep) * back)) length += kStep;
    double beyond = length + kStep;
    for (int i = 0; i < 14; ++i) {
      const double middle = (length + beyond) / 2;
      (in_material(p - middle * back) ? length : beyond) = middle;
    }
    return std::min((length + beyond) / 2, longest);
  };
  // Of teeth that are not even one may take what all of them would.
  const double thickest = feed.norm() * (c.even() ? 1 : c.flutes) + 2 * c.run_out_mm;
  const auto chip = [&](const Vec3& p, const Vec3& n) {
    if (!in_material(p - 1e-6 * n)) return 0.0;
    const double inwards = ray(p, n, 2 * thickest);
    if (inwards <= thickest) return inwards;
    return std::max(0.0, feed.normalized().dot(n)) * ray(p, feed.normalized(), thickest);
  };
  const int steps = c.steps();
  for (const auto& e : cutter.edge) {
    std::vector<double> compliance;
    for (std::size_t i = 0; i < out.bend_mm.size(); ++i)
      compliance.push_back(bar_compliance(c, static_cast<double>(i) * out.height_step, e.z));
    for (int a = 0; a < steps; ++a) {
      const double phi = 2 * kPi * a / steps + c.tooth_rad(tooth) + c.lag_rad(e.z);
      const Vec3 out_of_axis(std::cos(phi), std::sin(phi), 0);
      const Vec3 n = std::sin(e.kappa) * out_of_axis - std::cos(e.kappa) * Vec3::UnitZ();
      const double h = chip(tip + (e.r + c.tooth_runout_mm(tooth, e.z)) * out_of_axis + e.z * Vec3::UnitZ(), n);
      if (h <= 0) continue;
      // Clockwise from above: the edge moves along r x z.
      const Vec3 motion = out_of_axis.cross(Vec3::UnitZ());
      const Vec3 meridian = std::cos(e.kappa) * out_of_axis + std::sin(e.kappa) * Vec3::UnitZ();
      const Vec3 f = -e.width * ((c.k.ktc * h + c.k.kte) * motion + (c.k.krc * h + c.k.kre) * n +
                                 (c.k.kac * h + c.k.kae) * meridian);
      const std::size_t instant = static_cast<std::size_t>(a % c.instants());
      out.force_N[instant] += f;
      for (std::size_t i = 0; i < out.bend_mm.size(); ++i)
        out.bend_mm[i][instant] += compliance[i] * Vec2(f.x(), f.y());
      out.chip_mm3 += h * e.width * e.r * 2 * kPi / steps;
    }
  }
}

}  // namespace detail

/// Teeth that are not even: the turn from passing `now` on.
inline DrawnPass drawn_pass(const DrawnCut& c, std::size_t now) {
  DrawnPass out;
  const auto instants = static_cast<std::size_t>(c.instants());
  out.force_N.assign(instants, Vec3::Zero());
  const auto levels = static_cast<std::size_t>(std::max(2.0, std::ceil(c.top / 0.1) + 1));
  out.height_step = c.top / static_cast<double>(levels - 1);
  out.bend_mm.assign(levels, std::vector<Vec2>(instants, Vec2::Zero()));
  const std::size_t teeth = c.even() ? 1 : c.tooth_at_rad.size();
  for (std::size_t j = 0; j < teeth; ++j) detail::add_tooth(c, now + j, out);
  out.chip_mm3 /= static_cast<double>(teeth);
  for (const Vec3& f : out.force_N) {
    out.mean_N += f / static_cast<double>(instants);
    out.lateral_max_N = std::max(out.lateral_max_N, f.head<2>().norm());
  }
  return out;
}

/// Heights above a plane, at points of a lattice in it.
struct DrawnSurface {
  Vec3 origin, u, v, n;  ///< u, v span the plane, n looks out of the material
  int nu = 0, nv = 0;
  double du = 0, dv = 0;
  std::vector<double> height;

  DrawnSurface(const Vec3& origin_mm, const Vec3& u_axis, const Vec3& v_axis, int n_u, int n_v, double step_u,
               double step_v)
      : origin(origin_mm), u(u_axis), v(v_axis), n(u_axis.cross(v_axis)), nu(n_u), nv(n_v), du(step_u), dv(step_v) {
    height.assign(static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv), std::numeric_limits<double>::infinity());
  }
  double& at(int i, int j) {
    return height[static_cast<std::size_t>(i) * static_cast<std::size_t>(nv) + static_cast<std::size_t>(j)];
  }

  /// Lowers the lattice points that the triangle covers to it.
  void cut(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double x0 = a.x(), y0 = a.y(), x1 = b.x() - x0, y1 = b.y() - y0, x2 = c.x() - x0, y2 = c.y() - y0;
    const double det = x1 * y2 - x2 * y1;
    if (std::abs(det) < 1e-18) return;
    const auto [xl, xh] = std::minmax({a.x(), b.x(), c.x()});
    const auto [yl, yh] = std::minmax({a.y(), b.y(), c.y()});
    constexpr double kHair = 1e-9;
    const int i0 = std::max(0, static_cast<int>(std::ceil(xl / du))), i1 = std::min(nu - 1, static_cast<int>(xh / du));
    const int j0 = std::max(0, static_cast<int>(std::ceil(yl / dv))), j1 = std::min(nv - 1, static_cast<int>(yh / dv));
    for (int i = i0; i <= i1; ++i)
      for (int j = j0; j <= j1; ++j) {
        const double x = i * du - x0, y = j * dv - y0;
        const double s = (x * y2 - x2 * y) / det, t = (x1 * y - x * y1) / det;
        if (s < -kHair || t < -kHair || s + t > 1 + kHair) continue;
        at(i, j) = std::min(at(i, j), a.z() + s * (b.z() - a.z()) + t * (c.z() - a.z()));
      }
  }
};

/// Draws the envelope of stamp k onto the surface, bent by `pass` (null: straight). Facets that lie more than
/// `clearance` above the plane are left out.
inline void draw_envelope(const DrawnCut& c, std::size_t k, const DrawnPass* pass, DrawnSurface& s, double clearance) {
  constexpr double kFacet = 0.03;
  struct Ring {
    double r, z;
  };
  std::vector<Ring> rings;
  if (c.radius > c.corner) rings.push_back({0, 0});
  const double turn = kPi / 2 - c.taper_rad;  // of the rounding
  const int arc = std::max(1, static_cast<int>(std::ceil(c.corner * turn / kFacet)));
  for (int i = 0; i <= (c.corner > 0 ? arc : 0); ++i) {
    const double a = c.corner > 0 ? turn * i / arc : 0;
    rings.push_back({c.radius - c.corner + c.corner * std::sin(a), c.corner - c.corner * std::cos(a)});
  }
  const Ring end = rings.back();
  const int wall = static_cast<int>(std::ceil(std::max(0.0, c.top - end.z) / kFacet));
  for (int i = 1; i <= wall; ++i) {
    const double up = (c.top - end.z) * i / wall;
    rings.push_back({end.r + up * std::tan(c.taper_rad), end.z + up});
  }
  const int around = std::max(1440, c.steps());
  struct Corner {
    Vec3 place;
    bool close;
  };
  std::vector<Corner> last, line(static_cast<std::size_t>(around) + 1);
  const Vec3 tip = pass ? c.tip(k) : c.stamps[k].pose.tip_mm;
  const std::size_t tooth = c.tooth_of(k);
  for (const Ring& ring : rings) {
    const double r = ring.r + (pass ? c.tooth_runout_mm(tooth, ring.z) : 0.0);
    for (int i = 0; i <= around; ++i) {
      const double phi = 2 * kPi * i / around;
      Vec3 p = tip + Vec3(r * std::cos(phi), r * std::sin(phi), ring.z) - s.origin;
      const bool close = p.dot(s.n) < clearance;
      if (pass && close) p.head<2>() += pass->bend(std::min(ring.z, c.top), phi, c, tooth);
      line[static_cast<std::size_t>(i)] = {{p.dot(s.u), p.dot(s.v), p.dot(s.n)}, close};
    }
    if (!last.empty())
      for (std::size_t i = 0; i < static_cast<std::size_t>(around); ++i) {
        if (!last[i].close || !last[i + 1].close || !line[i].close || !line[i + 1].close) continue;
        s.cut(last[i].place, last[i + 1].place, line[i].place);
        s.cut(last[i + 1].place, line[i + 1].place, line[i].place);
      }
    last = line;
  }
}

/// Bent less straight surface, at the lattice points that both have.
/// `pass_of(k)` gives the tooth passing whose bending stamp k has.
inline std::vector<double> drawn_error_mm(const DrawnCut& c,
                                          const std::function<const DrawnPass&(std::size_t)>& pass_of,
                                          const std::vector<std::size_t>& stamps, const DrawnSurface& lattice,
                                          double clearance) {
  DrawnSurface straight = lattice, bent = lattice;
  for (const std::size_t k : stamps) {
    draw_envelope(c, k, nullptr, straight, clearance);
    draw_envelope(c, k, &pass_of(k), bent, clearance);
  }
  std::vector<double> out(straight.height.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (std::isfinite(straight.height[i]) && std::isfinite(bent.height[i]))
      out[i] = bent.height[i] - straight.height[i];
  return out;
}

}  // namespace camber::testing
