#include "repath/raster/scallop.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace camber::repath {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kAcross = 24;  ///< places across two rows between which crossings are sought
constexpr int kBetween = 7;  ///< rows that say where the finished surface is

/// Height of the tip between the samples of a row.
double tip_at(const RowHeights& row, double t) {
  const auto n = static_cast<std::ptrdiff_t>(row.tip_mm.size());
  const std::ptrdiff_t k = std::clamp<std::ptrdiff_t>(std::lround(t), 0, n - 1);
  const auto value = [&](std::ptrdiff_t i) {
    return i >= 0 && i < n && row.tip_mm[static_cast<std::size_t>(i)] ? *row.tip_mm[static_cast<std::size_t>(i)]
                                                                      : kInfinity;
  };
  const double here = value(k), before = value(k - 1), behind = value(k + 1), x = t - static_cast<double>(k);
  if (std::isinf(here) || x == 0) return here;
  if (std::isinf(before) || std::isinf(behind)) {
    const double other = x > 0 ? behind : before;
    return std::isinf(other) ? kInfinity : here + std::abs(x) * (other - here);
  }
  return here + 0.5 * x * (behind - before) + 0.5 * x * x * (before - 2 * here + behind);
}

double slope_at(const RowHeights& row, double t, double step_mm) {
  const double before = tip_at(row, t - 0.5), behind = tip_at(row, t + 0.5);
  return std::isinf(before) || std::isinf(behind) ? 0 : (behind - before) / step_mm;
}

}  // namespace

std::optional<SweptHeight> swept_height(const Underside& cutter, const RowHeights& row, double step_mm, double place,
                                        double v_mm) {
  const double radius = cutter.radius_mm(), beside = v_mm - row.v_mm, left = radius * radius - beside * beside;
  constexpr double kRounding = 1e-9;
  if (left < -kRounding) return std::nullopt;
  const double reach = std::sqrt(std::max(0.0, left)) / step_mm;
  const double first = std::max(0.0, place - reach),
               last = std::min(static_cast<double>(row.tip_mm.size()) - 1, place + reach);
  if (first > last) return std::nullopt;
  SweptHeight best{kInfinity, place};
  const auto try_tip = [&](double t, double tip) {
    if (tip >= best.height_mm) return;  // the underside lies no lower
    const double away = std::min(radius, std::sqrt(beside * beside + (t - place) * (t - place) * step_mm * step_mm));
    const double height = tip + (away <= cutter.flat_mm ? 0 : cutter.height_mm(away));
    if (height < best.height_mm) best = {height, t};
  };
  const auto try_at = [&](double t) { try_tip(t, tip_at(row, t)); };
  try_at(first), try_at(last);
  for (auto k = static_cast<std::size_t>(std::ceil(first)); k <= static_cast<std::size_t>(last); ++k)
    if (row.tip_mm[k]) try_tip(static_cast<double>(k), *row.tip_mm[k]);
  if (std::isinf(best.height_mm)) return std::nullopt;
  // Closer about the best: it lies within a step.
  for (double closer = 0.5; closer > 0.02; closer *= 0.5) {
    const double at = best.at;
    if (at - closer >= first) try_at(at - closer);
    if (at + closer <= last) try_at(at + closer);
  }
  return best;
}

std::optional<double> swept_scallop_mm(const RowSampler& sampler, const Underside& cutter, const RowHeights& a,
                                       const RowHeights& b, std::span<const RowHeights> between, std::size_t k) {
  const double step = sampler.step_mm(), width = b.v_mm - a.v_mm, radius = cutter.radius_mm();
  const double from = b.v_mm - radius, to = a.v_mm + radius;
  std::optional<double> worst;
  const auto place = static_cast<double>(k);
  if (!(from < to)) return std::nullopt;
  struct Here {
    double v = 0;
    std::optional<SweptHeight> a, b;
    bool known() const { return a && b; }
    double less() const { return a->height_mm - b->height_mm; }
  };
  const auto here = [&](double v) {
    return Here{v, swept_height(cutter, a, step, place, v), swept_height(cutter, b, step, place, v)};
  };
  const auto measure = [&](double v, double top_mm) {
    if (!sampler.covers(k, v)) return;
    std::optional<SweptHeight> lowest;
    const RowHeights* by = nullptr;
    for (const RowHeights& row : between)
      if (const auto now = swept_height(cutter, row, step, place, v);
          now && (!lowest || now->height_mm < lowest->height_mm))
        lowest = now, by = &row;
    // What the cutter leaves where it rolls over a border is no surface.
    if (!lowest || !by->inside[static_cast<std::size_t>(std::lround(lowest->at))]) return;
    // The surface slopes at the contact as the tip does over the row.
    const double along = slope_at(*by, lowest->at, step);
    const double on_a = tip_at(a, lowest->at), on_b = tip_at(b, lowest->at);
    const double across = std::isinf(on_a) || std::isinf(on_b) ? 0 : (on_b - on_a) / width;
    worst = std::max(worst.value_or(0), (top_mm - lowest->height_mm) / std::sqrt(1 + along * along + across * across));
  };
  Here left = here(from);
  for (int i = 1; i <= kAcross; ++i) {
    const Here right = here(from + (to - from) * i / kAcross);
    if (left.known() && right.known() && (left.less() <= 0) != (right.less() <= 0)) {
      Here low = left, high = right;
      for (int halving = 0; halving < 16; ++halving) {
        const Here middle = here(0.5 * (low.v + high.v));
        if (!middle.known()) break;
        ((middle.less() <= 0) == (low.less() <= 0) ? low : high) = middle;
      }
      measure(low.v, std::max(low.a->height_mm, low.b->height_mm));
    }
    left = right;
  }
  // At the border of the one that lies lower the other's height is left.
  if (const Here first = here(from); first.known() && first.less() > 0) measure(from, first.a->height_mm);
  if (const Here last = here(to); last.known() && last.less() <= 0) measure(to, last.b->height_mm);
  return worst;
}

}  // namespace camber::repath
