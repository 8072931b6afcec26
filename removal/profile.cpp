#include "removal/profile.h"

#include <algorithm>
#include <cmath>

namespace camber::removal {
namespace {

constexpr double kNoEnd_mm = 1e6;

/// Circles of latitude closer to the axis than this count as this large: at the tip of a cone they have no radius.
constexpr double kMinParallel_mm = 0.05;

Vec2 normal_of(double kappa) { return {std::sin(kappa), -std::cos(kappa)}; }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

void Profile::add_line(const Vec2& from, const Vec2& to) {
  Piece p;
  p.start = from;
  p.end = to;
  p.length_mm = (to - from).norm();
  p.along = (to - from) / p.length_mm;
  p.normal = {p.along.y(), -p.along.x()};
  p.normal_from_rad = p.normal_to_rad = std::atan2(p.normal.x(), -p.normal.y());
  if (!pieces_.empty()) p.from_s_mm = pieces_.back().from_s_mm + pieces_.back().length_mm;
  pieces_.push_back(p);
}

Profile::Profile(const machine::CutterParameters& parameters) {
  constexpr double kMin_mm = 1e-9;
  const machine::CornerEnds corner = machine::corner_ends(parameters);
  if (corner.bottom.x() > kMin_mm) add_line(Vec2::Zero(), corner.bottom);
  if (parameters.corner_radius_mm > 0) {
    Piece p;
    p.arc = true;
    p.start = corner.bottom;
    p.end = corner.wall;
    p.centre = {parameters.corner_centre_r_mm, parameters.corner_centre_z_mm};
    p.radius_mm = parameters.corner_radius_mm;
    p.normal_from_rad = corner.bottom_normal_rad;
    p.normal_to_rad = corner.wall_normal_rad;
    p.length_mm = p.radius_mm * (p.normal_to_rad - p.normal_from_rad);
    if (!pieces_.empty()) p.from_s_mm = pieces_.back().from_s_mm + pieces_.back().length_mm;
    pieces_.push_back(p);
  }
  Vec2 top = corner.wall;
  if (parameters.taper_rad > 0 && parameters.height_mm > top.y() + kMin_mm) {
    const double rise = parameters.height_mm - top.y();
    const Vec2 end = top + Vec2(rise * std::tan(parameters.taper_rad), rise);
    add_line(top, end);
    top = end;
  }
  add_line(top, top + Vec2(0, kNoEnd_mm));
}

Profile::Nearest Profile::nearest(const Vec2& point) const {
  double least = std::numeric_limits<double>::infinity();
  Nearest out;
  bool outside = point.y() < 0;
  const auto take = [&](const Vec2& place, const Vec2& normal) {
    const double d = (point - place).norm();
    if (d >= least) return;
    least = d;
    out.place = place;
    out.normal = normal;
  };
  for (const Piece& p : pieces_) {
    if (!p.arc) {
      const double along = (point - p.start).dot(p.along);
      outside = outside || (point - p.start).dot(p.normal) > 0;
      take(p.start + std::clamp(along, 0.0, p.length_mm) * p.along, p.normal);
      continue;
    }
    const Vec2 from_centre = point - p.centre;
    const double distance = from_centre.norm();
    const bool in_wedge = cross(normal_of(p.normal_from_rad), from_centre) >= 0 &&
                          cross(from_centre, normal_of(p.normal_to_rad)) >= 0 && distance > 0;
    if (in_wedge) {
      outside = outside || distance > p.radius_mm;
      take(p.centre + from_centre * (p.radius_mm / distance), from_centre / distance);
    } else {
      take(p.start, normal_of(p.normal_from_rad));
      take(p.end, normal_of(p.normal_to_rad));
    }
  }
  out.distance_mm = outside ? least : -least;
  if (outside && least > 0) out.normal = (point - out.place) / least;
  return out;
}

ProfilePoint Profile::at(double s) const {
  const Piece* p = &pieces_.front();
  for (const Piece& next : pieces_)
    if (s >= next.from_s_mm) p = &next;
  if (p->arc) {
    const double k = p->normal_from_rad + (s - p->from_s_mm) / p->radius_mm;
    const double r = p->centre.x() + p->radius_mm * std::sin(k);
    return {r, p->centre.y() - p->radius_mm * std::cos(k), k, 1 / p->radius_mm,
            r > 1e-9 ? std::sin(k) / r : 1 / p->radius_mm};
  }
  const Vec2 place = p->start + (s - p->from_s_mm) * p->along;
  return {place.x(), place.y(), p->normal_from_rad, 0, p->normal.x() / std::max(place.x(), kMinParallel_mm)};
}

double Profile::length_to_height_mm(double z) const {
  for (const Piece& p : pieces_) {
    if (p.end.y() <= z) continue;
    if (z <= p.start.y()) return p.from_s_mm;
    if (!p.arc) return p.from_s_mm + (z - p.start.y()) / p.along.y();
    const double k = std::acos(std::clamp((p.centre.y() - z) / p.radius_mm, -1.0, 1.0));
    return p.from_s_mm + p.radius_mm * (k - p.normal_from_rad);
  }
  return pieces_.back().from_s_mm;
}

double Profile::height_at_radius_mm(double r) const {
  for (const Piece& p : pieces_) {
    if (p.end.x() < r) continue;
    if (r <= p.start.x()) return p.start.y();
    if (!p.arc) return p.start.y() + (r - p.start.x()) * p.along.y() / p.along.x();
    const double k = std::asin(std::clamp((r - p.centre.x()) / p.radius_mm, -1.0, 1.0));
    return p.centre.y() - p.radius_mm * std::cos(k);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace camber::removal
