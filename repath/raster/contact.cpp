#include "repath/raster/drop_cutter.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/Geometry>

namespace camber::repath {
namespace {

constexpr double kUpright = 1e-12;  ///< mm seen from above, or of a unit normal: as good as nothing

/// The root of slope r cos t - l sin t over the rounding, with t = t0 + u^2: l grows like the square root of t - t0
/// where the line passes outside the disc, and in u nothing is steep. Illinois method.
double place_on_corner(const Underside& cutter, double distance, double slope) {
  const double begin = std::asin(std::clamp((distance - cutter.flat_mm) / cutter.corner_mm, 0.0, 1.0));
  const auto place = [&](double u) {
    const double t = begin + u * u, r = cutter.flat_mm + cutter.corner_mm * std::sin(t);
    return std::pair{t, std::sqrt(std::max(0.0, (r - distance) * (r + distance)))};
  };
  const auto pull = [&](double u) {
    const auto [t, l] = place(u);
    return slope * (cutter.flat_mm + cutter.corner_mm * std::sin(t)) * std::cos(t) - l * std::sin(t);
  };
  double low = 0, high = std::sqrt(std::max(0.0, kPi / 2 - begin));
  double at_low = pull(low), at_high = pull(high);
  constexpr int kMax = 100;
  constexpr double kEnough = 1e-13;
  int side = 0;
  for (int i = 0; i < kMax && high - low > kEnough && at_low > 0 && at_high < 0; ++i) {
    const double u = (low * at_high - high * at_low) / (at_high - at_low), now = pull(u);
    if (now > 0) {
      if (side == 1) at_high /= 2;
      low = u, at_low = now, side = 1;
    } else if (now < 0) {
      if (side == -1) at_low /= 2;
      high = u, at_high = now, side = -1;
    } else {
      return place(u).second;
    }
  }
  return place(at_low > 0 ? 0.5 * (low + high) : low).second;
}

struct Best {
  std::optional<DropContact> contact;
  void offer(double tip_mm, const Vec3& point, ContactKind kind) {
    if (!contact || tip_mm > contact->tip_mm) contact = DropContact{tip_mm, point, kind, 0};
  }
};

void vertex(const Underside& cutter, const Vec3& p, const Vec2& axis, Best& best) {
  const double r = (p.head<2>() - axis).norm();
  if (r < cutter.radius_mm()) best.offer(p.z() - cutter.height_mm(r), p, ContactKind::vertex);
}

void edge(const Underside& cutter, const Vec3& from, const Vec3& to, const Vec2& axis, Best& best) {
  const bool up = to.z() >= from.z();
  const Vec3 &a = up ? from : to, &b = up ? to : from;
  const Vec2 ab = b.head<2>() - a.head<2>();
  const double length = ab.norm();
  if (length < kUpright) return vertex(cutter, b, axis, best);
  const Vec2 along = ab / length, from_axis = a.head<2>() - axis;
  const double begin = from_axis.dot(along), end = begin + length;
  const double distance = std::abs(along.x() * from_axis.y() - along.y() * from_axis.x());
  const double slope = (b.z() - a.z()) / length;
  const auto place = place_on_line(cutter, distance, slope);
  if (!place) return;
  // An end of the edge that lies on the rim counts where the edge leads inside from it.
  const double half_chord = std::sqrt((cutter.radius_mm() - distance) * (cutter.radius_mm() + distance));
  if (begin >= half_chord || end <= -half_chord) return;
  const double at = std::clamp(*place, begin, end);
  const double r = std::min(std::hypot(distance, at), cutter.radius_mm());
  const Vec3 point = at == begin ? a : at == end ? b : Vec3(a + (at - begin) / length * (b - a));
  best.offer(point.z() - cutter.height_mm(r), point, at == *place ? ContactKind::edge : ContactKind::vertex);
}

bool inside(const Facet& f, const Vec2& p) {
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 a = f.corner[k].head<2>(), b = f.corner[(k + 1) % 3].head<2>();
    const double side = (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

void facet(const Underside& cutter, const Facet& f, const Vec2& axis, Best& best) {
  const double cosine = f.normal.z(), sine = f.normal.head<2>().norm();
  if (cosine < kUpright) return;
  // Uphill of the axis, where the underside is as steep as the facet. A level one bears the disc's middle.
  const double r = sine < kUpright ? 0.0 : cutter.flat_mm + cutter.corner_mm * sine;
  const Vec2 uphill = sine < kUpright ? Vec2(0, 0) : Vec2(-f.normal.head<2>() / sine);
  const Vec2 at = axis + r * uphill;
  if (!inside(f, at)) return;
  const double z = f.corner[0].z() - f.normal.head<2>().dot(at - f.corner[0].head<2>()) / cosine;
  best.offer(z - cutter.corner_mm * (1 - cosine), {at.x(), at.y(), z}, ContactKind::facet);
}

}  // namespace

double Underside::height_mm(double from_axis_mm) const {
  if (from_axis_mm <= flat_mm) return 0;
  const double out = from_axis_mm - flat_mm;
  return corner_mm - std::sqrt(std::max(0.0, (corner_mm - out) * (corner_mm + out)));
}

Underside underside_of(const removal::CutterShape& shape) {
  assert(!shape.general);
  const double corner = std::min(shape.corner_radius_mm, shape.radius_mm);
  return {shape.radius_mm - corner, corner};
}

std::optional<double> place_on_line(const Underside& cutter, double distance_mm, double slope) {
  const double radius = cutter.radius_mm();
  if (!(distance_mm < radius)) return std::nullopt;
  if (slope == 0) return 0.0;
  const double half_chord = std::sqrt((radius - distance_mm) * (radius + distance_mm));
  if (cutter.corner_mm == 0) return half_chord;
  if (cutter.flat_mm == 0) return half_chord * slope / std::sqrt(1 + slope * slope);
  return place_on_corner(cutter, distance_mm, slope);
}

std::optional<double> rise_on_line(const Underside& cutter, double distance_mm, double slope) {
  const auto place = place_on_line(cutter, std::abs(distance_mm), std::abs(slope));
  if (!place) return std::nullopt;
  const double r = std::min(std::hypot(distance_mm, *place), cutter.radius_mm());
  return std::abs(slope) * *place - cutter.height_mm(r);
}

Facet::Facet(const Vec3& a, const Vec3& b, const Vec3& c) : corner{a, b, c}, normal((b - a).cross(c - a)) {
  const double area = normal.norm();
  normal = area > 0 ? Vec3(normal / (normal.z() < 0 ? -area : area)) : Vec3(Vec3::Zero());
}

std::optional<DropContact> contact_with(const Underside& cutter, const Facet& f, const Vec2& axis) {
  Best best;
  facet(cutter, f, axis, best);
  // A facet's contact inside is the greatest there is.
  if (!best.contact)
    for (std::size_t k = 0; k < 3; ++k) edge(cutter, f.corner[k], f.corner[(k + 1) % 3], axis, best);
  return best.contact;
}

}  // namespace camber::repath
