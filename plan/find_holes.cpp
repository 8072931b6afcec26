#include "plan/faces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

namespace camber::plan {
namespace {

constexpr double kUpright = 0.01;          // largest z of a unit normal
constexpr double kSmooth = 0.766;          // cosine of 40 degrees, between facets of a round wall
constexpr std::size_t kFewestFacets = 10;  // an octagon is no circle

struct Circle {
  Vec2 centre = Vec2::Zero();
  double radius = 0;
};

/// Least squares of x^2 + y^2 + a x + b y + c (Kasa), about the mean of the points.
std::optional<Circle> fit_circle(const std::vector<Vec2>& points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p / static_cast<double>(points.size());
  double xx = 0, xy = 0, yy = 0, xr = 0, yr = 0, rr = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p - mean;
    const double r = d.x() * d.x() + d.y() * d.y();
    xx += d.x() * d.x(), xy += d.x() * d.y(), yy += d.y() * d.y();
    xr += d.x() * r, yr += d.y() * r, rr += r;
  }
  const double det = xx * yy - xy * xy;
  if (det <= 1e-9 * xx * yy || xx <= 0) return std::nullopt;
  const Vec2 half(0.5 * (xr * yy - yr * xy) / det, 0.5 * (yr * xx - xr * xy) / det);
  const double square = rr / static_cast<double>(points.size()) + half.x() * half.x() + half.y() * half.y();
  return Circle{mean + half, std::sqrt(square)};
}

/// Groups of upright triangles, joined over edges at which the wall turns little.
std::vector<std::vector<std::uint32_t>> smooth_walls(const TriangleSolid& solid, const MeshEdges& edges,
                                                     const std::vector<Vec3>& normals) {
  std::vector<std::vector<std::uint32_t>> out;
  std::vector<bool> seen(solid.triangles.size(), false);
  for (std::uint32_t first = 0; first < seen.size(); ++first) {
    if (seen[first] || !is_upright(normals[first])) continue;
    std::vector<std::uint32_t> group{first};
    seen[first] = true;
    for (std::size_t i = 0; i < group.size(); ++i)
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t next = edges.across(group[i], e);
        if (next == MeshEdges::kNone || seen[next] || !is_upright(normals[next])) continue;
        if (normals[group[i]].dot(normals[next]) < kSmooth) continue;
        seen[next] = true;
        group.push_back(next);
      }
    out.push_back(std::move(group));
  }
  return out;
}

/// Number of different directions of the facets; 0 where there is a gap of more than a sixth of a turn between them.
std::size_t directions_around(const std::vector<std::uint32_t>& group, const std::vector<Vec3>& normals) {
  std::vector<double> angles;
  for (const std::uint32_t t : group) angles.push_back(std::atan2(normals[t].y(), normals[t].x()));
  std::ranges::sort(angles);
  std::size_t count = 1;
  double gap = angles.front() + 2 * kPi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    if (angles[i] - angles[i - 1] > 1e-3) ++count;
    gap = std::max(gap, angles[i] - angles[i - 1]);
  }
  return gap < kPi / 3 ? count : 0;
}

struct Rim {
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< directed as in the wall's triangles
  std::vector<std::uint32_t> outside;               ///< triangles beyond it
  double low = 1e300, high = -1e300;
};

/// The closed loops of edges at which a wall ends; none where a loop does not close.
std::vector<Rim> rims_of(const TriangleSolid& solid, const MeshEdges& edges, const std::vector<std::uint32_t>& wall) {
  std::vector<bool> inside(solid.triangles.size(), false);
  for (const std::uint32_t t : wall) inside[t] = true;
  std::map<std::uint32_t, std::array<std::uint32_t, 2>> from;  // first corner: second corner, triangle beyond
  for (const std::uint32_t t : wall)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t beyond = edges.across(t, e);
      if (beyond == MeshEdges::kNone) return {};
      if (inside[beyond]) continue;
      if (!from.emplace(solid.triangles[t][e], std::array{solid.triangles[t][(e + 1) % 3], beyond}).second) return {};
    }
  std::vector<Rim> out;
  while (!from.empty()) {
    Rim rim;
    const std::uint32_t first = from.begin()->first;
    std::uint32_t at = first;
    do {
      const auto step = from.find(at);
      if (step == from.end()) return {};
      rim.edges.push_back({at, step->second[0]});
      rim.outside.push_back(step->second[1]);
      rim.low = std::min(rim.low, solid.points[at].z());
      rim.high = std::max(rim.high, solid.points[at].z());
      at = step->second[0];
      from.erase(step);
    } while (at != first);
    out.push_back(std::move(rim));
  }
  return out;
}

