#include "copymill/part_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <tbb/parallel_for.h>

namespace camber::copymill {
namespace {

constexpr int kAround = 16;
constexpr std::array<double, 8> kShifts_mm{0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1};
constexpr double kContact_mm = 0.003;  ///< a tool that is free but for this touches
constexpr double kUnreached_um = 20;   ///< less material counts as none where no tool could touch
constexpr double kOverhang = -0.01;    ///< faces that look down further are not looked at

struct Point {
  Vec3 place, normal;
  double area_mm2 = 0;
};

/// Adds points of a slender triangle: rows across it, from the corner between its long sides on.
void add_rows(const std::array<Vec3, 3>& corners, const Vec3& normal, double area, double step,
              std::vector<Point>& out) {
  std::size_t tip = 0;  // opposite the shortest side
  const auto side = [&](std::size_t k) { return (corners[(k + 1) % 3] - corners[(k + 2) % 3]).norm(); };
  for (std::size_t k = 1; k < 3; ++k)
    if (side(k) < side(tip)) tip = k;
  const Vec3 u = corners[(tip + 1) % 3] - corners[tip], v = corners[(tip + 2) % 3] - corners[tip];
  const int rows = std::max(1, static_cast<int>(std::ceil(std::max(u.norm(), v.norm()) / step)));
  for (int i = 0; i < rows; ++i) {
    const double at = (i + 0.5) / rows, share = (2.0 * i + 1) / rows / rows;
    const int places = std::max(1, static_cast<int>(std::ceil(at * side(tip) / step)));
    for (int j = 0; j < places; ++j) {
      const double across = (j + 0.5) / places;
      out.push_back({corners[tip] + at * ((1 - across) * u + across * v), normal, area * share / places});
    }
  }
}

std::vector<Point> points_on(const TriangleMesh& part, double step) {
  std::vector<Point> out;
  for (const auto& t : part.triangles) {
    const Vec3 a = part.points[t[0]].cast<double>(), u = part.points[t[1]].cast<double>() - a,
               v = part.points[t[2]].cast<double>() - a;
    const Vec3 across(u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(), u.x() * v.y() - u.y() * v.x());
    const double area = 0.5 * across.norm();
    if (area <= 0 || across.z() < kOverhang * across.norm()) continue;
    const double longest = std::max({u.norm(), v.norm(), (u - v).norm()});
    constexpr double kSlender = 10;  // times as long as wide
    if (longest > step && longest * longest > kSlender * 2 * area) {
      add_rows({a, Vec3(a + u), Vec3(a + v)}, across / across.norm(), area, step, out);
      continue;
    }
    const int n = std::clamp(static_cast<int>(std::ceil(longest / step)), 1, 400);
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        out.push_back({a + (i + 1.0 / 3) / n * u + (j + 1.0 / 3) / n * v, across / across.norm(), area / (n * n)});
        if (i + j + 1 < n)
          out.push_back({a + (i + 2.0 / 3) / n * u + (j + 2.0 / 3) / n * v, across / across.norm(), area / (n * n)});
      }
  }
  return out;
}

bool free_tip(const Reach& tool, const Vec3& tip) {
  return tip.z() >= tool.lowest_mm - kContact_mm && tip.z() <= tool.highest_mm + kContact_mm &&
         tool.region->contains(tip.head<2>(), tip.z()) && tool.field->free(tip.head<2>(), tip.z() + kContact_mm);
}

/// Returns whether the tool can stand so that it touches the part at a point. Under a flat bottom it may stand anywhere
/// beside.
bool touches(const Reach& tool, const Point& p) {
  const double corner = tool.shape.corner_radius_mm, flat = tool.shape.radius_mm - corner;
  const Vec2 level = p.normal.head<2>();
  const double steep = level.norm();
  const Vec3 base = p.place + corner * p.normal - Vec3(0, 0, corner);
  constexpr double kLevel = 1e-6;
  if (steep > kLevel) {
    const Vec2 out = flat / steep * level;
    const Vec3 tip = base + Vec3(out.x(), out.y(), 0);
    if (p.normal.z() > kLevel) return free_tip(tool, tip);
    // A wall is touched by the flutes above the tip too.
    return free_tip(tool, {tip.x(), tip.y(), std::min(tip.z() + corner, tool.highest_mm)});
  }
  if (free_tip(tool, base)) return true;
  for (const double share : {0.5, 0.98})
    for (int k = 0; k < kAround; ++k) {
      const double a = 2 * kPi * k / kAround;
      if (free_tip(tool, base + share * flat * Vec3(std::cos(a), std::sin(a), 0))) return true;
    }
  return false;
}

struct Found {
  double left_mm = 0;
  bool judged = false, touched = false;
};

Found look(const removal::Stock::Probe& stock, double voxel, const std::vector<Reach>& tools, const Point& p) {
  Found out;
  const double d = stock.distance_mm(p.place), above = stock.distance_mm(p.place + voxel * p.normal),
               below = stock.distance_mm(p.place - voxel * p.normal);
  constexpr double kSmooth = 0.1;  // of a voxel; at edges and near the band's end the field is not even
  const bool even = std::abs(above - d - voxel) < kSmooth * voxel && std::abs(d - below - voxel) < kSmooth * voxel;
  const bool deep = d <= -2 * voxel;
  if (!even && !deep) return out;
  out.judged = true;
  out.left_mm = -d;
  out.touched = std::ranges::any_of(tools, [&](const Reach& r) { return touches(r, p); });
  return out;
}

}  // namespace

