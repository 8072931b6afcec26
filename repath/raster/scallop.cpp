#include "repath/raster/scallop.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::repath {
namespace {

constexpr double kBorderMm = 1e-6;
constexpr std::size_t kEverySwept = 3;  ///< of the samples along rows: where a cutter with a flat is measured

bool in(const Rectangle& r, const Vec2& p, double room) {
  return p.x() >= r.min.x() - room && p.x() <= r.max.x() + room && p.y() >= r.min.y() - room &&
         p.y() <= r.max.y() + room;
}

/// A row as it is at one place along it.
struct Groove {
  double v_mm, tip_mm, slope;
  /// Height of what it leaves; infinity beside it.
  double at(const Underside& cutter, double v) const {
    const auto rise = rise_on_line(cutter, v - v_mm, slope);
    return rise ? tip_mm - *rise : std::numeric_limits<double>::infinity();
  }
};

/// Where the row ends, the slope is that of its one side.
std::optional<Groove> groove(const RowHeights& row, std::size_t k, double step_mm) {
  const auto& here = row.tip_mm[k];
  if (!here) return std::nullopt;
  const bool before = k > 0 && row.tip_mm[k - 1], behind = k + 1 < row.tip_mm.size() && row.tip_mm[k + 1];
  if (!before && !behind) return Groove{row.v_mm, *here, 0};
  const double from = before ? *row.tip_mm[k - 1] : *here, to = behind ? *row.tip_mm[k + 1] : *here;
  return Groove{row.v_mm, *here, (to - from) / (step_mm * (before + behind))};
}

struct Cusp {
  double v_mm, height_mm;
};

/// Returns how far a point is above a groove, at right angles to it. The foot lies no farther beside it than the point
/// lies above.
double distance_mm(const Underside& cutter, const Groove& groove, const Cusp& point) {
  const double above = point.height_mm - groove.at(cutter, point.v_mm);
  if (!(above > 0)) return above;
  const double flatten = 1 / std::sqrt(1 + groove.slope * groove.slope);  // in the plane at right angles to the row
  const auto away = [&](double v) {
    return std::hypot(v - point.v_mm, flatten * (point.height_mm - groove.at(cutter, v)));
  };
  constexpr double kGolden = 0.6180339887498949;
  double low = point.v_mm - above, high = point.v_mm + above;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low), at_a = away(a), at_b = away(b);
  for (int i = 0; i < 24; ++i) {
    if (at_a < at_b)
      high = b, b = a, at_b = at_a, a = high - kGolden * (high - low), at_a = away(a);
    else
      low = a, a = b, at_a = at_b, b = low + kGolden * (high - low), at_b = away(b);
  }
  return std::min(std::min(at_a, at_b), flatten * above);
}

/// Where the grooves cross: left of it a lies lower, right of it b.
std::optional<Cusp> cusp_of(const Underside& cutter, const Groove& a, const Groove& b) {
  double left = b.v_mm - cutter.radius_mm(), right = a.v_mm + cutter.radius_mm();
  if (!(left < right)) return std::nullopt;
  for (int i = 0; i < 44; ++i) {
    const double middle = 0.5 * (left + right);
    (a.at(cutter, middle) <= b.at(cutter, middle) ? left : right) = middle;
  }
  // Where one ends upright, the cusp is as high as the other is there.
  const double on_left = a.at(cutter, left), on_right = b.at(cutter, right);
  const double height = std::isinf(on_left) ? on_right : std::isinf(on_right) ? on_left : std::max(on_left, on_right);
  return Cusp{on_left > on_right ? left : right, height};
}

}  // namespace

bool touches(const Rectangle& boundary, const DropContact& contact) {
  return in(boundary, contact.point.head<2>(), kBorderMm);
}

bool works_inside(const Underside& cutter, const Rectangle& boundary, const Vec2& axis, const DropContact& contact) {
  const Vec2 at = contact.point.head<2>();
  if (!touches(boundary, contact)) return false;
  const double under_flat = std::max(cutter.flat_mm - 1e-9, 1e-9);  // the rim is not
  if ((at - axis).norm() < under_flat) return in(boundary, axis, kBorderMm);
  return contact.kind == ContactKind::facet || in(boundary, at, -kBorderMm);
}

bool RowHeights::any_inside() const {
  return std::any_of(inside.begin(), inside.end(), [](char i) { return i != 0; });
}

