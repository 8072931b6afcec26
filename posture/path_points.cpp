#include "posture/path_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "removal/cutter.h"
#include "repath/raster/drop_cutter.h"

namespace camber::posture {
namespace {

constexpr double kRapidSteps = 5;
constexpr double kOnAxis = 1e-9;

class Points {
 public:
  Points(const nc::Interpretation& moves, const machine::Tool& tool, const TriangleMesh& part, double step_mm)
      : moves_(moves),
        drop_(part, removal::shape_of(tool)),
        radius_mm_(tool.diameter_mm / 2),
        corner_mm_(tool.type == machine::ToolType::ball ? radius_mm_ : tool.corner_radius_mm),
        step_mm_(step_mm) {}

  void add(std::size_t move) {
    const nc::Move& m = moves_.moves[move];
    if (m.kind == nc::MoveKind::dwell) return;
    const bool rapid = m.kind == nc::MoveKind::rapid;
    const double length = nc::length_mm(moves_, m), step = step_mm_ * (rapid ? kRapidSteps : 1);
    const int count = std::max(1, static_cast<int>(std::ceil(length / step)));
    for (int i = 1; i <= count; ++i) {
      PathPoint p = point_at(nc::point_at(moves_, m, static_cast<double>(i) / count), rapid);
      p.move = static_cast<std::uint32_t>(move);
      p.to = i == count ? 1 : static_cast<double>(i) / count;
      p.rapid = rapid;
      p.way_mm = length / count;
      p.time_s = rapid || m.feed_mm_per_s <= 0 ? 0 : length / count / m.feed_mm_per_s;
      out_.push_back(p);
    }
  }

  std::vector<PathPoint> take() { return std::move(out_); }

 private:
  PathPoint point_at(const Vec3& tip_mm, bool rapid) {
    PathPoint p;
    p.corner_mm = corner_mm_;
    p.centre_mm = tip_mm + corner_mm_ * Vec3::UnitZ();
    const auto contact = rapid ? std::nullopt : drop_.at(tip_mm.head<2>(), near_);
    if (!contact) return p;
    near_ = contact->triangle;
    if (tip_mm.z() - contact->tip_mm > kContactMm) return p;
    p.contact = true;
    p.flat_mm = radius_mm_ - corner_mm_;
    const Vec3 on_axis(tip_mm.x(), tip_mm.y(), contact->tip_mm + corner_mm_);
    Vec3 out = contact->point - on_axis;
    out.z() = 0;
    if (p.flat_mm == 0)
      p.normal = (on_axis - contact->point).normalized();
    else if (out.norm() > p.flat_mm)
      p.normal = (on_axis + p.flat_mm * out.normalized() - contact->point).normalized();
    p.centre_mm = contact->point + corner_mm_ * p.normal + (tip_mm.z() - contact->tip_mm) * Vec3::UnitZ();
    return p;
  }

  const nc::Interpretation& moves_;
  repath::DropCutter drop_;
  double radius_mm_, corner_mm_, step_mm_;
  std::optional<std::uint32_t> near_;
  std::vector<PathPoint> out_;
};

}  // namespace

Vec3 PathPoint::tip_mm(const Vec3& axis) const {
  if (flat_mm == 0) return centre_mm - corner_mm * axis;
  const Vec3 across = normal - normal.dot(axis) * axis;
  const double length = across.norm();
  if (length < kOnAxis) return centre_mm - corner_mm * axis;  // flat on the surface
  return centre_mm + flat_mm / length * across - corner_mm * axis;
}

std::vector<PathPoint> path_points(const nc::Interpretation& moves, std::size_t first, std::size_t end,
                                   const machine::Tool& tool, const TriangleMesh& part, double step_mm) {
  Points points(moves, tool, part, step_mm);
  for (std::size_t i = first; i < end; ++i) points.add(i);
  return points.take();
}

}  // namespace camber::posture
