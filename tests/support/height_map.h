#pragma once
// A cut surface as heights over a plane or over a cylinder, for the time-domain simulation (time_domain_milling.h).
// Nothing here is taken from Camber but its vector type.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "base/geometry.h"

namespace camber::testing {

/// Coordinates (u, v, w) of a place; w grows out of the material.
struct Chart {
  Vec3 origin = Vec3::Zero();
  /// Plane: u and v span it, w = n . q. Cylinder (radius > 0): about the line through `origin` along Z; u is the angle
  /// from +X times `radius`, v the height, w the distance from the line, negative: material lies outside.
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY(), n = Vec3::UnitZ();
  double radius = 0;
  double middle_rad = 0;  ///< angles are counted within half a turn from here

  Vec3 of(const Vec3& place) const {
    const Vec3 q = place - origin;
    if (radius > 0)
      return {radius * (middle_rad + std::remainder(std::atan2(q.y(), q.x()) - middle_rad, 2 * kPi)), q.z(),
              -std::hypot(q.x(), q.y())};
    return {q.dot(u), q.dot(v), q.dot(n)};
  }
  /// Gradient of w - H(u, v) in space.
  Vec3 gradient(const Vec3& place, double by_u, double by_v) const {
    if (!(radius > 0)) return n - by_u * u - by_v * v;
    const Vec2 q = (place - origin).head<2>();
    const Vec2 out = q.normalized(), around(-out.y(), out.x());
    const Vec2 flat = -out - by_u * radius / q.norm() * around;
    return {flat.x(), flat.y(), -by_v};
  }
};

class HeightMap {
 public:
  static constexpr double kAir = -1e9;  ///< no material at all

  struct Window {
    double u_from = 0, u_to = 1, v_from = 0, v_to = 1, du = 0.02, dv = 0.02;
  };

  /// height(u, v): of the material.
  HeightMap(const Chart& chart, const Window& w, const std::function<double(double, double)>& height)
      : chart_(chart), w_(w) {
    nu_ = static_cast<int>(std::lround((w.u_to - w.u_from) / w.du)) + 1;
    nv_ = static_cast<int>(std::lround((w.v_to - w.v_from) / w.dv)) + 1;
    node_.resize(static_cast<std::size_t>(nu_) * static_cast<std::size_t>(nv_));
    for (int i = 0; i < nu_; ++i)
      for (int j = 0; j < nv_; ++j) {
        node(i, j).now = node(i, j).before = height(u(i), v(j));
        highest_ = std::max(highest_, node(i, j).now);
      }
  }

  const Chart& chart() const { return chart_; }
  double highest() const { return highest_; }
  int nu() const { return nu_; }
  int nv() const { return nv_; }
  double u(int i) const { return w_.u_from + i * w_.du; }
  double v(int j) const { return w_.v_from + j * w_.dv; }
  double height(int i, int j) const { return node(i, j).now; }

  struct Reading {
    double height, by_u, by_v;
  };
  /// The surface that tooth pass `pass` meets: what it has cut itself so far does not count.
  Reading read(double at_u, double at_v, std::int32_t pass) const {
    double a = (at_u - w_.u_from) / w_.du, b = (at_v - w_.v_from) / w_.dv;
    // A node stands for half a cell around it.
    if (!(a >= -0.5 && b >= -0.5 && a < nu_ - 0.5 && b < nv_ - 0.5)) return {kAir, 0, 0};
    a = std::clamp(a, 0.0, nu_ - 1.000001), b = std::clamp(b, 0.0, nv_ - 1.000001);
    const int i = static_cast<int>(a), j = static_cast<int>(b);
    const double f = a - i, g = b - j;
    const auto of = [pass](const Node& n) { return n.pass == pass ? n.before : n.now; };
    const double h00 = of(node(i, j)), h01 = of(node(i, j + 1)), h10 = of(node(i + 1, j)), h11 = of(node(i + 1, j + 1));
    if (std::min(std::min(h00, h01), std::min(h10, h11)) < 0.5 * kAir) return {kAir, 0, 0};
    return {(1 - f) * ((1 - g) * h00 + g * h01) + f * ((1 - g) * h10 + g * h11),
            ((1 - g) * (h10 - h00) + g * (h11 - h01)) / w_.du, ((1 - f) * (h01 - h00) + f * (h11 - h10)) / w_.dv};
  }

  /// Lowers what a triangle, its corners in the chart, covers.
  void cut(const Vec3& a, const Vec3& b, const Vec3& c, std::int32_t pass) {
    if (std::min({a.z(), b.z(), c.z()}) > highest_) return;
    // Across the seam of a cylinder, which lies opposite to what is cut.
    if (chart_.radius > 0 && std::max({a.x(), b.x(), c.x()}) - std::min({a.x(), b.x(), c.x()}) > chart_.radius) return;
    const double x0 = a.x(), y0 = a.y(), x1 = b.x() - x0, y1 = b.y() - y0, x2 = c.x() - x0, y2 = c.y() - y0;
    const double det = x1 * y2 - x2 * y1;
    if (std::abs(det) < 1e-18) return;
    const int i0 = first((std::min({a.x(), b.x(), c.x()}) - w_.u_from) / w_.du),
              i1 = last((std::max({a.x(), b.x(), c.x()}) - w_.u_from) / w_.du, nu_);
    const int j0 = first((std::min({a.y(), b.y(), c.y()}) - w_.v_from) / w_.dv),
              j1 = last((std::max({a.y(), b.y(), c.y()}) - w_.v_from) / w_.dv, nv_);
    constexpr double kHair = 1e-9;
    for (int i = i0; i <= i1; ++i)
      for (int j = j0; j <= j1; ++j) {
        const double x = u(i) - x0, y = v(j) - y0;
        const double s = (x * y2 - x2 * y) / det, t = (x1 * y - x * y1) / det;
        if (s < -kHair || t < -kHair || s + t > 1 + kHair) continue;
        lower(node(i, j), a.z() + s * (b.z() - a.z()) + t * (c.z() - a.z()), pass);
      }
  }

  /// Material between these heights and others of the same window, mm^3.
  double volume_above(const HeightMap& lower) const {
    double sum = 0;
    for (std::size_t k = 0; k < node_.size(); ++k) {
      const double a = node_[k].now, b = lower.node_[k].now;
      if (a < 0.5 * kAir) continue;
      sum += chart_.radius > 0 ? (b * b - a * a) / (2 * chart_.radius) : a - b;
    }
    return sum * w_.du * w_.dv;
  }

 private:
  struct Node {
    double now = 0, before = 0;  ///< before: as `pass` met it
    std::int32_t pass = -1;      ///< that has cut it last
  };
  static int first(double at) { return std::max(0, static_cast<int>(std::ceil(at - 1e-9))); }
  static int last(double at, int n) { return std::min(n - 1, at < 0 ? -1 : static_cast<int>(at + 1e-9)); }
  static void lower(Node& n, double height, std::int32_t pass) {
    if (height >= n.now) return;
    if (n.pass != pass) n.before = n.now, n.pass = pass;
    n.now = height;
  }
  const Node& node(int i, int j) const {
    return node_[static_cast<std::size_t>(i) * static_cast<std::size_t>(nv_) + static_cast<std::size_t>(j)];
  }
  Node& node(int i, int j) {
    return node_[static_cast<std::size_t>(i) * static_cast<std::size_t>(nv_) + static_cast<std::size_t>(j)];
  }

  Chart chart_;
  Window w_;
  int nu_ = 0, nv_ = 0;
  double highest_ = kAir;
  std::vector<Node> node_;
};

}  // namespace camber::testing
