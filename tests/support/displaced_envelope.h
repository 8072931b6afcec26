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
  double radius = 3, corner = 3;  ///< of the cutter; corner = radius: ball, 0: flat
  int flutes = 2;
  double helix_rad = 0;
  double top = 1;  ///< nothing is cut higher than this above the tip
  std::vector<removal::Stamp> stamps;
  Vec3 lo = Vec3::Constant(-1e9), hi = Vec3::Constant(1e9);  ///< of the blank's box
  /// What the pass before has left: the same stamps with the cutter smaller by this; 0: the whole box.
  double allowance = 0;
  std::vector<removal::Stamp> pass_before{};  ///< where that pass went, if not along `stamps`
  DrawnCoefficients k{};
  /// A straight bar of one diameter, held at `overhang`: its bending stiffness E I, and the stiffness at its root.
  double overhang = 40, bending_stiffness_N_mm2 = 1, root_stiffness_N_per_mm = 1e300;
  int steps_per_pitch = 360;
  double edge_step = 0.03;
};

/// Deflection at z_out under a unit force at z_force, both from the tip: textbook cantilever.
inline double bar_compliance(const DrawnCut& c, double z_out, double z_force) {
  const double a = c.overhang - z_force, x = c.overhang - z_out;  // from the root
  const double bent = x <= a ? x * x * (3 * a - x) : a * a * (3 * x - a);
  return bent / (6 * c.bending_stiffness_N_mm2) + 1 / c.root_stiffness_N_per_mm;
}

/// One tooth passing.
struct DrawnPass {
  std::vector<Vec3> force_N;               ///< by instant
  std::vector<std::vector<Vec2>> bend_mm;  ///< [height, 0 to top in equal steps][instant]
  double height_step = 0;
  Vec3 mean_N = Vec3::Zero();
  double lateral_max_N = 0, chip_mm3 = 0;

