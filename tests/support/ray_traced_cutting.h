#pragma once
// A second way to chip thickness and force, slow and obvious, from the geometry alone: no field, no grid, no formula
// for the chip. A point is material if it is in the box and in none of the cutters that stood there before. The chip is
// the length of the ray from a point of the edge inwards, against the normal, that runs in material. No tooth advances
// by more than the feed: a longer ray has passed the tooth before beside its edge (below a flat end, ahead of its
// corner); then the ray goes back along the feed instead, and its length times the cosine between feed and normal
// counts.
#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "base/geometry.h"
#include "removal/tool_path.h"

namespace camber::testing {

/// A cutter as its maker would draw it: what is inside, and where its edge runs.
struct DrawnCutter {
  struct EdgePoint {
    double r, z, kappa, width;  ///< kappa: normal from -z outwards; width along the profile
  };
  std::function<bool(double r, double z)> inside;
  std::vector<EdgePoint> edge;
  double radius = 0;  ///< half the diameter, of the helix
};

/// A cylinder with a rounded bottom edge: corner = 0 flat, = radius ball.
inline DrawnCutter drawn_end_mill(double radius, double corner, double top, double step) {
  DrawnCutter c;
  c.radius = radius;
  c.inside = [=](double r, double z) {
    if (r >= radius || z <= 0) return false;
    const double a = r - (radius - corner), b = corner - z;
    return a <= 0 || b <= 0 || a * a + b * b < corner * corner;
  };
  const auto add = [&](double length, auto at) {
    const int n = static_cast<int>(std::ceil(length / step));
    for (int i = 0; i < n; ++i) c.edge.push_back(at((i + 0.5) * length / n, length / n));
  };
  if (radius > corner) add(radius - corner, [&](double s, double w) { return DrawnCutter::EdgePoint{s, 0, 0, w}; });
  if (corner > 0)
    add(corner * kPi / 2, [&](double s, double w) {
      const double k = s / corner;
      return DrawnCutter::EdgePoint{radius - corner + corner * std::sin(k), corner - corner * std::cos(k), k, w};
    });
  if (top > corner)
    add(top - corner, [&](double s, double w) { return DrawnCutter::EdgePoint{radius, corner + s, kPi / 2, w}; });
  return c;
}

/// A ball of `radius`, then a wall that leans by `taper` from the axis.
inline DrawnCutter drawn_tapered_ball(double radius, double taper, double top, double step) {
  DrawnCutter c;
  c.radius = radius;
  const double t = std::tan(taper), at_r = radius * std::cos(taper), at_z = radius * (1 - std::sin(taper));
  c.inside = [=](double r, double z) {
    if (z <= 0) return false;
    if (z > at_z) return r < at_r + (z - at_z) * t;
    return r <= 0 || r * r + (z - radius) * (z - radius) < radius * radius;
  };
  const double turn = kPi / 2 - taper;
  const int arc = static_cast<int>(std::ceil(turn * radius / step));
  for (int i = 0; i < arc; ++i) {
    const double k = (i + 0.5) * turn / arc;
    c.edge.push_back({radius * std::sin(k), radius * (1 - std::cos(k)), k, turn * radius / arc});
  }
  const double rise = std::max(0.0, top - at_z);
  const int wall = static_cast<int>(std::ceil(rise / std::cos(taper) / step));
  for (int i = 0; i < wall; ++i) {
    const double up = (i + 0.5) * rise / wall;
    c.edge.push_back({at_r + up * t, at_z + up, turn, rise / std::cos(taper) / wall});
  }
  return c;
}

/// A flat of tip_radius, then a cone at half_angle to the axis up to `radius`, then a wall.
inline DrawnCutter drawn_chamfer(double tip_radius, double radius, double half_angle, double top, double step) {
  DrawnCutter c;
  c.radius = radius;
  const double t = std::tan(half_angle);
  c.inside = [=](double r, double z) { return z > 0 && r < radius && r < tip_radius + z * t; };
  const int flat = static_cast<int>(std::ceil(tip_radius / step));
  for (int i = 0; i < flat; ++i) c.edge.push_back({(i + 0.5) * tip_radius / flat, 0, 0, tip_radius / flat});
  const double rise = std::min(top, (radius - tip_radius) / t), length = rise / std::cos(half_angle);
  const int n = static_cast<int>(std::ceil(length / step));
  for (int i = 0; i < n; ++i) {
    const double z = (i + 0.5) * rise / n;
    c.edge.push_back({tip_radius + z * t, z, kPi / 2 - half_angle, length / n});
  }
  const int wall = static_cast<int>(std::ceil(std::max(0.0, top - rise) / step));
  for (int i = 0; i < wall; ++i)
    c.edge.push_back({radius, rise + (i + 0.5) * (top - rise) / wall, kPi / 2, (top - rise) / wall});
  return c;
}

struct DrawnForce {
  Vec3 mean_N = Vec3::Zero();
  double lateral_max_N = 0;
  double chip_mm3 = 0;
};

struct DrawnCoefficients {
  double ktc, krc, kac, kte, kre, kae;
};

/// Force on the tool at each stamp.
inline std::vector<DrawnForce> ray_traced_forces(const DrawnCutter& cutter, int flutes, double helix_rad,
                                                 const Vec3& lo, const Vec3& hi,
                                                 const std::vector<removal::Stamp>& stamps, const DrawnCoefficients& k,
                                                 int steps_per_pitch) {
  constexpr double kStep = 0.004;
  const auto in_material = [&](const Vec3& q, std::size_t now) {
    if ((q.array() < lo.array()).any() || (q.array() > hi.array()).any()) return false;
    for (std::size_t i = now; i-- > 0;) {
      const Vec3 d = q - stamps[i].pose.tip_mm;
      if (cutter.inside(std::hypot(d.x(), d.y()), d.z())) return false;
    }
    return true;
  };
  const auto ray = [&](const Vec3& p, const Vec3& back, double longest, std::size_t now) {
    double length = 0;
    if (!in_material(p - 1e-4 * back, now)) return length;
    while (length < longest && in_material(p - (length + kStep) * back, now)) length += kStep;
    double beyond = length + kStep;
    for (int i = 0; i < 12; ++i) {
      const double middle = (length + beyond) / 2;
      (in_material(p - middle * back, now) ? length : beyond) = middle;
    }
    return std::min((length + beyond) / 2, longest);
  };
  const auto chip = [&](const Vec3& p, const Vec3& n, std::size_t now) {
    const Vec3& feed = stamps[now].feed_per_tooth_mm;
    const double inwards = ray(p, n, 2 * feed.norm(), now);
    if (inwards <= feed.norm()) return inwards;
    return std::max(0.0, feed.normalized().dot(n)) * ray(p, feed.normalized(), feed.norm(), now);
  };
  std::vector<DrawnForce> out(stamps.size());
  const int steps = steps_per_pitch * flutes;
  for (std::size_t now = 0; now < stamps.size(); ++now) {
    std::vector<Vec3> force(static_cast<std::size_t>(steps_per_pitch), Vec3::Zero());
    for (const auto& e : cutter.edge)
      for (int a = 0; a < steps; ++a) {
        const double phi = 2 * kPi * a / steps + e.z * std::tan(helix_rad) / cutter.radius;
        const Vec3 out_of_axis(std::cos(phi), std::sin(phi), 0);
        const Vec3 n = std::sin(e.kappa) * out_of_axis - std::cos(e.kappa) * Vec3::UnitZ();
        const Vec3 p = stamps[now].pose.tip_mm + e.r * out_of_axis + e.z * Vec3::UnitZ();
        const double h = chip(p, n, now);
        if (h <= 0) continue;
        // Clockwise from above: the edge moves along z x r the other way.
        const Vec3 motion = out_of_axis.cross(Vec3::UnitZ());
        const Vec3 meridian = std::cos(e.kappa) * out_of_axis + std::sin(e.kappa) * Vec3::UnitZ();
        force[static_cast<std::size_t>(a % steps_per_pitch)] -=
            e.width * ((k.ktc * h + k.kte) * motion + (k.krc * h + k.kre) * n + (k.kac * h + k.kae) * meridian);
        out[now].chip_mm3 += h * e.width * e.r * 2 * kPi / steps;
      }
    for (const Vec3& f : force) {
      out[now].mean_N += f / steps_per_pitch;
      out[now].lateral_max_N = std::max(out[now].lateral_max_N, f.head<2>().norm());
    }
  }
  return out;
}

}  // namespace camber::testing
