#include "plan/part_of_stock.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <tbb/parallel_for.h>

#include "copymill/outline.h"
#include "plan/stock_solid.h"

namespace camber::plan {
namespace {

using copymill::Grid;
using copymill::Outline;

constexpr double kOutline_mm = 0.005;

double signed_area_mm2(const Outline& loop) {
  double sum = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
    sum += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return sum;
}

/// Points between first and last that are needed to stay within the tolerance (Douglas and Peucker).
void keep_needed(const Outline& loop, std::size_t first, std::size_t last, std::vector<bool>& keep) {
  const Vec2 &a = loop[first], &b = loop[last % loop.size()];
  const Vec2 along = (b - a).norm() > 0 ? Vec2((b - a).normalized()) : Vec2(1, 0);
  std::size_t worst = first;
  double most = kOutline_mm;
  for (std::size_t k = first + 1; k < last; ++k) {
    const Vec2 d = loop[k] - a;
    const double off = (b - a).norm() > 0 ? std::abs(along.x() * d.y() - along.y() * d.x()) : d.norm();
    if (off > most) most = off, worst = k;
  }
  if (worst == first) return;
  keep[worst] = true;
  keep_needed(loop, first, worst, keep);
  keep_needed(loop, worst, last, keep);
}

Outline simplified(const Outline& loop) {
  // From a corner on: the point that is farthest from the first one.
  const auto far = std::ranges::max_element(loop, {}, [&](const Vec2& p) { return (p - loop[0]).squaredNorm(); });
  Outline from(far, loop.end());
  from.insert(from.end(), loop.begin(), far);
  std::vector<bool> keep(from.size(), false);
  keep[0] = true;
  keep_needed(from, 0, from.size(), keep);
  Outline out;
  for (std::size_t k = 0; k < from.size(); ++k)
    if (keep[k]) out.push_back(from[k]);
  return out;
}

/// Sides that are along an axis but for the tolerance are along it; points to whole micrometres.
Outline straightened(Outline loop) {
  constexpr double kSine = 2e-3, kShort_mm = 1;
  const std::size_t n = loop.size();
  for (std::size_t k = 0; k < n; ++k) {
    Vec2 &a = loop[k], &b = loop[(k + 1) % n];
    const Vec2 d = b - a;
    for (int axis = 0; axis < 2; ++axis)
      if (d.norm() > kShort_mm && std::abs(d[axis]) < std::min(kSine * d.norm(), 2 * kOutline_mm))
        a[axis] = b[axis] = 0.5 * (a[axis] + b[axis]);
  }
  Outline out;
  for (const Vec2& p : loop) {
    const Vec2 at(std::round(1000 * p.x()) / 1000 + 0.0, std::round(1000 * p.y()) / 1000 + 0.0);
    if (out.empty() || (at - out.back()).norm() > 5e-4) out.push_back(at);
  }
  if (out.size() > 1 && (out.front() - out.back()).norm() < 5e-4) out.pop_back();
  return out;
}

/// Sides of the blank that the outline is on, and its corners within two voxels, are the blank's.
Outline with_blank_corners(const Outline& loop, const Vec2& low, const Vec2& high, double voxel_mm) {
  const double side = 0.1 * voxel_mm, corner = 2 * voxel_mm;
  Outline out;
  for (Vec2 p : loop) {
    bool at_corner = true;
    for (int a = 0; a < 2; ++a) {
      const double end = p[a] - low[a] < high[a] - p[a] ? low[a] : high[a];
      if (std::abs(p[a] - end) < side) p[a] = end;
      at_corner = at_corner && std::abs(p[a] - end) < corner;
    }
    if (at_corner)
      for (int a = 0; a < 2; ++a) p[a] = p[a] - low[a] < high[a] - p[a] ? low[a] : high[a];
    if (out.empty() || out.back() != p) out.push_back(p);
  }
  if (out.size() > 1 && out.front() == out.back()) out.pop_back();
  return out;
}

class Slices {
 public:
  Slices(const removal::Stock& stock, const SolidBounds& blank)
      : stock_(stock),
        blank_(blank),
        probe_(stock),
        grid_(Grid::over(stock.min_mm().head<2>(), stock.max_mm().head<2>(), 2.37 * stock.voxel_mm(),
                         stock.voxel_mm())) {}