class HoleFinder {
 public:
  HoleFinder(const TriangleSolid& solid, const MeshEdges& edges, const FaceOptions& options)
      : solid_(solid), edges_(edges), options_(options) {
    out_.of_hole.assign(solid.triangles.size(), false);
    for (std::size_t t = 0; t < solid.triangles.size(); ++t) normals_.push_back(unit_normal(solid, t));
  }

  FoundHoles find() {
    for (const auto& wall : smooth_walls(solid_, edges_, normals_)) look_at(wall);
    std::ranges::sort(out_.holes, [](const Hole& a, const Hole& b) {
      return std::make_tuple(a.centre_mm.x(), a.centre_mm.y(), a.top_mm) <
             std::make_tuple(b.centre_mm.x(), b.centre_mm.y(), b.top_mm);
    });
    return std::move(out_);
  }

 private:
  std::optional<Circle> circle_of(const std::vector<std::uint32_t>& wall) const {
    if (wall.size() < 2 * kFewestFacets || directions_around(wall, normals_) < kFewestFacets) return std::nullopt;
    std::vector<std::uint32_t> corners;
    for (const std::uint32_t t : wall)
      corners.insert(corners.end(), solid_.triangles[t].begin(), solid_.triangles[t].end());
    std::ranges::sort(corners);
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    std::vector<Vec2> points;
    for (const std::uint32_t c : corners) points.emplace_back(solid_.points[c].x(), solid_.points[c].y());
    const auto circle = fit_circle(points);
    if (!circle) return std::nullopt;
    for (const Vec2& p : points)
      if (std::abs((p - circle->centre).norm() - circle->radius) > tolerance(*circle)) return std::nullopt;
    for (const std::uint32_t t : wall) {  // the material is outside
      const Vec3 middle = (solid_.corner(solid_.triangles[t], 0) + solid_.corner(solid_.triangles[t], 1) +
                           solid_.corner(solid_.triangles[t], 2)) /
                          3;
      if (normals_[t].x() * (circle->centre.x() - middle.x()) + normals_[t].y() * (circle->centre.y() - middle.y()) <=
          0)
        return std::nullopt;
    }
    return circle;
  }

  double tolerance(const Circle& c) const { return std::max(options_.circle_tolerance_mm, 1e-3 * c.radius); }

