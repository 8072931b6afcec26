#include "simulate/part_survey.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace camber::simulate {

using removal::Stock;

namespace {

double thickness_of(const Stock::Probe& probe, double voxel_mm, const Vec3& place, const Vec3& outward,
                    double longest_mm) {
  for (double way = voxel_mm; way < longest_mm;) {
    const double distance = probe.distance_mm(place - way * outward);
    if (distance > 0) return way - std::min(distance, way);
    way += std::max(-distance, voxel_mm / 4);
  }
  return longest_mm;
}

}  // namespace

double thickness_mm(const Stock& stock, const Vec3& place, const Vec3& outward, double longest_mm) {
  return thickness_of(Stock::Probe(stock), stock.voxel_mm(), place, outward, longest_mm);
}

std::optional<Thickness> thin_part(const Stock& stock, std::span<const removal::SurfacePoint> points,
                                   double longest_mm) {
  constexpr std::size_t kLooked = 2000;
  constexpr double kThin = 0.05;
  struct Found {
    double thickness_mm, area_mm2;
    std::size_t point;
  };
  std::vector<Found> found;
  double area = 0;
  const Stock::Probe probe(stock);
  const std::size_t step = std::max<std::size_t>(1, points.size() / kLooked);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const removal::SurfacePoint& p = points[i];
    found.push_back({thickness_of(probe, stock.voxel_mm(), p.place_mm, p.normal, longest_mm), p.area_mm2, i});
    area += p.area_mm2;
  }
  std::ranges::sort(found, {}, &Found::thickness_mm);
  double sum = 0;
  for (const Found& f : found) {
    sum += f.area_mm2;
    if (sum < kThin * area) continue;
    if (f.thickness_mm >= longest_mm) return std::nullopt;
    return Thickness{f.thickness_mm, points[f.point].place_mm, points[f.point].normal};
  }
  return std::nullopt;
}

std::optional<double> reach_mm(const Stock& stock, const Thickness& thin, double bottom_mm, double longest_mm) {
  const Stock::Probe probe(stock);
  const Vec3& n = thin.outward;
  const Vec3 first = (std::abs(n.z()) < 0.9 ? Vec3(n.cross(Vec3::UnitZ())) : Vec3(n.cross(Vec3::UnitX()))).normalized();
  const Vec3 second = n.cross(first);
  const Vec3 middle = thin.place_mm - thin.thin_mm / 2 * n;
  const double step = std::max(stock.voxel_mm(), thin.thin_mm / 8);
  std::optional<double> shortest;
  for (const Vec3& along : {first, Vec3(-first), second, Vec3(-second)})
    for (double way = step; way < longest_mm; way += step) {
      const Vec3 at = middle + way * along;
      const bool held = at.z() <= bottom_mm;
      if (!held && probe.distance_mm(at) > 0) break;  // an edge
      if (!held && probe.distance_mm(at + thin.thin_mm * n) > 0 && probe.distance_mm(at - thin.thin_mm * n) > 0)
        continue;
      if (!shortest || way < *shortest) shortest = way;
      break;
    }
  return shortest;
}

}  // namespace camber::simulate
