#include "removal/form_error/tilted_stamps.h"

#include <limits>

#include "removal/form_error/deflected_envelope.h"

namespace camber::removal {
namespace {

constexpr double kRounding_mm = 3e-4;  ///< rounding of distances in single precision
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

}  // namespace

TiltedStamps::TiltedStamps(const EnvelopeGrid& envelope, std::span<const Stamp> stamps,
                           const DeflectionTable& deflections, const std::vector<StampDeflection>& bounds,
                           std::int32_t first_id)
    : envelope_(envelope), stamps_(stamps), deflections_(deflections), bounds_(bounds), first_id_(first_id) {
  frames_.reserve(stamps.size());
  for (const Stamp& s : stamps) frames_.emplace_back(s.pose);
}

/// The distance to a cutter changes by no more than the cutter moves there: what is far from one stamp is far from the
/// next ones.
void TiltedStamps::find_near(const Vec3& place_mm, double reach_mm, std::vector<std::size_t>& out) const {
  out.clear();
  double known = 0;  // no stamp is nearer than this before the cutter has moved
  for (std::size_t k = 0; k < stamps_.size(); ++k) {
    if (k > 0) {
      const ToolPose &a = stamps_[k - 1].pose, &b = stamps_[k].pose;
      known -= (b.tip_mm - a.tip_mm).norm() + kPi / 2 * (b.axis - a.axis).norm() * (place_mm - b.tip_mm).norm();
      known -= kRounding_mm;
    }
    const double wanted = reach_mm + bounds_[k].largest_mm + kRounding_mm;
    if (k > 0 && known > wanted) continue;
    known = straight_distance_mm(k, place_mm);
    if (known <= wanted) out.push_back(k);
  }
}

void TiltedStamps::keep_near(const Vec3& place_mm, double reach_mm, std::vector<std::size_t>& list) const {
  std::erase_if(list, [&](std::size_t k) {
    return straight_distance_mm(k, place_mm) > reach_mm + bounds_[k].largest_mm + kRounding_mm;
  });
}

TiltedMarks::TiltedMarks(const TiltedStamps& stamps)
    : stamps_(stamps), queue_(stamps.envelope(), stamps.deflections()) {}

/// The stamp that goes deepest where it is straight comes first: most others are then too high to look at.
void TiltedMarks::mark(std::span<SurfacePoint> points, std::span<const std::size_t> near) {
  first_.assign(points.size(), kNone);
  for (std::size_t i = 0; i < points.size(); ++i) {
    SurfacePoint& p = points[i];
    double deepest = std::numeric_limits<double>::infinity();
    for (const std::size_t k : near)
      if (const double d = stamps_.straight_distance_mm(k, p.place_mm + p.error_mm * p.normal); d < deepest)
        deepest = d, first_[i] = k;
    if (deepest <= stamps_.deflection(first_[i]).largest_mm + kRounding_mm) lower(p, i, first_[i]);
  }
  settle(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    SurfacePoint& p = points[i];
    const Vec3 place = p.place_mm + p.error_mm * p.normal;
    for (const std::size_t k : near)
      if (k != first_[i] && stamps_.straight_distance_mm(k, place) <= stamps_.deflection(k).largest_mm + kRounding_mm)
        lower(p, i, k);
  }
  settle(points);
}

void TiltedMarks::lower(SurfacePoint& p, std::size_t point_number, std::size_t k) {
  const StampDeflection& deflection = stamps_.deflection(k);
  const ToolPose& pose = stamps_.pose(k);
  if ((p.place_mm - pose.tip_mm).dot(pose.axis) > stamps_.deflections().edges_end_mm) return;
  if (!stamps_.envelope().shape.general) {
    const tilted::StampFrame& frame = stamps_.frame(k);
    queue_.add({point_number, k}, frame.in_tool(p.place_mm).cast<float>(),
               (frame.to_part.transpose() * p.normal).cast<float>(), p.error_mm, deflection);
    return;
  }
  const DeflectedEnvelope envelope(stamps_.envelope(), stamps_.deflections(), deflection, stamps_.pose(k));
  const double h = envelope.height_mm(p.place_mm, p.normal, p.error_mm);
  if (h >= p.error_mm) return;
  p.error_mm = h;
  p.machined_stamp = stamps_.id(k);
}

void TiltedMarks::settle(std::span<SurfacePoint> points) {
  queue_.settle([&](const MarkQueue::Pair& pair, double height_mm) {
    SurfacePoint& p = points[pair.point];
    if (height_mm >= p.error_mm) return;
    p.error_mm = height_mm;
    p.machined_stamp = stamps_.id(pair.stamp);
  });
}

}  // namespace camber::removal
