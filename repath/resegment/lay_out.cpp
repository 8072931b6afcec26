// New points for an old path.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "repath/compress/corners.h"
#include "repath/resegment/resegmentation.h"
#include "repath/resegment/smoothed_path.h"

namespace camber::repath {
namespace {

constexpr double kSmoothFraction = 0.5;  ///< of the tolerance; the rest is for the chords
constexpr double kCurveFraction = 0.75;  ///< of the curve between the points
constexpr double kSharp = kPi / 3;
constexpr double kShorter = 0.8;
constexpr double kBeforeCornerMm = 0.8, kBehindCornerMm = 0.4;  ///< reach of corners; see CornerFeeds
constexpr double kShortestMm = 0.05;                            ///< of what is cut off for that
constexpr char kEdge = 1, kSharpCorner = 2;
constexpr double kRounding = 0.87;  ///< increments: half a cube's diagonal

double to_segment_mm(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double t = ab.squaredNorm() > 0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

Vec3 rounded(const Vec3& p, double increment_mm) {
  return {std::round(p.x() / increment_mm) * increment_mm, std::round(p.y() / increment_mm) * increment_mm,
          std::round(p.z() / increment_mm) * increment_mm};
}

}  // namespace

/// One old segment that stays what it is, or the curve that takes the place of old points first ... last.
struct SmoothedPath::Piece {
  std::size_t first = 0, last = 0;
  std::optional<SmoothCurve> curve;
};

SmoothedPath::SmoothedPath(std::vector<Vec3> points, const ResegmentOptions& options, double increment_mm)
    : old_(std::move(points)), tolerance_(options.tolerance_mm), increment_(increment_mm) {
  assert(old_.size() >= 2 && std::ranges::adjacent_find(old_) == old_.end());
  const std::vector<bool> corners = corners_of(old_, {.min_turn_rad = options.corner_rad,
                                                      .times_beside = 3,
                                                      .always_rad = kSharp,
                                                      .leg_mm = 5 * options.tolerance_mm});
  const std::vector<double> turns = turns_of(old_, 5 * options.tolerance_mm);
  corner_at_.assign(old_.size(), 0);
  std::size_t begin = 0;
  for (std::size_t k = 1; k < old_.size(); ++k) {
    if (k + 1 < old_.size() && !corners[k]) continue;
    if (k + 1 < old_.size()) {
      ++corners_;
      corner_at_[k] = turns[k] > kSharp ? kSharpCorner : kEdge;
    }
    smooth(begin, k);
    begin = k;
  }
}

SmoothedPath::~SmoothedPath() = default;
SmoothedPath::SmoothedPath(SmoothedPath&&) noexcept = default;

/// Old points first ... last without a corner between them.
void SmoothedPath::smooth(std::size_t first, std::size_t last) {
  if (last == first + 1) return straight(first);
  SmoothCurve curve(std::span<const Vec3>(old_).subspan(first, last - first + 1),
                    std::max(0.0, kSmoothFraction * tolerance_ - kRounding * increment_));
  const std::vector<std::size_t> left = leaves(curve, first);
  if (left.empty()) {
    pieces_.push_back({first, last, std::move(curve)});
    return;
  }
  // What lies between is tried anew, with its ends held.
  std::size_t begin = first;
  for (const std::size_t k : left) {
    if (k > begin) smooth(begin, k);
    straight(k);
    begin = k + 1;
  }
  if (begin < last) smooth(begin, last);
}

void SmoothedPath::straight(std::size_t first) { pieces_.push_back({first, first + 1, std::nullopt}); }

/// The old segments from which the curve keeps farther than its fraction.
std::vector<std::size_t> SmoothedPath::leaves(const SmoothCurve& curve, std::size_t first) const {
  const auto& knots = curve.knots_mm();
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i)
    for (const double fraction : {0.25, 0.5, 0.75})
      if (to_path_mm(curve.at(knots[i] + fraction * (knots[i + 1] - knots[i])), first + i) >
          kCurveFraction * tolerance_) {
        found.push_back(first + i);
        break;
      }
  return found;
}

/// From a point to the old path near one of its segments.
double SmoothedPath::to_path_mm(const Vec3& p, std::size_t segment) const {
  double nearest = to_segment_mm(p, old_[segment], old_[segment + 1]);
  if (segment > 0) nearest = std::min(nearest, to_segment_mm(p, old_[segment - 1], old_[segment]));
  if (segment + 2 < old_.size()) nearest = std::min(nearest, to_segment_mm(p, old_[segment + 1], old_[segment + 2]));
  return nearest;
}

class SmoothedPath::Layouter {
 public:
  Layouter(const SmoothedPath& path, double length_mm, bool mark_corners)
      : path_(path),
        old_(path.old_),
        tolerance_(path.tolerance_),
        increment_(path.increment_),
        length_(length_mm),
        mark_(mark_corners) {}

  Layout run() {
    out_.corners = path_.corners_;
    out_.points = {old_.front()};
    out_.old_point = {0};
    if (mark_) out_.place = {{}};
    const auto& pieces = path_.pieces_;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (k == 0 || path_.corner_at_[pieces[k].first]) begin_stretch(k);
      if (pieces[k].curve)
        along(*pieces[k].curve, pieces[k].first, pieces[k].last);
      else
        straight(pieces[k].first);
    }
    return std::move(out_);
  }