RowSampler::RowSampler(const DropCutter& part, const RowFrame& frame, const Rectangle& boundary, double step_mm)
    : part_(part), frame_(frame), boundary_(boundary) {
  u_min_ = v_min_ = std::numeric_limits<double>::infinity();
  u_max_ = v_max_ = -u_min_;
  for (const double x : {boundary.min.x(), boundary.max.x()})
    for (const double y : {boundary.min.y(), boundary.max.y()}) {
      const double u = frame.along.dot(Vec2(x, y)), v = frame.across.dot(Vec2(x, y));
      u_min_ = std::min(u_min_, u), u_max_ = std::max(u_max_, u);
      v_min_ = std::min(v_min_, v), v_max_ = std::max(v_max_, v);
    }
  const double width = u_max_ - u_min_ + 2 * part.cutter().radius_mm();
  step_ = width / std::max(4.0, std::ceil(width / step_mm));
}

bool RowSampler::covers(std::size_t k, double v_mm) const {
  const double u = u_min_ - part_.cutter().radius_mm() + static_cast<double>(k) * step_;
  return in(boundary_, frame_.place(u, v_mm), 0);
}

RowHeights RowSampler::row(double v_mm) const {
  RowHeights out;
  out.v_mm = v_mm;
  const double from = u_min_ - part_.cutter().radius_mm();
  const auto n = static_cast<std::size_t>(std::lround((u_max_ - u_min_ + 2 * part_.cutter().radius_mm()) / step_)) + 1;
  out.tip_mm.reserve(n), out.inside.reserve(n);
  std::optional<std::uint32_t> near;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec2 at = frame_.place(from + static_cast<double>(k) * step_, v_mm);
    const auto contact = part_.at(at, near);
    if (contact) near = contact->triangle;
    out.tip_mm.push_back(contact ? std::optional(contact->tip_mm) : std::nullopt);
    out.inside.push_back(contact && works_inside(part_.cutter(), boundary_, at, *contact));
  }
  return out;
}

double scallop_mm(const RowSampler& sampler, const Underside& cutter, const RowHeights& a, const RowHeights& b) {
  const bool ball = cutter.flat_mm == 0;
  const int between = ball ? 1 : 7;
  const double missed = ball ? 1 : 8.0 / 7;
  const double width = b.v_mm - a.v_mm;
  std::vector<RowHeights> rows;
  for (int i = 1; i <= between; ++i) rows.push_back(sampler.row(a.v_mm + width * i / (between + 1)));
  double worst = 0;
  for (std::size_t k = 0; k < a.tip_mm.size(); k += ball ? 1 : kEverySwept) {
    if (!a.inside[k] && !b.inside[k]) continue;
    if (!ball) {
      if (const auto height = swept_scallop_mm(sampler, cutter, a, b, rows, k)) {
        worst = std::max(worst, missed * *height);
        continue;
      }
    }
    const auto one = groove(a, k, sampler.step_mm()), other = groove(b, k, sampler.step_mm());
    if (!one || !other) continue;
    const auto cusp = cusp_of(cutter, *one, *other);
    // Where one row lies wholly above the other's reach, the wall between them stands.
    const Cusp top = cusp.value_or(Cusp{0.5 * (a.v_mm + b.v_mm), std::max(one->tip_mm, other->tip_mm)});
    std::optional<Groove> lowest;
    for (const RowHeights& row : rows)
      if (const auto middle = groove(row, k, sampler.step_mm());
          middle && (!lowest || middle->at(cutter, top.v_mm) < lowest->at(cutter, top.v_mm)))
        lowest = middle;
    if (!lowest) continue;
    // The steps of a flat lie one above the other: their height is that over the slope through their edges.
    const double rise = (other->tip_mm - one->tip_mm) / width;
    const double height = ball ? distance_mm(cutter, *lowest, top)
                               : (top.height_mm - lowest->at(cutter, top.v_mm)) /
                                     std::sqrt(1 + rise * rise + lowest->slope * lowest->slope);
    worst = std::max(worst, missed * height);
  }
  return worst;
}

namespace {

class Spacer {
 public:
  Spacer(const RowSampler& sampler, const Underside& cutter, double scallop, double increment)
      : sampler_(sampler), cutter_(cutter), scallop_(scallop), increment_(increment) {
    const double sag = std::min(scallop, cutter.corner_mm);
    const double level = 2 * std::sqrt(sag * (2 * cutter.corner_mm - sag));
    const double most = 1.5 * cutter.radius_mm();
    level_ = std::clamp(2 * cutter.flat_mm + level, 2 * increment, most);
    farthest_ = std::min(2 * cutter.flat_mm + 2 * level, most);
    farthest_ = std::max(farthest_, level_);
    closest_ = std::max(2 * increment, 0.1 * std::min(level_, 2 * std::sqrt(2 * cutter.radius_mm() * scallop)));
  }

