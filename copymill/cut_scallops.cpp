// Finishing rows on the part's surface.
#include <algorithm>
#include <optional>

#include "base/stage.h"
#include "copymill/operation.h"
#include "repath/raster/raster.h"

namespace camber::copymill {
namespace {

constexpr double kFinishMaterial_mm = 0.005;

/// The parts of a chain inside the region and its heights, which are those of the surface: on a slope the tip of a
/// round cutter is lower than the place that it touches.
std::vector<Pass> clipped(const std::vector<Vec3>& chain, const Workplace& place) {
  constexpr double kBorder_mm = 1e-3;
  const auto& z = place.cut.operation.region.z_mm;
  const bool polygon = !place.cut.operation.region.polygon_mm.empty();
  std::vector<Pass> out;
  std::optional<std::uint32_t> near;
  const auto within_heights = [&](const Vec3& p) {
    const auto contact = place.field.drop().at(p.head<2>(), near);
    if (!contact) return true;
    near = contact->triangle;
    return contact->point.z() >= (*z)[0] - kBorder_mm && contact->point.z() <= (*z)[1] + kBorder_mm;
  };
  bool going = false;
  for (const Vec3& p : chain) {
    const bool in = (!polygon || place.region.contains(p.head<2>())) && (!z || within_heights(p));
    if (in && !going) out.emplace_back();
    if (in) out.back().points.push_back(p);
    going = in;
  }
  std::erase_if(out, [](const Pass& p) { return p.points.size() < 2; });
  return out;
}

double lowest_mm(const std::vector<Pass>& passes) {
  double out = passes.front().points.front().z();
  for (const Pass& pass : passes)
    for (const Vec3& p : pass.points) out = std::min(out, p.z());
  return out;
}

}  // namespace

bool cut_scallops(const Workplace& place) {
  const machine::CopyOperation& o = place.cut.operation;
  const repath::DropCutter& drop = place.field.drop();
  repath::RasterOptions options;
  options.boundary = {place.region.min_mm().cwiseMax(drop.min_mm().head<2>()),
                      place.region.max_mm().cwiseMin(drop.max_mm().head<2>())};
  if ((options.boundary.min.array() >= options.boundary.max.array()).any()) return false;
  options.direction_rad = o.angle_rad;
  options.scallop_mm = o.scallop_mm;
  options.tolerance_mm = 0.004;
  const repath::Raster raster = repath::make_raster(drop, options);
  std::vector<Pass> passes;
  for (const auto& chain : raster.chains) {
    std::vector<Vec3> points = repath::points_of(drop, chain, options);
    for (Vec3& p : points) p.z() += place.field.allowance_mm();
    for (Pass& pass : clipped(points, place)) passes.push_back(std::move(pass));
  }
  if (passes.empty()) return false;
  place.runner.begin(place.cut, place.standing, place.safe_z_mm, &place.depth, lowest_mm(passes));
  Approach approach(place.cut, place.field, place.standing, place.runner, {.more_than_mm = kFinishMaterial_mm});
  Stage stage("finishing by rows", passes.size());
  for (const Pass& pass : passes) {
    // Rows have no other depth: after a change what is left of the pass goes on with the feed that is now.
    while (approach.follow(pass) == Runner::Ended::replan) place.runner.replanned();
    if (place.runner.stopped()) return true;
    stage.advance();
  }
  return true;
}

}  // namespace camber::copymill