 private:
  static double length_of(const Piece& p, const std::vector<Vec3>& old) {
    return p.curve ? p.curve->length_mm() : (old[p.last] - old[p.first]).norm();
  }

  /// Begins the stretch between two corners and notes how much of it is within their reach.
  void begin_stretch(std::size_t k) {
    if (!mark_) return;
    const auto& pieces = path_.pieces_;
    const char begin = path_.corner_at_[pieces[k].first];
    double length = length_of(pieces[k], old_);
    for (; k + 1 < pieces.size() && !path_.corner_at_[pieces[k].last]; ++k) length += length_of(pieces[k + 1], old_);
    const char end = path_.corner_at_[pieces[k].last];
    done_ = 0;
    near_until_ = begin ? kBehindCornerMm : 0;
    near_from_ = end ? length - kBeforeCornerMm : length;
    between_ = 0;
    if (near_from_ > near_until_) return;
    near_until_ = length;
    if (begin == kSharpCorner && end == kSharpCorner) between_ = length;
  }

  /// Where segments must end on a piece of the stretch, from its own begin; its end is the last.
  std::vector<double> stops(double piece_mm) const {
    std::vector<double> out;
    if (mark_)
      for (const double at : {near_until_ - done_, near_from_ - done_})
        if (at > kShortestMm && at < piece_mm - kShortestMm && (out.empty() || at > out.back() + kShortestMm))
          out.push_back(at);
    out.push_back(piece_mm);
    return out;
  }

  /// A line needs no points between its ends but at those.
  void straight(std::size_t first) {
    const Vec3 from = old_[first], to = old_[first + 1];
    const double length = (to - from).norm();
    double s = 0;
    for (const double stop : stops(length)) {
      const bool end = stop == length;
      const Vec3 p = end ? to : rounded(from + stop / length * (to - from), increment_);
      const double away = to_segment_mm(p, from, to);
      if (p == out_.points.back() || away > tolerance_) continue;
      add(p, end ? first + 1 : first, away, s, stop);
      s = stop;
    }
    done_ += length;
  }

  void along(const SmoothCurve& curve, std::size_t first, std::size_t last) {
    const auto& knots = curve.knots_mm();
    const double end = curve.length_mm();
    double s = 0;
    std::size_t at = 0;  // the old segment in which s lies, from `first`
    for (const double stop : stops(end))
      while (s < stop) {
        // Whole lengths that fill the rest, none shorter than asked for.
        double step = (stop - s) / std::max(1.0, std::floor((stop - s) / length_ + 1e-9));
        for (;;) {
          const double to = s + step > stop - 1e-9 ? stop : s + step;
          const bool whole = to == end;
          const Vec3 p = whole ? old_[last] : rounded(curve.at(to), increment_);
          std::size_t reached = at;
          while (reached + 2 < knots.size() && knots[reached + 1] <= to + 1e-9) ++reached;
          const double away = deviation(out_.points.back(), p, first + at, first + reached, whole);
          // A step within one old segment is as good as it gets.
          if (away > tolerance_ && reached > at) {
            step *= kShorter;
            continue;
          }
          if (p != out_.points.back()) add(p, whole ? last : first + reached, away, s, to);
          s = to;
          at = reached;
          break;
        }
      }
    done_ += end;
  }

  /// Distance between the new segment a b and the old path from segment `from`, where a lies, to `to`, where b does.
  /// The old path's distance to a line is greatest at a vertex; and as it runs from beside a to beside b, every point
  /// of the line is the foot of one of its points.
  double deviation(const Vec3& a, const Vec3& b, std::size_t from, std::size_t to, bool whole) const {
    double away = whole ? 0 : path_.to_path_mm(b, to);
    for (std::size_t k = from + 1; k <= to; ++k) away = std::max(away, to_segment_mm(old_[k], a, b));
    return away;
  }

  /// `from_mm`, `to_mm`: of the segment, along the piece.
  void add(const Vec3& p, std::size_t old_point, double away, double from_mm, double to_mm) {
    out_.points.push_back(p);
    out_.old_point.push_back(static_cast<std::uint32_t>(old_point));
    out_.deviation_mm = std::max(out_.deviation_mm, away);
    if (!mark_) return;
    const double middle = done_ + 0.5 * (from_mm + to_mm);
    out_.place.push_back({middle < near_until_ || middle > near_from_, between_});
  }

  const SmoothedPath& path_;
  const std::vector<Vec3>& old_;
  double tolerance_, increment_, length_;
  bool mark_;
  double done_ = 0;                        ///< of the stretch between two corners: pieces that are laid out
  double near_until_ = 0, near_from_ = 0;  ///< of it: the reach of the corners
  double between_ = 0;                     ///< as SegmentPlace
  Layout out_;
};

Layout SmoothedPath::lay_out(double length_mm, bool mark_corners) const {
  return Layouter(*this, length_mm, mark_corners).run();
}

Layout lay_out(std::span<const Vec3> points, const ResegmentOptions& options, double length_mm, double increment_mm) {
  return SmoothedPath({points.begin(), points.end()}, options, increment_mm).lay_out(length_mm);
}

}  // namespace camber::repath
