#pragma once
// A second way to the static equilibrium, slow and obvious: shoulders of a flat end mill on a sideways spring, tooth
// passing by tooth passing. A slice of the cutter leaves the closed curve of its edge's places, each moved by the bend
// of its instant; a chip is as long as the ray from the edge, bent as it is, back to the curves that were left before,
// or to the block's faces. The bend of an instant is the root of bend = F / stiffness. No field, no carving, no formula
// for a chip or for how it changes with the bend; of Camber nothing is taken.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "base/units.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"

namespace camber::testing {

/// Feed along +X, the tip's path along the X axis.
struct DeflectedShoulder {
  bool up = true;
  double radius_mm = 5, helix_deg = 30, depth_mm = 2, radial_mm = 1, feed_mm = 0.05;
  double stiffness_N_per_mm = 5000;
  double ktc = 1800, krc = 700, kte = 0, kre = 0;
  double edge_ramp_mm = 0.002;  ///< below it the edge terms grow from nothing
  double from_mm = -4.2, to_mm = 3;
  int flutes = 2;
  int instants = 360;  ///< a pitch
  int slices = 40;

  std::size_t passings() const { return static_cast<std::size_t>((to_mm - from_mm) / feed_mm); }
  double tip_x(std::size_t k) const { return from_mm + feed_mm * static_cast<double>(k + 1); }
  Vec2 lo() const { return {0, up ? radius_mm - radial_mm : -radius_mm - 1}; }
  Vec2 hi() const { return {12, up ? radius_mm + 1 : radial_mm - radius_mm}; }
};

struct PassingFigures {
  double lateral_max_N = 0;
  Vec2 mean_N = Vec2::Zero();
};

class DrawnShoulder {
 public:
  explicit DrawnShoulder(const DeflectedShoulder& s) : s_(s) {}

  /// One a tooth passing.
  std::vector<PassingFigures> cut() {
    std::vector<PassingFigures> out;
    for (std::size_t k = 0; k < s_.passings(); ++k) {
      std::vector<Vec2> bend(static_cast<std::size_t>(s_.instants), Vec2::Zero());
      PassingFigures f;
      Vec2 guess = Vec2::Zero();
      for (int i = 0; i < s_.instants; ++i) {
        guess = settle(k, i, bends_.empty() ? guess : bends_.back()[static_cast<std::size_t>(i)]);
        bend[static_cast<std::size_t>(i)] = guess;
        const Vec2 force = force_N(k, i, guess);
        f.lateral_max_N = std::max(f.lateral_max_N, force.norm());
        f.mean_N += force / s_.instants;
      }
      bends_.push_back(std::move(bend));
      out.push_back(f);
    }
    return out;
  }

 private:
  double lag_rad(int slice) const {
    return (slice + 0.5) * s_.depth_mm / s_.slices * std::tan(rad_from_deg(s_.helix_deg)) / s_.radius_mm;
  }
  double instant_rad() const { return 2 * kPi / (s_.flutes * s_.instants); }

  Vec2 bend(std::size_t j, double phi, double lag) const {
    double at = (phi - lag) / instant_rad();
    at -= s_.instants * std::floor(at / s_.instants);
    const auto m = static_cast<std::size_t>(at) % static_cast<std::size_t>(s_.instants);
    const double f = at - std::floor(at);
    return (1 - f) * bends_[j][m] + f * bends_[j][(m + 1) % static_cast<std::size_t>(s_.instants)];
  }

  /// How far a place lies out of the curve that tooth passing j left, by its direction from the axis.
  double out_of_curve_mm(std::size_t j, const Vec2& q, double lag) const {
    const Vec2 r = q - Vec2(s_.tip_x(j), 0);
    const double direction = std::atan2(r.y(), r.x());
    double phi = direction;
    Vec2 place = Vec2::Zero();
    for (int i = 0; i < 3; ++i) {
      place = s_.radius_mm * Vec2(std::cos(phi), std::sin(phi)) + bend(j, phi, lag);
      const double off = direction - std::atan2(place.y(), place.x());
      phi += off - 2 * kPi * std::round(off / (2 * kPi));
    }
    return r.norm() - place.norm();
  }

