#pragma once
// The rounded cylinder (ball, flat, bull-nose): distance, normal and nearest point, for numbers of any kind.
#include <algorithm>
#include <cmath>
#include <type_traits>

namespace camber::removal {
namespace {  // compiled for several instruction sets

inline double select(bool condition, double yes, double no) { return condition ? yes : no; }
inline float select(bool condition, float yes, float no) { return condition ? yes : no; }

/// A cylinder whose bottom edge is rounded: `flat` is the radius of the flat bottom, `corner` that of the rounding, mm.
/// It has no top. `Number`: double, float, or an xsimd batch of floats, whose operations are found by their arguments.
///
/// Source: distance to a rounded rectangle in the meridian plane; exact outside, inside as long as the nearest point is
/// on the bottom or the wall.
template <class Number>
struct RoundedCutter {
  Number flat, corner;

  /// A place in the meridian plane.
  struct Place {
    Number outside;   ///< distance outside the flat bottom's rim
    Number below;     ///< the centre of the rounding
    Number length;    ///< from that centre, of what is outside and below
    Number distance;  ///< signed, negative inside the cutter
  };
  /// radius: from the axis; height: above the tip.
  Place place(const Number& radius, const Number& height) const {
    using std::max, std::min, std::sqrt;
    const Number zero(0), outside = radius - flat, below = corner - height;
    const Number a = max(outside, zero), b = max(below, zero), length = sqrt(a * a + b * b);
    return {outside, below, length, min(max(outside, below), zero) + length - corner};
  }
  Number distance(const Number& radius, const Number& height) const { return place(radius, height).distance; }

  /// Outward unit normal at the nearest point of the cutter: away from the axis and downwards.
  struct Normal {
    Number radial, down;
  };
  Normal normal(const Place& p) const {
    const Number zero(0), one(1);
    const auto rounded = (p.outside > zero) & (p.below > zero), wall = p.outside > p.below;
    return {select(rounded, over_length(p.outside, p), select(wall, one, zero)),
            select(rounded, over_length(p.below, p), select(wall, zero, one))};
  }

  /// Height above the tip of the nearest point of the cutter.
  Number nearest_height(const Place& p, const Number& height) const {
    using std::max;
    const Number zero(0);
    const auto rounded = (p.outside > zero) & (p.below > zero), wall = p.outside > p.below;
    return select(rounded, corner - corner * p.below / max(p.length, Number(1e-12f)),
                  select(wall, max(height, zero), zero));
  }

 private:
  /// Vectors divide once for all their components; a double rounds once.
  static Number over_length(const Number& part, const Place& p) {
    using std::max;
    const Number length = max(p.length, Number(1e-12f));
    if constexpr (std::is_same_v<Number, double>)
      return part / length;
    else
      return part * (Number(1) / length);
  }
};

/// Rank of cutters at a place, less is better: the one that goes deepest; of those that go deeper than `band` the lower
/// one, and then the one whose axis is nearer.
template <class Number>
Number covering_rank(const Number& distance, const Number& tip_z, const Number& from_axis, const Number& band) {
  using std::max;
  return max(distance, -band) + Number(1e-2f) * tip_z + Number(1e-6f) * from_axis;
}

}  // namespace
}  // namespace camber::removal
