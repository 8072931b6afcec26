#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_sort.h>

#include "removal/form_error.h"

namespace camber::removal {
namespace {

constexpr int kMaxBins = 40;

/// A value and the number of its point.
struct Ranked {
  double value;
  std::size_t point;
  bool operator<(const Ranked& o) const { return value < o.value || (value == o.value && point < o.point); }
};

/// Equal ones in the order of the points.
std::vector<Ranked> ranked(const std::vector<double>& error) {
  std::vector<Ranked> out;
  out.reserve(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) out.push_back({error[i], i});
  tbb::parallel_sort(out.begin(), out.end());
  return out;
}

double round_width(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= least * (1 - 1e-12)) return step * power;
  return 10 * power;
}

}  // namespace

double value_at_area(std::vector<ValueOfArea> points, double area_mm2) {
  constexpr double kRounding = 1e-11;
  if (points.empty()) return 0;
  const double wanted = area_mm2 * (1 - kRounding);
  double below = 0;
  auto from = points.begin(), to = points.end();
  while (to - from > 1) {
    const auto middle = from + (to - from) / 2;
    std::nth_element(from, middle, to, [](const auto& a, const auto& b) { return a.value < b.value; });
    const double lower = std::accumulate(from, middle, 0.0, [](double sum, const auto& p) { return sum + p.area_mm2; });
    if (below + lower >= wanted) {
      to = middle;
    } else {
      below += lower;
      from = middle;
    }
  }
  return from->value;
}

ErrorFigures error_figures(const std::vector<double>& error, const std::vector<double>& area) {
  ErrorFigures f;
  if (error.empty()) return f;
  f.min = *std::min_element(error.begin(), error.end());
  f.max = *std::max_element(error.begin(), error.end());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < error.size(); ++i) {
    f.area_mm2 += area[i];
    sum += area[i] * error[i];
    squares += area[i] * error[i] * error[i];
  }
  f.mean = sum / f.area_mm2;
  f.rms = std::sqrt(squares / f.area_mm2);
  std::vector<ValueOfArea> sizes;
  sizes.reserve(error.size());
  for (std::size_t i = 0; i < error.size(); ++i) sizes.push_back({std::abs(error[i]), area[i]});
  f.p95 = value_at_area(std::move(sizes), 0.95 * f.area_mm2);
  return f;
}

ErrorSpread error_spread(const std::vector<double>& error, const std::vector<double>& area) {
  ErrorSpread out;
  if (error.empty()) return out;
  const std::vector<Ranked> order = ranked(error);
  const double whole = std::accumulate(area.begin(), area.end(), 0.0);
  double below = 0;
  std::size_t next = 0;
  for (const auto& [value, i] : order) {
    below += area[i];
    for (; next < out.kFractions.size() && below >= out.kFractions[next] * whole; ++next) out.percentile[next] = value;
  }
  for (; next < out.kFractions.size(); ++next) out.percentile[next] = order.back().value;
  const double least = order.front().value, greatest = order.back().value;
  // The width leaves room for a bin that the round beginning cuts off.
  out.bin_width = round_width(std::max((greatest - least) / (kMaxBins - 1), 1e-6));
  out.bin_from = std::floor(least / out.bin_width) * out.bin_width;
  const auto bins = static_cast<std::size_t>(std::floor((greatest - out.bin_from) / out.bin_width)) + 1;
  out.bin_area_mm2.assign(bins, 0.0);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const auto bin = static_cast<std::size_t>(std::max(0.0, (error[i] - out.bin_from) / out.bin_width));
    out.bin_area_mm2[std::min(bin, bins - 1)] += area[i];
  }
  return out;
}

}  // namespace camber::removal
