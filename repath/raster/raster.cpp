#include "repath/raster/raster.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

constexpr double kChordFraction = 0.15;  ///< of the tolerance
constexpr double kRounding = 0.87;       ///< increments: half a cube's diagonal
constexpr double kSampleMm = 0.5;        ///< along the rows, for the scallops
constexpr double kShortestRowMm = 0.05;
constexpr double kBeyond = 0.1;  ///< radii

struct Interval {
  double from, to;
};

class RasterMaker {
 public:
  RasterMaker(const DropCutter& part, const RasterOptions& options)
      : part_(part),
        options_(options),
        frame_{{std::cos(options.direction_rad), std::sin(options.direction_rad)},
               {-std::sin(options.direction_rad), std::cos(options.direction_rad)}},
        sampler_(part, frame_, options.boundary,
                 part.cutter().flat_mm > 0 ? std::min(kSampleMm / 3, 0.05 * part.cutter().radius_mm())
                                           : std::min(kSampleMm, 0.25 * part.cutter().radius_mm())) {}

  Raster run() {
    out_.spacing = space_rows(sampler_, part_.cutter(), options_.scallop_mm, options_.increment_mm, options_.progress);
    bool back = false;
    for (const double v : out_.spacing.rows_mm) {
      std::vector<Interval> pieces = pieces_of(v);
      if (back) std::reverse(pieces.begin(), pieces.end());
      for (const Interval& p : pieces)
        add(frame_.place(back ? p.to : p.from, v), frame_.place(back ? p.from : p.to, v));
      back = !back;
    }
    return std::move(out_);
  }

 private:
  bool inside(double u, double v, bool* nothing_there = nullptr) {
    const Vec2 at = frame_.place(u, v);
    const auto contact = part_.at(at, near_);
    if (nothing_there) *nothing_there = !contact;
    if (!contact) return false;
    near_ = contact->triangle;
    return works_inside(part_.cutter(), options_.boundary, at, *contact);
  }

  /// Between a place inside and one outside: the last one inside.
  double border(double in, double out, double v) {
    while (std::abs(in - out) > 0.5 * options_.increment_mm) {
      const double middle = 0.5 * (in + out);
      (inside(middle, v) ? in : out) = middle;
    }
    return in;
  }

  /// Where a row ends that runs on over the border as long as it touches nothing outside: what lies at the border
  /// between the contacts of two rows is cut from there.
  double beyond(double end, int direction, double v) const {
    for (const double fraction : {1.0, 0.5, 0.25}) {
      const double u = end + direction * fraction * kBeyond * part_.cutter().radius_mm();
      const auto contact = part_.at(frame_.place(u, v), near_);
      if (contact && touches(options_.boundary, *contact)) return u;
    }
    return end;
  }

  std::vector<Interval> pieces_of(double v) {
    const double radius = part_.cutter().radius_mm(), begin = sampler_.u_min_mm() - radius;
    const double width = sampler_.u_max_mm() - sampler_.u_min_mm() + 2 * radius;
    const double step = longest_chord_mm(part_.cutter(), kChordFraction * options_.tolerance_mm);
    const int n = static_cast<int>(std::ceil(width / step));
    std::vector<Interval> out;
    bool was = false, gap_in_air = false;
    for (int k = 0; k <= n; ++k) {
      const double u = begin + width * k / n, before = begin + width * (k - 1) / n;
      bool nothing = false;
      const bool now = inside(u, v, &nothing);
      gap_in_air |= nothing;
      if (now && !was) {
        const double from = k > 0 ? border(u, before, v) : u;
        if (!out.empty() && !gap_in_air && from - out.back().to < 2 * radius)
          out.back().to = u;
        else
          out.push_back({from, u});
      } else if (now) {
        out.back().to = u;
      } else if (was) {
        out.back().to = border(before, u, v);
      }
      if (now) gap_in_air = false;
      was = now;
    }
    std::erase_if(out, [](const Interval& i) { return i.to - i.from < kShortestRowMm; });
    for (Interval& i : out) i = {beyond(i.from, -1, v), beyond(i.to, 1, v)};
    return out;
  }

  void add(const Vec2& from, const Vec2& to) {
    ++out_.pieces;
    if (!out_.chains.empty() && along_the_surface(out_.chains.back().back().to, from)) {
      out_.chains.back().push_back({out_.chains.back().back().to, from, true});
      ++out_.links;
    } else {
      out_.chains.emplace_back();
    }
    out_.chains.back().push_back({from, to, false});
  }

  bool along_the_surface(const Vec2& from, const Vec2& to) const {
    const double radius = part_.cutter().radius_mm();
    if ((to - from).norm() > 2 * radius) return false;
    const auto path = offset_path(
        part_, from, to, {.chord_mm = kChordFraction * options_.tolerance_mm, .increment_mm = options_.increment_mm});
    if (path.empty()) return false;
    const double lower_end = std::min(path.front().tip.z(), path.back().tip.z());
    return std::all_of(path.begin(), path.end(), [&](const OffsetPoint& p) { return p.tip.z() > lower_end - radius; });
  }

  const DropCutter& part_;
  const RasterOptions& options_;
  RowFrame frame_;
  RowSampler sampler_;
  std::optional<std::uint32_t> near_;
  Raster out_;
};

}  // namespace

Raster make_raster(const DropCutter& part, const RasterOptions& options) { return RasterMaker(part, options).run(); }

std::vector<Vec3> points_of(const DropCutter& part, const std::vector<Leg>& chain, const RasterOptions& options,
                            double step_mm) {
  std::vector<Vec3> out;
  for (const Leg& leg : chain)
    for (const OffsetPoint& p : offset_path(part, leg.from, leg.to,
                                            {.chord_mm = kChordFraction * options.tolerance_mm,
                                            .increment_mm = options.increment_mm,
                                            .step_mm = step_mm})) {
      const Vec3 rounded =
          p.tip.unaryExpr([&](double x) { return std::round(x / options.increment_mm) * options.increment_mm; });
      if (out.empty() || rounded != out.back()) out.push_back(rounded);
    }
  return out;
}

double tolerance_left_mm(const RasterOptions& options) {
  return (1 - kChordFraction) * options.tolerance_mm - kRounding * options.increment_mm;
}

}  // namespace camber::repath
