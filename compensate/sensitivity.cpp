#include "compensate/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace camber::compensate {
namespace {

constexpr double kAverage_mm = 2.0;  // length of path over which a gain is averaged
constexpr double kPrior_mm = 0.001;  // change of the shift with the weight of the whole path's mean

struct Sums {
  double products = 0, squares = 0, area = 0;
};

/// Exponential averages forwards and backwards along a chain.
void average(std::vector<Sums>& sums, const ShiftPath& path, const ShiftChain& chain) {
  const auto& points = path.points();
  const std::vector<Sums> own(sums.begin() + static_cast<std::ptrdiff_t>(chain.from),
                              sums.begin() + static_cast<std::ptrdiff_t>(chain.from + chain.count));
  const auto pass = [&](auto index) {
    Sums carried;
    for (std::size_t k = 0; k < chain.count; ++k) {
      const std::size_t i = index(k);
      if (k > 0) {
        const double step = std::abs(points[chain.from + i].along_mm - points[chain.from + index(k - 1)].along_mm);
        const double keep = std::exp(-step / kAverage_mm);
        carried = {keep * carried.products, keep * carried.squares, keep * carried.area};
        Sums& s = sums[chain.from + i];
        s = {s.products + carried.products, s.squares + carried.squares, s.area + carried.area};
      }
      carried = {carried.products + own[i].products, carried.squares + own[i].squares, carried.area + own[i].area};
    }
  };
  pass([](std::size_t k) { return k; });
  pass([&](std::size_t k) { return chain.count - 1 - k; });
}

}  // namespace

void Sensitivity::learn(const ShiftPath& path, std::span<const Vec3> shifts_before, const Observed& before,
                        const Observed& now) {
  std::vector<Sums> sums(gain_.size());
  Sums whole;
  for (std::size_t i = 0; i < now.points.size(); ++i) {
    if (!now.compensated[i] || !before.compensated[i]) continue;
    const Observation& o = now.points[i];
    if (!o.own || !before.points[i].own) continue;  // a row above the surface moves without changing it
    const std::size_t lower = o.place.lower;
    const double v = o.place.upper_fraction, u = 1 - v;
    const Vec3 old = u * shifts_before[lower] + v * shifts_before[lower + 1];
    const double step = o.normal.dot(path.shift_at(o.place) - old);
    const double change = o.error_mm - before.points[i].error_mm;
    const Sums s{o.area_mm2 * step * change, o.area_mm2 * step * step, o.area_mm2};
    const auto add = [&](Sums& to, double fraction) {
      to.products += fraction * s.products;
      to.squares += fraction * s.squares;
      to.area += fraction * s.area;
    };
    add(sums[lower], u);
    add(sums[lower + 1], v);
    add(whole, 1);
  }
  const double prior_mm2 = kPrior_mm * kPrior_mm;
  const double mean =
      (whole.products + prior_mm2 * whole.area) / std::max(whole.squares + prior_mm2 * whole.area, 1e-30);
  for (const ShiftChain& c : path.chains()) average(sums, path, c);
  for (std::size_t i = 0; i < gain_.size(); ++i) {
    const Sums& s = sums[i];
    const double prior = std::max(prior_mm2 * s.area, 1e-12);
    gain_[i] = std::clamp((s.products + prior * mean) / (s.squares + prior), kMin, kGreatest);
  }
}

void Sensitivity::apply_to(std::vector<Observation>& observations) const {
  for (Observation& o : observations)
    o.gain = (1 - o.place.upper_fraction) * gain_[o.place.lower] + o.place.upper_fraction * gain_[o.place.lower + 1];
}

double Sensitivity::mean() const {
  return gain_.empty() ? 1 : std::accumulate(gain_.begin(), gain_.end(), 0.0) / static_cast<double>(gain_.size());
}

}  // namespace camber::compensate