  /// Where the stock ends at a height; no shorter than a few voxels.
  std::vector<Outline> coarse(double z) const {
    std::vector<char> in(grid_.size());
    tbb::parallel_for(0, grid_.ny, [&](int j) {
      const removal::Stock::Probe probe(stock_);
      for (int i = 0; i < grid_.nx; ++i) in[grid_.index(i, j)] = inside(probe, grid_.at(i, j), z) ? 1 : 0;
    });
    const auto crossing = [&](const Vec2& a, const Vec2& b) {
      return copymill::last_inside([&](const Vec2& p) { return inside(probe_, p, z); }, a, b, 0.0005);
    };
    std::vector<Outline> out = copymill::outlines(grid_, in, crossing);
    constexpr double kSmallest = 4;  // voxels
    std::erase_if(out, [&](const Outline& loop) {
      return std::abs(signed_area_mm2(loop)) < kSmallest * stock_.voxel_mm() * stock_.voxel_mm();
    });
    return out;
  }

  Outline exact(const Outline& loop, double z) const {
    const auto in = [&](const Vec2& p) { return inside(probe_, p, z); };
    const Outline outline = copymill::refined(loop, in, 0.002, grid_.step_mm);
    return straightened(
        simplified(with_blank_corners(outline, blank_.min_mm.head<2>(), blank_.max_mm.head<2>(), stock_.voxel_mm())));
  }

 private:
  static bool inside(const removal::Stock::Probe& probe, const Vec2& p, double z) {
    return probe.distance_mm({p.x(), p.y(), z}) < 0;
  }

