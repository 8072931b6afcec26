#include "checks/tool_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::checks {
namespace {

constexpr double kPatch_mm = 3;

}  // namespace

ToolSurface::ToolSurface(std::span<const OutlineRing> rings, double step_mm) {
  constexpr double kRounding_mm = 1e-9;
  bottom_mm_ = shank_from_mm_ = std::numeric_limits<double>::infinity();
  for (std::size_t from = 0, i = 0; i < rings.size(); ++i) {
    const OutlineRing &first = rings[from], &ring = rings[i];
    radius_mm_ = std::max(radius_mm_, ring.radius_mm);
    bottom_mm_ = std::min(bottom_mm_, ring.height_mm);
    top_mm_ = std::max(top_mm_, ring.height_mm);
    if (ring.part != OutlineRing::Part::cutter) shank_from_mm_ = std::min(shank_from_mm_, ring.height_mm);
    if (i > 0 && ring.radius_mm < rings[i - 1].radius_mm - kRounding_mm) widens_upwards_ = false;
    const bool last = i + 1 == rings.size() || rings[i + 1].part != ring.part;
    if (!last && std::hypot(ring.radius_mm - first.radius_mm, ring.height_mm - first.height_mm) < kPatch_mm) continue;
    add_band(rings.subspan(from, i + 1 - from), step_mm);
    from = i + 1;
  }
}

void ToolSurface::add_band(std::span<const OutlineRing> band, double step_mm) {
  double radius = 0;
  for (const OutlineRing& ring : band) radius = std::max(radius, ring.radius_mm);
  const auto sectors = static_cast<std::size_t>(std::max(1.0, std::ceil(2 * kPi * radius / kPatch_mm)));
  std::vector<std::vector<Vec3>> of_sector(sectors);
  for (const OutlineRing& ring : band) {
    const auto n = static_cast<std::size_t>(std::max(1.0, std::ceil(2 * kPi * ring.radius_mm / step_mm)));
    for (std::size_t i = 0; i < n; ++i) {
      const double phi = 2 * kPi * static_cast<double>(i) / static_cast<double>(n);
      of_sector[i * sectors / n].emplace_back(ring.radius_mm * std::cos(phi), ring.radius_mm * std::sin(phi),
                                              ring.height_mm);
    }
  }
  for (const auto& points : of_sector) {
    if (points.empty()) continue;
    Vec3 lo = points.front(), hi = lo;
    for (const Vec3& p : points) lo = lo.cwiseMin(p), hi = hi.cwiseMax(p);
    Patch patch{band.front().part, (lo + hi) / 2, 0, points_.size(), points.size()};
    for (const Vec3& p : points) patch.radius_mm = std::max(patch.radius_mm, (p - patch.centre_mm).norm());
    patches_.push_back(patch);
    points_.insert(points_.end(), points.begin(), points.end());
  }
}

/// The displacement of a rigid motion is a convex function of the place: it is greatest at a corner of a box.
double ToolSurface::displacement_mm(const ToolPose& from, const ToolPose& to) const {
  const Vec3 way = to.tip_mm - from.tip_mm;
  if (from.axis == to.axis) return way.norm();
  const Mat3 change = outline_frame(to) - outline_frame(from);
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? radius_mm_ : -radius_mm_, corner & 2 ? radius_mm_ : -radius_mm_,
                 corner & 4 ? top_mm_ : bottom_mm_);
    most = std::max(most, (way + change * p).squaredNorm());
  }
  return std::sqrt(most);
}

bool ToolSurface::may_touch(const ToolPose& pose, bool with_cutter, const Vec3& min_mm, const Vec3& max_mm,
                            double margin_mm) const {
  const double from = with_cutter ? bottom_mm_ : shank_from_mm_;
  if (from > top_mm_) return false;
  const int n = std::max(1, static_cast<int>(std::ceil((top_mm_ - from) / std::max(radius_mm_, 1.0))));
  const double half = (top_mm_ - from) / n / 2;
  for (int i = 0; i < n; ++i) {
    const Vec3 p = pose.tip_mm + (from + (2 * i + 1) * half) * pose.axis;
    if ((p - p.cwiseMax(min_mm).cwiseMin(max_mm)).norm() < radius_mm_ + half + margin_mm) return true;
  }
  return false;
}

Mat3 outline_frame(const ToolPose& pose) { return tool_frame({pose.tip_mm, pose.axis, 0}); }

std::vector<ToolPose> poses_between(const ToolSurface& tool, const ToolPose& from, const ToolPose& to, double step_mm) {
  const int n = std::max(1, static_cast<int>(std::ceil(tool.displacement_mm(from, to) / step_mm)));
  std::vector<ToolPose> out;
  for (int i = 1; i < n; ++i) {
    const double u = static_cast<double>(i) / n;
    out.push_back({from.tip_mm + u * (to.tip_mm - from.tip_mm), (from.axis + u * (to.axis - from.axis)).normalized()});
  }
  out.push_back(to);
  return out;
}

SurfaceFeeler::SurfaceFeeler(const ToolSurface& tool, const removal::Stock& stock, MaterialDistance& material)
    : tool_(tool), stock_(stock), material_(material), clear_until_mm_(tool.patches().size(), 0) {}

bool SurfaceFeeler::in_material(const removal::Stock::Probe& probe, const Vec3& p) const {
  const double allowed = stock_.voxel_mm(), blur = 0.87 * stock_.voxel_mm();
  const double deep = std::min(allowed + 0.5 * stock_.voxel_mm(), 0.9 * stock_.band_mm());
  return probe.nearest(p) <= -deep + blur && probe.distance_mm(p) <= -allowed;
}

std::optional<SurfaceFeeler::Touch> SurfaceFeeler::touch(const removal::Stock::Probe& probe, const ToolPose& pose,
                                                         bool with_cutter,
                                                         const std::function<bool(const Vec3&)>& counts) {
  if (last_) moved_mm_ += tool_.displacement_mm(*last_, pose);
  last_ = pose;
  const Mat3 frame = outline_frame(pose);
  for (std::size_t i = 0; i < tool_.patches().size(); ++i) {
    const ToolSurface::Patch& patch = tool_.patches()[i];
    if ((!with_cutter && patch.part == OutlineRing::Part::cutter) || clear_until_mm_[i] > moved_mm_) continue;
    const double clear = material_.at_least_mm(pose.tip_mm + frame * patch.centre_mm) - patch.radius_mm;
    if (clear > 0) {
      clear_until_mm_[i] = moved_mm_ + clear;
      continue;
    }
    material_.count_readings(patch.count);
    for (const Vec3& point : tool_.points(patch)) {
      const Vec3 p = pose.tip_mm + frame * point;
      if (in_material(probe, p) && (!counts || counts(p))) return Touch{patch.part, p};
    }
  }
  return std::nullopt;
}

}  // namespace camber::checks