  double chip_mm(std::size_t k, double phi, double lag, const Vec2& bent) const {
    const Vec2 n(std::cos(phi), std::sin(phi));
    const Vec2 p = Vec2(s_.tip_x(k), 0) + s_.radius_mm * n + bent;
    if ((p.array() < s_.lo().array()).any() || (p.array() > s_.hi().array()).any()) return 0;
    double longest = 2 * s_.feed_mm + 1;
    for (int a = 0; a < 2; ++a) {  // to the block's faces
      if (n[a] > 1e-9) longest = std::min(longest, (p[a] - s_.lo()[a]) / n[a]);
      if (n[a] < -1e-9) longest = std::min(longest, (p[a] - s_.hi()[a]) / n[a]);
    }
    constexpr std::size_t kBefore = 8;
    for (std::size_t j = k - std::min(k, kBefore); j < k; ++j) {
      if (out_of_curve_mm(j, p, lag) <= 0) return 0;
      double length = 0;
      for (int i = 0; i < 4 && length < longest; ++i)
        length += out_of_curve_mm(j, p - length * n, lag) / slope(j, k, phi);
      longest = std::min(longest, length);
    }
    return longest;
  }
  /// How fast the distance falls along the ray, nearly: the axes lie apart.
  double slope(std::size_t j, std::size_t k, double phi) const {
    const double across = s_.feed_mm * static_cast<double>(k - j) * std::sin(phi) / s_.radius_mm;
    return std::sqrt(1 - std::min(0.5, across * across));
  }

  Vec2 force_N(std::size_t k, int instant, const Vec2& bent) const {
    Vec2 sum = Vec2::Zero();
    const double width = s_.depth_mm / s_.slices;
    for (int i = 0; i < s_.slices; ++i)
      for (int tooth = 0; tooth < s_.flutes; ++tooth) {
        const double phi = instant * instant_rad() + 2 * kPi * tooth / s_.flutes + lag_rad(i);
        const double h = chip_mm(k, phi, lag_rad(i), bent);
        if (h <= 0) continue;
        const double edge = std::min(1.0, h / s_.edge_ramp_mm);
        // Clockwise from above: the edge at phi moves along (sin phi, -cos phi).
        sum -= width * (s_.ktc * h + s_.kte * edge) * Vec2(std::sin(phi), -std::cos(phi));
        sum -= width * (s_.krc * h + s_.kre * edge) * Vec2(std::cos(phi), std::sin(phi));
      }
    return sum;
  }

  /// Newton's method with differences, halved steps.
  Vec2 settle(std::size_t k, int instant, Vec2 bent) const {
    const auto left = [&](const Vec2& b) { return Vec2(force_N(k, instant, b) / s_.stiffness_N_per_mm - b); };
    Vec2 r = left(bent);
    for (int i = 0; i < 40 && r.norm() > 1e-7; ++i) {
      constexpr double kSmall = 2e-6;
      Eigen::Matrix2d slope;
      for (int a = 0; a < 2; ++a) slope.col(a) = (left(bent + kSmall * Vec2::Unit(a)) - r) / kSmall;
      const Vec2 step = -slope.inverse() * r;
      double fraction = 1;
      Vec2 next = left(bent + step);
      while (next.norm() > r.norm() && fraction > 0.01) next = left(bent + (fraction /= 2) * step);
      bent += fraction * step;
      r = next;
    }
    return bent;
  }

  DeflectedShoulder s_;
  std::vector<std::vector<Vec2>> bends_;  ///< [tooth passing][instant]
};

inline std::vector<PassingFigures> camber_figures(const DeflectedShoulder& s,
                                                  machine::Coupling coupling = machine::Coupling::static_) {
  auto tool = make_tool(machine::ToolType::flat, 2 * s.radius_mm, s.flutes, s.helix_deg);
  tool.youngs_modulus_MPa = 1e12;
  tool.root_stiffness_N_per_mm = s.stiffness_N_per_mm;
  const machine::Material material{s.ktc, s.krc, 0, s.kte, s.kre, 0};
  const double floor = -s.depth_mm;
  auto stock = make_box({s.lo().x(), s.lo().y(), floor}, {s.hi().x(), s.hi().y(), 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  // The tip below the block: only the wall cuts.
  for (std::size_t k = 0; k < s.passings(); ++k)
    stamps.push_back(
        {.pose = {.tip_mm = {s.tip_x(k), 0, floor - 0.5}}, .feed_per_tooth_mm = {s.feed_mm, 0, 0}, .first = k == 0});
  simulate::CutOptions options;
  options.coupling = coupling;
  options.edge_ramp_mm = s.edge_ramp_mm;
  const auto result = simulate::cut(stock, tool, material, stamps, {}, 0, options);
  std::vector<PassingFigures> out;
  for (const auto& load : result.loads) out.push_back({load.lateral_max_N, load.force_mean_N.head<2>()});
  return out;
}

}  // namespace camber::testing