  const removal::Stock& stock_;
  SolidBounds blank_;
  removal::Stock::Probe probe_;
  Grid grid_;
};

struct Ring {
  Vec2 centre = Vec2::Zero();
  double radius_mm = 0;
};

/// The circle of a loop around air.
std::optional<Ring> ring_of(const Outline& loop, const FaceOptions& options, double voxel_mm) {
  const double area = -signed_area_mm2(loop);
  if (area <= 0 || loop.size() < 12) return std::nullopt;
  Ring ring{.radius_mm = std::sqrt(area / kPi)};
  double length = 0;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
    ring.centre += 0.5 * (a + b) * (b - a).norm();
    length += (b - a).norm();
  }
  ring.centre /= length;
  const double tolerance = std::max(options.circle_tolerance_mm, 0.15 * voxel_mm);
  for (const Vec2& p : loop)
    if (std::abs((p - ring.centre).norm() - ring.radius_mm) > tolerance) return std::nullopt;
  return ring;
}

/// A hole while it is followed down.
struct Chain {
  std::vector<Ring> rings;
  double top_mm = 0, bottom_mm = 0;
  /// Returns the ring of median radius: the stock is not sharp at the edges of the ends.
  Ring ring() const {
    std::vector<Ring> sorted = rings;
    std::ranges::sort(sorted, {}, &Ring::radius_mm);
    return sorted[sorted.size() / 2];
  }
};

std::vector<Chain> chains_of(const Slices& slices, const removal::Stock& stock, const FaceOptions& options) {
  std::vector<Chain> out;
  const double step = stock.voxel_mm();
  constexpr double kSame_mm = 0.03;
  for (double z = stock.max_mm().z() - 0.5 * step; z > stock.min_mm().z(); z -= step)
    for (const Outline& loop : slices.coarse(z)) {
      const auto ring = ring_of(loop, options, step);
      if (!ring) continue;
      const auto above = std::ranges::find_if(out, [&](const Chain& c) {
        return c.bottom_mm < z + 1.5 * step && (c.rings.back().centre - ring->centre).norm() < kSame_mm &&
               std::abs(c.rings.back().radius_mm - ring->radius_mm) < kSame_mm;
      });
      if (above != out.end())
        above->bottom_mm = z, above->rings.push_back(*ring);
      else
        out.push_back({{*ring}, z, z});
    }
  constexpr double kFewest = 3;  // slices
  std::erase_if(out, [&](const Chain& c) { return c.top_mm - c.bottom_mm < (kFewest - 1.5) * step; });
  return out;
}

/// Heights at which much of the stock ends, with its own.
std::vector<double> levels_of(const removal::Stock& stock, const SolidBounds& blank, const FaceOptions& options) {
  const removal::Stock::Probe probe(stock);
  const double step = stock.voxel_mm();
  const Vec3 low = stock.min_mm(), high = stock.max_mm();
  std::vector<AxisPlane> all;
  for (double x = low.x() + 0.5 * step; x < high.x(); x += step)
    for (double y = low.y() + 0.5 * step; y < high.y(); y += step)
      for (const double z : material_along_z(probe, stock, x, y)) all.push_back({z, step * step, true});
  constexpr double kShare = 1 / 300.0;
  const double least = std::max(options.min_face_mm2, kShare * (high.x() - low.x()) * (high.y() - low.y()));
  std::vector<double> out;
  const double near_end = 0.2 * step;
  for (const AxisPlane& p : joined(std::move(all), options.plane_tolerance_mm)) {
    double at = p.at_mm;
    for (const double end : {blank.min_mm.z(), blank.max_mm.z()})
      if (std::abs(at - end) < near_end) at = end;
    const double rounded = std::round(1e4 * at) / 1e4;
    if (p.area_mm2 >= least && (out.empty() || rounded > out.back())) out.push_back(rounded);
  }
  return out;
}

Hole hole_of(const Chain& c, const std::vector<double>& levels, const removal::Stock& stock) {
  const double step = stock.voxel_mm();
  const Ring ring = c.ring();
  Hole out{.centre_mm = ring.centre, .diameter_mm = 2 * ring.radius_mm};
  const auto above = std::ranges::find_if(levels, [&](double z) { return z > c.top_mm; });
  out.top_mm = above != levels.end() ? *above : c.top_mm;
  const auto near = std::ranges::find_if(levels, [&](double z) { return std::abs(z - c.bottom_mm) < step; });
  out.bottom_mm = near != levels.end() ? *near : c.bottom_mm;
  // The top of what stands under the middle: a drill's cone.
  const removal::Stock::Probe probe(stock);
  const std::vector<double> z = material_along_z(probe, stock, ring.centre.x(), ring.centre.y());
  out.tip_mm = levels.front();
  for (std::size_t k = 1; k < z.size(); k += 2)
    if (z[k] < out.bottom_mm + step) out.tip_mm = std::max(out.tip_mm, z[k]);
  out.tip_mm = std::min(out.tip_mm, out.bottom_mm);
  const double floor = kPi * ring.radius_mm * ring.radius_mm;
  out.volume_mm3 = floor * (out.top_mm - out.bottom_mm) + floor * (out.bottom_mm - out.tip_mm) / 3;
  return out;
}

using Loops = std::vector<Outline>;

/// Coordinates of long sides along an axis, in x and in y.
std::array<std::vector<double>, 2> walls_of(const Loops& loops) {
  std::array<std::vector<double>, 2> out;
  constexpr double kLong_mm = 1;
  for (const Outline& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      for (int axis = 0; axis < 2; ++axis)
        if (a[axis] == b[axis] && (b - a).norm() > kLong_mm) out[static_cast<std::size_t>(axis)].push_back(a[axis]);
    }
  return out;
}

SolidBounds bounds_of(const Outline& loop) {
  SolidBounds out;
  for (const Vec2& p : loop) out.add(Vec3(p.x(), p.y(), 0));
  return out;
}

/// Replaces loops by the nearest of others, by their bounds, where that is near enough.
void take_alike(Loops& loops, const Loops& others, double within_mm) {
  for (Outline& loop : loops) {
    const SolidBounds own = bounds_of(loop);
    const auto apart = [&](const Outline& other) {
      const SolidBounds b = bounds_of(other);
      return std::max((b.min_mm - own.min_mm).cwiseAbs().maxCoeff(), (b.max_mm - own.max_mm).cwiseAbs().maxCoeff());
    };
    const auto near = std::ranges::min_element(others, {}, apart);
    if (near != others.end() && apart(*near) < within_mm && (signed_area_mm2(*near) > 0) == (signed_area_mm2(loop) > 0))
      loop = *near;
  }
}

/// Joins holes with one middle to one, from the top of the highest to the tip of the lowest, as wide as the widest.
std::vector<Hole> as_wells(const std::vector<Hole>& holes) {
  std::vector<Hole> out;
  for (const Hole& h : holes) {
    const auto same = std::ranges::find_if(
        out, [&](const Hole& o) { return (o.centre_mm - h.centre_mm).norm() < o.diameter_mm / 2; });
    if (same == out.end()) {
      out.push_back(h);
      continue;
    }
    same->top_mm = std::max(same->top_mm, h.top_mm);
    same->tip_mm = std::min(same->tip_mm, h.tip_mm);
    same->diameter_mm = std::max(same->diameter_mm, h.diameter_mm);
  }
  return out;
}

Outline ring_of(const Hole& hole) {
  constexpr int kFacets = 72;
  Outline out;
  for (int i = 0; i < kFacets; ++i) {
    const double a = -2 * kPi * i / kFacets;
    const Vec2 p = hole.centre_mm + hole.diameter_mm / 2 * Vec2(std::cos(a), std::sin(a));
    out.emplace_back(std::round(1e3 * p.x()) / 1e3, std::round(1e3 * p.y()) / 1e3);
  }
  return out;
}

TriangleSolid drilled(const std::vector<Loops>& layers, const std::vector<double>& levels,
                      const std::vector<Hole>& holes) {
  TriangleSolid out;
  const std::vector<Hole> wells = as_wells(holes);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    std::vector<Well> here;
    for (const Hole& w : wells)
      if (w.tip_mm < levels[k + 1] && w.top_mm > levels[k]) here.push_back({ring_of(w), w.tip_mm});
    add_layer(out, layers[k], levels[k], levels[k + 1], here);
  }
  return out;
}

