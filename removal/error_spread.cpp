#include <algorithm>
#include <cmath>
#include <numeric>

#include "removal/surface.h"

namespace camber::removal {
namespace {

constexpr int kMostBins = 40;

double round_width(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= least * (1 - 1e-12)) return step * power;
  return 10 * power;
}

}  // namespace

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
  std::vector<std::size_t> order(error.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return std::abs(error[a]) < std::abs(error[b]); });
  double below = 0;
  for (const std::size_t i : order) {
    below += area[i];
    f.p95 = std::abs(error[i]);
    if (below >= 0.95 * f.area_mm2) break;
  }
  return f;
}

ErrorSpread error_spread(const std::vector<double>& error, const std::vector<double>& area) {
  ErrorSpread out;
  if (error.empty()) return out;
  std::vector<std::size_t> order(error.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return error[a] < error[b]; });
  const double whole = std::accumulate(area.begin(), area.end(), 0.0);
  double below = 0;
  std::size_t next = 0;
  for (const std::size_t i : order) {
    below += area[i];
    for (; next < out.kShares.size() && below >= out.kShares[next] * whole; ++next) out.percentile[next] = error[i];
  }
  for (; next < out.kShares.size(); ++next) out.percentile[next] = error[order.back()];
  const double least = error[order.front()], greatest = error[order.back()];
  // The width leaves room for a bin that the round beginning cuts off.
  out.bin_width = round_width(std::max((greatest - least) / (kMostBins - 1), 1e-6));
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
