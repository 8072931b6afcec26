#include "calib/fit_smoothing.h"

#include <algorithm>
#include <cmath>

namespace camber::calib {
namespace {

constexpr double kRestS = 0.02;
constexpr double kLookS = 0.4;          // after a start
constexpr double kMovesMm = 0.001;      // over the look
constexpr std::size_t kHalfWindow = 4;  // periods; a speed difference is taken over twice as many
constexpr double kFallen = 0.7;         // of the greatest acceleration: it is over
constexpr std::size_t kFewestStarts = 3;

/// Acceleration along the path at every sample of [first, end), of the commanded positions.
std::vector<double> accelerations(const ServoTrace& trace, std::size_t first, std::size_t end) {
  const std::size_t h = kHalfWindow;
  const double t = static_cast<double>(h) * trace.period_s;
  std::vector<double> a;
  for (std::size_t k = first; k < end; ++k) {
    const double before = (trace.command_mm[k] - trace.command_mm[k - h]).norm() / t;
    const double after = (trace.command_mm[k + h] - trace.command_mm[k]).norm() / t;
    a.push_back((after - before) / t);
  }
  return a;
}

std::optional<double> rise_of(const std::vector<double>& a, double period_s) {
  std::size_t top = 0;
  for (std::size_t i = 0; i < a.size() && a[i] > kFallen * a[top]; ++i)
    if (a[i] > a[top]) top = i;
  for (std::size_t i = 1; i < a.size(); ++i) {
    if (a[i] > a[top]) top = i;
    if (a[i] < kFallen * a[top] && i > top) break;
  }
  if (a.empty() || a[top] <= 0) return std::nullopt;
  double low = -1, high = -1, held = 0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    const auto crossing = [&](double level) {
      return static_cast<double>(i) - (a[i] - level) / std::max(1e-12, a[i] - a[i - 1]);
    };
    if (low < 0 && a[i] >= 0.1 * a[top]) low = crossing(0.1 * a[top]);
    if (high < 0 && a[i] >= 0.9 * a[top]) high = crossing(0.9 * a[top]);
    if (high >= 0 && a[i] < 0.9 * a[top]) break;
    if (high >= 0) ++held;
  }
  const double apparent = (high - low) / 0.8, window = 1.0 * kHalfWindow;
  if (low < 0 || high < 0 || held < 0.5 * apparent) return std::nullopt;
  return period_s * std::sqrt(std::max(0.0, apparent * apparent - window * window));
}

void add_starts(const ServoTrace& trace, std::vector<double>& rises) {
  const auto rest = static_cast<std::size_t>(kRestS / trace.period_s);
  const auto look = static_cast<std::size_t>(kLookS / trace.period_s);
  for (const Stretch& s : trace.stretches) {
    std::size_t still = 0;
    for (std::size_t k = s.first + 1; k + look + kHalfWindow < s.end; ++k) {
      if (trace.command_mm[k] == trace.command_mm[k - 1]) {
        ++still;
        continue;
      }
      const bool starts =
          still >= rest && k > s.first + rest && (trace.command_mm[k + look] - trace.command_mm[k]).norm() > kMovesMm;
      still = 0;
      if (!starts) continue;
      const std::size_t from = k - std::min(k - s.first - kHalfWindow, 2 * kHalfWindow);
      if (const auto rise = rise_of(accelerations(trace, from, k + look), trace.period_s)) rises.push_back(*rise);
    }
  }
}

}  // namespace

std::optional<FittedValue> smoothing_time_s(const std::vector<const ServoTrace*>& traces) {
  std::vector<double> rises;
  for (const ServoTrace* trace : traces) add_starts(*trace, rises);
  if (rises.size() < kFewestStarts) return std::nullopt;
  std::sort(rises.begin(), rises.end());
  const double value = rises[rises.size() * 3 / 4];
  if (value <= 2 * kHalfWindow * traces.front()->period_s) return std::nullopt;
  return FittedValue{value, 0.5 * std::max(traces.front()->period_s, rises.back() - rises[rises.size() / 2])};
}

}  // namespace camber::calib