void put_in_line(Loops& loops, const std::array<std::vector<double>, 2>& walls, double within_mm) {
  for (Outline& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      Vec2 &a = loop[k], &b = loop[(k + 1) % loop.size()];
      for (int axis = 0; axis < 2; ++axis) {
        const std::vector<double>& all = walls[static_cast<std::size_t>(axis)];
        if (a[axis] != b[axis] || all.empty()) continue;
        const double near = *std::ranges::min_element(all, {}, [&](double at) { return std::abs(at - a[axis]); });
        if (std::abs(near - a[axis]) < within_mm) a[axis] = b[axis] = near;
      }
    }
}

}  // namespace

PartOfStock part_of(const removal::Stock& stock, const SolidBounds& blank, const FaceOptions& options) {
  PartOfStock out;
  const Slices slices(stock, blank);
  const std::vector<double> levels = levels_of(stock, blank, options);
  if (levels.size() < 2) return out;
  for (const Chain& c : chains_of(slices, stock, options)) out.holes.push_back(hole_of(c, levels, stock));
  std::ranges::sort(out.holes, {},
                    [](const Hole& h) { return std::make_tuple(h.centre_mm.x(), h.centre_mm.y(), h.top_mm); });
  const auto is_hole = [&](const Outline& loop) {
    const auto ring = ring_of(loop, options, stock.voxel_mm());
    constexpr double kMouth = 1.5;  // radii: a countersink's
    return ring && std::ranges::any_of(out.holes, [&](const Hole& h) {
             return (h.centre_mm - ring->centre).norm() < 0.05 && ring->radius_mm < kMouth * h.diameter_mm / 2;
           });
  };
  std::vector<Loops> layers(levels.size() - 1);
  std::array<std::vector<double>, 2> walls;   // of the thicker ones
  constexpr double kThin = 2, kInLine = 0.5;  // voxels
  const auto thin = [&](std::size_t k) { return levels[k + 1] - levels[k] < kThin * stock.voxel_mm(); };
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const double middle = 0.5 * (levels[k] + levels[k + 1]);
    for (const Outline& loop : slices.coarse(middle))
      if (!is_hole(loop)) layers[k].push_back(slices.exact(loop, middle));
    std::erase_if(layers[k], [](const auto& loop) { return loop.size() < 3; });
    if (thin(k)) continue;
    const auto of_layer = walls_of(layers[k]);
    for (std::size_t a = 0; a < 2; ++a) walls[a].insert(walls[a].end(), of_layer[a].begin(), of_layer[a].end());
  }
  for (std::size_t k = 0; k < layers.size(); ++k) {
    if (thin(k)) {
      // With the layer below it is machined.
      if (k + 1 < layers.size()) take_alike(layers[k], layers[k + 1], kInLine * stock.voxel_mm());
      if (k > 0) take_alike(layers[k], layers[k - 1], kInLine * stock.voxel_mm());
      put_in_line(layers[k], walls, kInLine * stock.voxel_mm());
    }
    add_layer(out.solid, layers[k], levels[k], levels[k + 1]);
  }
  out.drilled = drilled(layers, levels, out.holes);
  return out;
}

}  // namespace camber::plan
