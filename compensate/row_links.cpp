#include "compensate/row_links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace camber::compensate {
namespace {

constexpr double kSameSense = 0.9;  // cosine between the directions of two rows
constexpr double kDetour = 4;       // another row is much farther along the path than across

struct RowPlace {
  std::size_t chain = 0;
  Vec3 direction = Vec3::Zero();
  double length_mm = 0;  ///< length of path that the point represents
};

std::vector<RowPlace> places_of(const ShiftPath& path) {
  const auto& points = path.points();
  std::vector<RowPlace> out(points.size());
  for (std::size_t c = 0; c < path.chains().size(); ++c) {
    const ShiftChain& chain = path.chains()[c];
    const std::size_t end = chain.from + chain.count;
    for (std::size_t i = chain.from; i < end; ++i) {
      const auto &before = points[i > chain.from ? i - 1 : i], &after = points[i + 1 < end ? i + 1 : i];
      const Vec3 way = after.place_mm - before.place_mm;
      out[i] = {c, way.norm() > 0 ? Vec3(way.normalized()) : Vec3::Zero(), (after.along_mm - before.along_mm) / 2};
    }
  }
  return out;
}

/// Points by cubes with sides of the reach.
class Cubes {
 public:
  Cubes(const std::vector<ControlPoint>& points, double side_mm) : side_mm_(side_mm) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!points[i].fixed) cells_[cell_of(points[i].place_mm)].push_back(i);
  }

  void for_near(const Vec3& p, auto what) const {
    const Cell at = cell_of(p);
    for (long i = -1; i <= 1; ++i)
      for (long j = -1; j <= 1; ++j)
        for (long k = -1; k <= 1; ++k) {
          const auto cell = cells_.find({at[0] + i, at[1] + j, at[2] + k});
          if (cell == cells_.end()) continue;
          for (const std::size_t n : cell->second) what(n);
        }
  }

 private:
  using Cell = std::array<long, 3>;
  Cell cell_of(const Vec3& p) const {
    return {std::lround(p.x() / side_mm_), std::lround(p.y() / side_mm_), std::lround(p.z() / side_mm_)};
  }
  double side_mm_;
  std::map<Cell, std::vector<std::size_t>> cells_;
};

}  // namespace

std::vector<RowLink> row_links(const ShiftPath& path, double reach_mm, RowSense sense) {
  const auto& points = path.points();
  const std::vector<RowPlace> places = places_of(path);
  const Cubes cubes(points, reach_mm);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].fixed) continue;
    const auto across_to = [&](std::size_t j) {
      const Vec3 way = points[j].place_mm - points[i].place_mm;
      return Vec3(way - way.dot(places[i].direction) * places[i].direction);
    };
    const auto nearest = [&](const Vec3* other_side) {
      double least = reach_mm;
      std::optional<std::size_t> found;
      cubes.for_near(points[i].place_mm, [&](std::size_t j) {
        const double distance = (points[j].place_mm - points[i].place_mm).norm();
        const double along = std::abs(points[j].along_mm - points[i].along_mm);
        const double along_cosine = places[i].direction.dot(places[j].direction);
        const double wanted = sense == RowSense::any ? std::abs(along_cosine) : along_cosine;
        if (distance >= least || distance <= 0 || wanted < kSameSense) return;
        if (places[i].chain == places[j].chain && along < kDetour * distance + 2 * reach_mm) return;
        const Vec3 across = across_to(j);
        if (across.norm() < 0.5 * distance || (other_side && across.dot(*other_side) >= 0)) return;
        least = distance;
        found = j;
      });
      return found;
    };
    const auto first = nearest(nullptr);
    if (!first) continue;
    pairs.emplace_back(std::min(i, *first), std::max(i, *first));
    const Vec3 side = across_to(*first);
    if (const auto second = nearest(&side)) pairs.emplace_back(std::min(i, *second), std::max(i, *second));
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<RowLink> out;
  out.reserve(pairs.size());
  for (const auto& [a, b] : pairs)
    out.push_back(
        {a, b, (points[b].place_mm - points[a].place_mm).norm(), (places[a].length_mm + places[b].length_mm) / 2});
  return out;
}

RowTurn row_turn(const ShiftPath& path, std::span<const RowLink> links, double bound_rad) {
  RowTurn out;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const RowLink& l = links[i];
    const double turn = std::atan2((path.points()[l.b].shift_mm - path.points()[l.a].shift_mm).norm(), l.distance_mm);
    out.max_rad = std::max(out.max_rad, turn);
    if (turn > bound_rad) out.over.push_back(i);
  }
  return out;
}

}  // namespace camber::compensate