double PathDepth::depth_at(const Vec3& tip) const {
  if (field_.free(tip.head<2>(), tip.z())) return 0;
  for (const double shift : kShifts_mm) {
    if (field_.free(tip.head<2>(), tip.z() + shift)) return shift;
    for (int k = 0; k < kAround; ++k) {
      const double a = 2 * kPi * k / kAround;
      if (field_.free(tip.head<2>() + shift * Vec2(std::cos(a), std::sin(a)), tip.z())) return shift;
    }
  }
  return kShifts_mm.back();
}

void PathDepth::add(const Vec3& tip) {
  if ((tip - last_).squaredNorm() < kStep_mm * kStep_mm) return;
  last_ = tip;
  if (const double depth = depth_at(tip); depth > max_) max_ = depth, worst_ = tip;
}

LeftMaterial left_material(const TriangleMesh& part, const removal::Stock& stock, const std::vector<Reach>& tools,
                           double step_mm) {
  const std::vector<Point> points = points_on(part, step_mm);
  std::vector<Found> found(points.size());
  constexpr std::size_t kBlock = 512;
  tbb::parallel_for(std::size_t{0}, (points.size() + kBlock - 1) / kBlock, [&](std::size_t b) {
    const removal::Stock::Probe probe(stock);
    for (std::size_t k = b * kBlock; k < std::min(points.size(), (b + 1) * kBlock); ++k)
      found[k] = look(probe, stock.voxel_mm(), tools, points[k]);
  });
  LeftMaterial out;
  std::vector<std::size_t> reached;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!found[k].judged) continue;
    if (!found[k].touched) {
      if (1000 * found[k].left_mm > kUnreached_um) out.unreached_mm2 += points[k].area_mm2;
      continue;
    }
    reached.push_back(k);
    out.reached_mm2 += points[k].area_mm2;
    out.mean_um += 1000 * found[k].left_mm * points[k].area_mm2;
    out.gouge_um = std::max(out.gouge_um, -1000 * found[k].left_mm);
    if (1000 * found[k].left_mm > out.max_um) out.max_um = 1000 * found[k].left_mm, out.worst_mm = points[k].place;
  }
  if (out.reached_mm2 <= 0) return out;
  out.mean_um /= out.reached_mm2;
  std::ranges::sort(reached, {}, [&](std::size_t k) { return found[k].left_mm; });
  double area = 0;
  for (const std::size_t k : reached) {
    area += points[k].area_mm2;
    if (area >= 0.95 * out.reached_mm2) {
      out.p95_um = 1000 * found[k].left_mm;
      break;
    }
  }
  return out;
}

}  // namespace camber::copymill
