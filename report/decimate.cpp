#include "report/decimate.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace camber::report {

std::vector<std::size_t> keep_extremes(std::span<const double> values, std::size_t max_count) {
  std::vector<std::size_t> kept;
  if (values.size() <= max_count) {
    kept.resize(values.size());
    std::iota(kept.begin(), kept.end(), std::size_t{0});
    return kept;
  }
  constexpr std::size_t kPerRun = 3;
  const std::size_t runs = std::max<std::size_t>(1, max_count / kPerRun);
  const std::size_t length = (values.size() + runs - 1) / runs;
  for (std::size_t from = 0; from < values.size(); from += length) {
    const auto run = values.subspan(from, std::min(length, values.size() - from));
    const auto [least, greatest] = std::minmax_element(run.begin(), run.end());
    std::vector<std::size_t> of_run{from, from + static_cast<std::size_t>(least - run.begin()),
                                    from + static_cast<std::size_t>(greatest - run.begin())};
    std::sort(of_run.begin(), of_run.end());
    of_run.erase(std::unique(of_run.begin(), of_run.end()), of_run.end());
    kept.insert(kept.end(), of_run.begin(), of_run.end());
  }
  return kept;
}

double nice_limit(double value) {
  if (!(value > 0) || !std::isfinite(value)) return 1;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.5})
    if (value <= step * decade * (1 + 1e-12)) return step * decade;
  return 10 * decade;
}

}  // namespace camber::report
