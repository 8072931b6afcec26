#include "repath/raster/raster.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

constexpr double kLongestBaseMm = 1;
constexpr double kFlatBaseMm = 0.1;

double to_chord_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - a - t * ab).norm();
}

class PathMaker {
 public:
  PathMaker(const DropCutter& part, const OffsetPathOptions& options)
      : part_(part), options_(options), longest_(longest_chord_mm(part.cutter(), options.chord_mm)) {}

  std::vector<OffsetPoint> run(const Vec2& from, const Vec2& to) {
    const double length = (to - from).norm();
    const double step = options_.step_mm > 0 ? options_.step_mm : longest_;
    const int n = std::max(1, static_cast<int>(std::ceil(length / step - 1e-9)));
    auto last = place(from);
    if (!last) return {};
    out_.push_back(*last);
    for (int k = 1; k <= n; ++k) {
      const auto next = place(k == n ? to : Vec2(from + static_cast<double>(k) / n * (to - from)));
      if (!next) return {};
      if (options_.step_mm > 0)
        out_.push_back(*next);
      else if (!between(*last, *next))
        return {};
      last = next;
    }
    return std::move(out_);
  }

 private:
  std::optional<OffsetPoint> place(const Vec2& at) {
    const auto contact = part_.at(at, near_);
    if (!contact) return std::nullopt;
    near_ = contact->triangle;
    return OffsetPoint{{at.x(), at.y(), contact->tip_mm}, *contact};
  }

  /// Adds what is needed between two points, and the second one.
  bool between(const OffsetPoint& a, const OffsetPoint& b) {
    if ((b.tip - a.tip).head<2>().norm() > 0.5 * options_.increment_mm) {
      const auto middle = place(0.5 * (a.tip + b.tip).head<2>());
      if (!middle) return false;
      const bool too_long = part_.cutter().corner_mm > 0 && (b.tip - a.tip).norm() > 1.001 * longest_;
      if (too_long || to_chord_mm(middle->tip, a.tip, b.tip) > options_.chord_mm)
        return between(a, *middle) && between(*middle, b);
    }
    out_.push_back(b);
    return true;
  }

  const DropCutter& part_;
  const OffsetPathOptions& options_;
  double longest_;
  std::optional<std::uint32_t> near_;
  std::vector<OffsetPoint> out_;
};

}  // namespace

double longest_chord_mm(const Underside& cutter, double chord_mm) {
  const double round = cutter.corner_mm > 0 ? cutter.corner_mm : cutter.radius_mm();
  const double most = cutter.corner_mm > 0 ? kLongestBaseMm : kFlatBaseMm;
  return std::min({std::sqrt(8 * round * chord_mm), 0.25 * cutter.radius_mm(), most});
}

std::vector<OffsetPoint> offset_path(const DropCutter& part, const Vec2& from, const Vec2& to,
                                     const OffsetPathOptions& options) {
  return PathMaker(part, options).run(from, to);
}

}  // namespace camber::repath