  RowSpacing run(const std::function<void(double)>& progress) {
    RowSpacing out;
    out.closest_mm = closest_;
    RowHeights row = first();
    double space = level_;
    std::size_t steep = 0;
    while (row.any_inside() || row.v_mm < sampler_.v_max_mm()) {
      if (row.any_inside()) out.rows_mm.push_back(row.v_mm);
      if (progress) progress((row.v_mm - sampler_.v_min_mm()) / (sampler_.v_max_mm() - sampler_.v_min_mm()));
      auto [next, height] = next_row(row, space);
      // A row on the border, where none beyond it would touch all along it.
      if (row.v_mm < sampler_.v_max_mm() - increment_ && next.v_mm > sampler_.v_max_mm()) {
        next = sampler_.row(sampler_.v_max_mm());
        height = scallop_mm(sampler_, cutter_, row, next);
      } else {
        space = next.v_mm - row.v_mm;
      }
      if (row.any_inside() && !next.any_inside()) {
        if (auto last = last_inside(row, next.v_mm, space); last.v_mm > row.v_mm) out.rows_mm.push_back(last.v_mm);
      }
      if (next.any_inside() && row.any_inside()) {
        out.largest_scallop_mm = std::max(out.largest_scallop_mm, height);
        steep += height > scallop_;
      }
      row = std::move(next);
    }
    if (out.rows_mm.size() > 1)
      out.steep_fraction = static_cast<double>(steep) / static_cast<double>(out.rows_mm.size() - 1);
    return out;
  }

 private:
  double rounded(double v) const { return std::floor(v / increment_ + 1e-6) * increment_; }

  /// The first one that touches inside, sought from outside.
  RowHeights first() const {
    const double step = std::max(closest_, 0.25 * std::min(level_, cutter_.radius_mm()));
    double outside = sampler_.v_min_mm() - cutter_.radius_mm() - step;
    for (double v = outside + step; v < sampler_.v_max_mm(); v += step) {
      RowHeights row = sampler_.row(v < sampler_.v_min_mm() ? rounded(v) : std::max(sampler_.v_min_mm(), rounded(v)));
      if (!row.any_inside()) {
        outside = row.v_mm;
        continue;
      }
      while (row.v_mm - outside > 3 * increment_) {
        RowHeights middle = sampler_.row(rounded(0.5 * (row.v_mm + outside)));
        if (middle.any_inside())
          row = std::move(middle);
        else
          outside = middle.v_mm;
      }
      return row;
    }
    return sampler_.row(sampler_.v_max_mm());
  }

  /// The last one that touches inside between a row and a place where none does, where it lies a quarter of a space
  /// behind the row; else the row.
  RowHeights last_inside(const RowHeights& row, double outside, double space) const {
    RowHeights last = row;
    while (outside - last.v_mm > std::max(0.1 * space, 2 * increment_)) {
      RowHeights middle = sampler_.row(rounded(0.5 * (last.v_mm + outside)));
      if (middle.any_inside())
        last = std::move(middle);
      else
        outside = middle.v_mm;
    }
    return last.v_mm - row.v_mm > 0.25 * space ? last : row;
  }

  std::pair<RowHeights, double> at(const RowHeights& row, double space) const {
    RowHeights next = sampler_.row(row.v_mm + space);
    const double height = scallop_mm(sampler_, cutter_, row, next);
    return {std::move(next), height};
  }

  /// The farthest row that keeps the scallop, sought from the last space. The height grows with a power of the space
  /// between 1 (steps) and 2 (a ball's cusps).
  std::pair<RowHeights, double> next_row(const RowHeights& row, double space) const {
    constexpr int kTries = 12;
    constexpr double kEnough = 0.95;
    double low = 0, high = std::numeric_limits<double>::infinity();
    std::optional<std::pair<RowHeights, double>> best;
    for (int i = 0; i < kTries; ++i) {
      space = std::max(closest_, rounded(std::min(space, farthest_)));
      auto tried = at(row, space);
      const double height = tried.second;
      if (height <= scallop_) {
        low = space;
        best = std::move(tried);
        if (height > kEnough * scallop_ || space >= farthest_ - increment_) break;
      } else {
        high = space;
        if (space <= closest_) return best ? std::move(*best) : std::move(tried);
      }
      double guess = space * std::clamp(std::sqrt(0.98 * scallop_ / std::max(height, 1e-12)), 0.4, 1.6);
      if (guess <= low || guess >= high) guess = std::isinf(high) ? 1.5 * low : 0.5 * (low + high);
      if (high - low < 2 * increment_) break;
      space = guess;
    }
    return best ? std::move(*best) : at(row, closest_);
  }

  const RowSampler& sampler_;
  const Underside& cutter_;
  double scallop_, increment_;
  double level_ = 0, farthest_ = 0, closest_ = 0;
};

}  // namespace

RowSpacing space_rows(const RowSampler& sampler, const Underside& cutter, double scallop_mm, double increment_mm,
                      const std::function<void(double)>& progress) {
  return Spacer(sampler, cutter, scallop_mm, increment_mm).run(progress);
}

}  // namespace camber::repath