  bool within(std::uint32_t triangle, const Circle& c, double top) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p = solid_.corner(solid_.triangles[triangle], k);
      if ((Vec2(p.x(), p.y()) - c.centre).norm() > c.radius + tolerance(c) || p.z() > top + options_.plane_tolerance_mm)
        return false;
    }
    return true;
  }

  /// The triangles below a rim, all within the circle; none where one is not: the hole goes on there.
  std::vector<std::uint32_t> bottom_below(const Rim& rim, const Circle& c) const {
    std::vector<std::uint32_t> out;
    std::vector<bool> seen(solid_.triangles.size(), false);
    for (const std::uint32_t t : rim.outside)
      if (!seen[t]) seen[t] = true, out.push_back(t);
    for (std::size_t i = 0; i < out.size(); ++i) {
      // A wall within the circle is a narrower hole that goes on.
      if (!within(out[i], c, rim.high) || is_upright(normals_[out[i]])) return {};
      for (std::size_t e = 0; e < 3; ++e) {
        const std::uint32_t next = edges_.across(out[i], e);
        if (next == MeshEdges::kNone || seen[next] || is_rim(rim, out[i], e)) continue;
        seen[next] = true;
        out.push_back(next);
      }
    }
    return out;
  }

  bool is_rim(const Rim& rim, std::uint32_t triangle, std::size_t edge) const {
    const std::uint32_t a = solid_.triangles[triangle][edge], b = solid_.triangles[triangle][(edge + 1) % 3];
    return std::ranges::any_of(rim.edges, [&](const auto& r) { return r[0] == b && r[1] == a; });
  }

  /// A fan from the middle of a rim.
  std::vector<Triangle> cap(const Rim& rim, const Circle& c) {
    double z = 0;
    for (const auto& e : rim.edges) z += solid_.points[e[0]].z() / static_cast<double>(rim.edges.size());
    const auto middle = static_cast<std::uint32_t>(solid_.points.size() + out_.new_points.size());
    out_.new_points.emplace_back(c.centre.x(), c.centre.y(), z);
    std::vector<Triangle> fan;
    for (const auto& e : rim.edges) fan.push_back({e[0], e[1], middle});
    return fan;
  }

  void look_at(const std::vector<std::uint32_t>& wall) {
    const auto circle = circle_of(wall);
    if (!circle) return;
    std::vector<Rim> rims = rims_of(solid_, edges_, wall);
    if (rims.size() != 2) return;
    if (rims[0].high + rims[0].low > rims[1].high + rims[1].low) std::swap(rims[0], rims[1]);
    const Rim &lower = rims[0], &upper = rims[1];
    if (lower.high >= upper.low) return;
    Hole hole{.centre_mm = circle->centre,
              .diameter_mm = 2 * circle->radius,
              .top_mm = upper.high,
              .bottom_mm = lower.low,
              .tip_mm = lower.low,
              .volume_mm3 = 0};
    std::vector<Triangle> caps = cap(upper, *circle);
    const std::vector<std::uint32_t> bottom = bottom_below(lower, *circle);
    if (bottom.empty()) {
      const auto below = cap(lower, *circle);
      caps.insert(caps.end(), below.begin(), below.end());
    }
    for (const std::uint32_t t : bottom) {
      out_.of_hole[t] = true;
      for (std::size_t k = 0; k < 3; ++k)
        hole.tip_mm = std::min(hole.tip_mm, solid_.corner(solid_.triangles[t], k).z());
    }
    for (const std::uint32_t t : wall) out_.of_hole[t] = true;
    hole.volume_mm3 = enclosed(wall, bottom, caps);
    out_.holes.push_back(hole);
    out_.caps.insert(out_.caps.end(), caps.begin(), caps.end());
  }

  /// Caps face out of the filled solid, wall and bottom into the hole.
  double enclosed(const std::vector<std::uint32_t>& wall, const std::vector<std::uint32_t>& bottom,
                  const std::vector<Triangle>& caps) const {
    TriangleSolid plug;
    plug.points = solid_.points;
    plug.points.insert(plug.points.end(), out_.new_points.begin(), out_.new_points.end());
    plug.triangles = caps;
    for (const auto* part : {&wall, &bottom})
      for (const std::uint32_t t : *part) {
        const Triangle& of = solid_.triangles[t];
        plug.triangles.push_back({of[0], of[2], of[1]});
      }
    return plan::volume_mm3(plug);
  }

  const TriangleSolid& solid_;
  const MeshEdges& edges_;
  const FaceOptions& options_;
  std::vector<Vec3> normals_;
  FoundHoles out_;
};

}  // namespace

Vec3 unit_normal(const TriangleSolid& solid, std::size_t triangle) {
  const Vec3 n = solid.normal_by_area(solid.triangles[triangle]);
  const double length = n.norm();
  return length > 0 ? Vec3(n / length) : Vec3(Vec3::Zero());
}

bool is_upright(const Vec3& n) { return std::abs(n.z()) < kUpright && n.squaredNorm() > 0.5; }

FoundHoles find_holes(const TriangleSolid& solid, const MeshEdges& edges, const FaceOptions& options) {
  return HoleFinder(solid, edges, options).find();
}

}  // namespace camber::plan