  /// Where the cutter's axis is bent to at height z as the edge passes the direction phi.
  Vec2 bend(double z, double phi, const DrawnCut& c) const {
    const int n = c.steps_per_pitch;
    double at = (phi - z * std::tan(c.helix_rad) / c.radius) * n * c.flutes / (2 * kPi);
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

inline DrawnPass drawn_pass(const DrawnCut& c, std::size_t now) {
  constexpr double kStep = 0.004;
  const DrawnCutter cutter = drawn_end_mill(c.radius, c.corner, c.top, c.edge_step);
  const Vec3 tip = c.stamps[now].tip_mm, feed = c.stamps[now].feed_per_tooth_mm;
  // Cutters that stand too far away to have cut anything that this one meets are left out.
  std::vector<Vec3> before, any;
  for (std::size_t i = 0; i < c.stamps.size(); ++i) {
    const Vec3 d = c.stamps[i].tip_mm - tip;
    if (d.norm() > 2 * c.radius + 0.1) continue;
    if (c.pass_before.empty()) any.push_back(c.stamps[i].tip_mm);
    if (i < now) before.push_back(c.stamps[i].tip_mm);
  }
  for (const removal::Stamp& s : c.pass_before)
    if ((s.tip_mm - tip).norm() <= 2 * c.radius + 0.1) any.push_back(s.tip_mm);
  const auto nearer = [&](const Vec3& a, const Vec3& b) { return (a - tip).norm() < (b - tip).norm(); };
  std::sort(before.begin(), before.end(), nearer);
  std::sort(any.begin(), any.end(), nearer);
  const DrawnCutter smaller = drawn_end_mill(c.radius - c.allowance, std::max(0.0, c.corner - c.allowance), c.top, 1);
  const auto in_material = [&](const Vec3& q) {
    if ((q.array() < c.lo.array()).any() || (q.array() > c.hi.array()).any()) return false;
    for (const Vec3& t : before)
      if (cutter.inside(std::hypot(q.x() - t.x(), q.y() - t.y()), q.z() - t.z())) return false;
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
  const auto chip = [&](const Vec3& p, const Vec3& n) {
    if (!in_material(p - 1e-6 * n)) return 0.0;
    const double inwards = ray(p, n, 2 * feed.norm());
    if (inwards <= feed.norm()) return inwards;
    return std::max(0.0, feed.normalized().dot(n)) * ray(p, feed.normalized(), feed.norm());
  };

  DrawnPass out;
  const auto per_pitch = static_cast<std::size_t>(c.steps_per_pitch);
  const int steps = c.steps_per_pitch * c.flutes;
  out.force_N.assign(per_pitch, Vec3::Zero());
  const auto levels = static_cast<std::size_t>(std::max(2.0, std::ceil(c.top / 0.1) + 1));
  out.height_step = c.top / static_cast<double>(levels - 1);
  out.bend_mm.assign(levels, std::vector<Vec2>(per_pitch, Vec2::Zero()));
  for (const auto& e : cutter.edge)
    for (int a = 0; a < steps; ++a) {
      const double phi = 2 * kPi * a / steps + e.z * std::tan(c.helix_rad) / c.radius;
      const Vec3 out_of_axis(std::cos(phi), std::sin(phi), 0);
      const Vec3 n = std::sin(e.kappa) * out_of_axis - std::cos(e.kappa) * Vec3::UnitZ();
      const double h = chip(tip + e.r * out_of_axis + e.z * Vec3::UnitZ(), n);
      if (h <= 0) continue;
      // Clockwise from above: the edge moves along r x z.
      const Vec3 motion = out_of_axis.cross(Vec3::UnitZ());
      const Vec3 meridian = std::cos(e.kappa) * out_of_axis + std::sin(e.kappa) * Vec3::UnitZ();
      const Vec3 f = -e.width * ((c.k.ktc * h + c.k.kte) * motion + (c.k.krc * h + c.k.kre) * n +
                                 (c.k.kac * h + c.k.kae) * meridian);
      const std::size_t instant = static_cast<std::size_t>(a) % per_pitch;
      out.force_N[instant] += f;
      for (std::size_t i = 0; i < levels; ++i)
        out.bend_mm[i][instant] +=
            bar_compliance(c, static_cast<double>(i) * out.height_step, e.z) * Vec2(f.x(), f.y());
      out.chip_mm3 += h * e.width * e.r * 2 * kPi / steps;
    }
  for (const Vec3& f : out.force_N) {
    out.mean_N += f / c.steps_per_pitch;
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
  const int arc = std::max(1, static_cast<int>(std::ceil(c.corner * kPi / 2 / kFacet)));
  for (int i = 0; i <= (c.corner > 0 ? arc : 0); ++i) {
    const double a = c.corner > 0 ? kPi / 2 * i / arc : 0;
    rings.push_back({c.radius - c.corner + c.corner * std::sin(a), c.corner - c.corner * std::cos(a)});
  }
  const int wall = static_cast<int>(std::ceil(std::max(0.0, c.top - c.corner) / kFacet));
  for (int i = 1; i <= wall; ++i) rings.push_back({c.radius, c.corner + (c.top - c.corner) * i / wall});
  const int around = std::max(1440, c.steps_per_pitch * c.flutes);
  struct Corner {
    Vec3 place;
    bool close;
  };
  std::vector<Corner> last, line(static_cast<std::size_t>(around) + 1);
  const Vec3 tip = c.stamps[k].tip_mm;
  for (const Ring& ring : rings) {
    for (int i = 0; i <= around; ++i) {
      const double phi = 2 * kPi * i / around;
      Vec3 p = tip + Vec3(ring.r * std::cos(phi), ring.r * std::sin(phi), ring.z) - s.origin;
      const bool close = p.dot(s.n) < clearance;
      if (pass && close) p.head<2>() += pass->bend(std::min(ring.z, c.top), phi, c);
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
