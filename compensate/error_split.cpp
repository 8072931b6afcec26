#include "compensate/error_split.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compensate/row_form.h"

namespace camber::compensate {
namespace {

constexpr double kStiff = 0.02;       // smoothing of a fit that may do almost anything, mm
constexpr double kCentring_mm = 1.0;  // smoothing of a shift beyond the least squares'
constexpr double kNearWeight = 8;     // weight of errors near the 95th percentile
constexpr double kCentringStep = 0.5;
constexpr int kCentrings = 8;

/// error + n . (change of the shift), one per observation.
std::vector<double> left_by(const ShiftPath& old, std::span<const Observation> observations,
                            const FitShiftOptions& options) {
  ShiftPath path = old;
  fit_shift(path, observations, options);
  std::vector<double> left;
  left.reserve(observations.size());
  for (const Observation& o : observations)
    left.push_back(o.error_mm + o.gain * o.normal.dot(path.shift_at(o.place) - old.shift_at(o.place)));
  return left;
}

FitShiftOptions stiff(const FitShiftOptions& options) {
  FitShiftOptions out = options;
  out.max_shift_mm = std::numeric_limits<double>::infinity();
  out.smoothing_mm = std::min(kStiff, options.smoothing_mm);
  out.bounded = false;
  return out;
}

double mean_square(const std::vector<double>& values, std::span<const Observation> observations, double area_mm2,
                   auto wanted) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (wanted(observations[i])) sum += observations[i].area_mm2 * values[i] * values[i];
  return area_mm2 > 0 ? sum / area_mm2 : 0;
}

double um(double mean_square_mm2) { return 1000 * std::sqrt(std::max(0.0, mean_square_mm2)); }

}  // namespace

double ErrorSplit::not_correctable_um() const {
  return std::sqrt(short_range_um * short_range_um + opposed_um * opposed_um + tip_um * tip_um + bow_um * bow_um);
}

void ErrorSplit::give_to_guard(double free_correctable_um) {
  const double all = correctable_um;
  correctable_um = std::min(all, free_correctable_um);
  guard_um = std::sqrt(all * all - correctable_um * correctable_um);
}

namespace {

/// Returns what a slowly varying shift adds to the errors that the least squares leave, so that their 95th percentile
/// becomes less: an error weighs the more the nearer it is to that percentile (iteratively reweighted least squares).
std::vector<double> centring_mm(const ShiftPath& path, std::span<const Observation> observations,
                                const std::vector<double>& left_mm, double decay_mm) {
  const FitShiftOptions slow{kCentring_mm, decay_mm, std::numeric_limits<double>::infinity()};
  ShiftPath rest = path;
  rest.set_shifts(std::vector<Vec3>(path.points().size(), Vec3::Zero()));
  std::vector<Observation> asked(observations.begin(), observations.end());
  std::vector<double> area(left_mm.size()), added(left_mm.size(), 0.0), best = added, sum = left_mm;
  double whole = 0, least = std::numeric_limits<double>::infinity(), deepest = least;
  for (std::size_t i = 0; i < area.size(); ++i) whole += area[i] = observations[i].area_mm2;
  for (int k = 0; k <= kCentrings; ++k) {
    const double p95 = removal::error_figures(sum, area).p95;
    std::vector<removal::ValueOfArea> depths;
    depths.reserve(sum.size());
    for (std::size_t i = 0; i < sum.size(); ++i) depths.push_back({-sum[i], area[i]});
    const double depth = depth_p999(std::move(depths), whole);
    if (k == 0) deepest = depth;
    if (p95 < least && depth <= deepest) {
      least = p95;
      best = added;
    }
    if (p95 <= 0) break;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const double ratio = sum[i] / p95, x = ratio * ratio * ratio * ratio;
      asked[i].error_mm = left_mm[i];
      asked[i].weight = 1 + kNearWeight * std::min(x, 1 / x);
    }
    ShiftPath moved = rest;
    fit_shift(moved, asked, slow);
    for (std::size_t i = 0; i < asked.size(); ++i) {
      added[i] += kCentringStep * (asked[i].normal.dot(moved.shift_at(asked[i].place)) - added[i]);
      sum[i] = left_mm[i] + added[i];
    }
  }
  return best;
}

}  // namespace

std::vector<Observation> without_row_form(const ShiftPath& path, std::span<const Observation> observations,
                                          const FitShiftOptions& options) {
  std::vector<Observation> out(observations.begin(), observations.end());
  const auto subtract = [&](const std::vector<double>& form) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i].error_mm -= form[i];
      out[i].form_mm += form[i];
    }
  };
  for (Observation& o : out) o.form_mm = 0;
  subtract(row_form_mm(path, observations, left_by(path, observations, stiff(options)), options.smoothing_mm));
  if (!options.centred || out.empty()) return out;
  FitShiftOptions free = options;
  free.bounded = false;
  std::vector<double> left = left_by(path, out, free);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += out[i].form_mm;
  subtract(centring_mm(path, observations, left, options.decay_mm));
  return out;
}

std::vector<double> left_by_shift_mm(const ShiftPath& path, std::span<const Observation> observations,
                                     const FitShiftOptions& options) {
  const std::vector<Observation> asked = without_row_form(path, observations, options);
  std::vector<double> left = left_by(path, asked, options);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += observations[i].error_mm - asked[i].error_mm;
  return left;
}

namespace {

/// The judged observations and what fits of less and less freedom leave of them.
struct Fits {
  std::vector<std::size_t> index;  ///< index into Observed, one per observation
  std::vector<Observation> all;    ///< as observed
  std::vector<Observation> asked;  ///< less the form across the rows
  std::vector<double> at_one_place, smooth, limited, bounded;
  /// Finds, in smooth - at_one_place, what keeps the same form across the cutter for millimetres along the path. A
  /// shift that may change from one tooth passing to the next follows it, since a helix leaves each height at another
  /// place of the path; bow explains it, an entry or a corner does not.
  std::vector<double> bow_in_short_range{};
};

Fits fits_of(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options) {
  Fits out;
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    if (!observed.compensated[i] || !observed.judged(i)) continue;
    out.index.push_back(i);
    out.all.push_back(observed.points[i]);
    out.all.back().weight = 1;
  }
  FitShiftOptions free = options;
  free.max_shift_mm = std::numeric_limits<double>::infinity();
  free.bounded = false;
  out.asked = without_row_form(path, out.all, options);
  out.at_one_place = left_by(path, out.asked, stiff(options));
  out.smooth = left_by(path, out.asked, free);
  FitShiftOptions limited = options;
  limited.bounded = false;
  out.limited = left_by(path, out.asked, limited);
  out.bounded = options.bounded ? left_by(path, out.asked, options) : out.limited;
  return out;
}

void find_bow_in_short_range(const ShiftPath& path, Fits& f) {
  std::vector<double> short_range(f.all.size());
  for (std::size_t i = 0; i < short_range.size(); ++i) short_range[i] = f.smooth[i] - f.at_one_place[i];
  constexpr double kWholeForm = 0;  // however many points a row has across
  f.bow_in_short_range = row_form_mm(path, f.all, short_range, kWholeForm);
}

/// The largest part of one observation's error.
PointCause cause_of(const Fits& f, std::size_t i) {
  const Observation& o = f.all[i];
  const Cause fixed = o.opposed ? Cause::opposed : o.at_tip ? Cause::tip : Cause::bow;
  const double form = o.error_mm - f.asked[i].error_mm;
  PointCause out{Cause::correctable, f.asked[i].error_mm - f.bounded[i]};
  const auto offer = [&](Cause cause, double error_mm) {
    if (std::abs(error_mm) > std::abs(out.error_mm)) out = {cause, error_mm};
  };
  offer(Cause::bounded, f.bounded[i] - f.limited[i]);
  offer(Cause::limited, f.limited[i] - f.smooth[i]);
  const double bow = f.bow_in_short_range[i];
  offer(Cause::short_range, f.smooth[i] - f.at_one_place[i] - bow);
  offer(fixed, f.at_one_place[i] + form + bow);
  return out;
}

/// Returns the part of the short range's mean square that bow does not explain.
double without_bow(const Fits& f, double area_mm2) {
  std::vector<double> all, rest;
  for (std::size_t i = 0; i < f.all.size(); ++i) {
    all.push_back(f.smooth[i] - f.at_one_place[i]);
    rest.push_back(all.back() - f.bow_in_short_range[i]);
  }
  const auto every = [](const Observation&) { return true; };
  const double whole = mean_square(all, f.all, area_mm2, every);
  return whole > 0 ? std::min(1.0, mean_square(rest, f.all, area_mm2, every) / whole) : 1.0;
}

}  // namespace

ErrorSplit split_error(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options,
                       std::vector<PointCause>* causes) {
  ErrorSplit out;
  double area = 0, others = 0;
  if (causes) causes->assign(observed.points.size(), {});
  for (std::size_t i = 0; i < observed.points.size(); ++i) {
    const Observation& o = observed.points[i];
    if (!observed.judged(i)) continue;
    area += o.area_mm2;
    if (observed.compensated[i]) continue;
    others += o.area_mm2 * o.error_mm * o.error_mm;
    if (causes) (*causes)[i] = {Cause::not_compensated, o.error_mm};
  }
  if (area <= 0) return out;
  out.not_compensated_um = um(others / area);

  Fits f = fits_of(path, observed, options);
  find_bow_in_short_range(path, f);
  if (causes)
    for (std::size_t i = 0; i < f.all.size(); ++i) (*causes)[f.index[i]] = cause_of(f, i);
  const std::vector<Observation>& all = f.all;
  const auto every = [](const Observation&) { return true; };
  const auto errors = [](const std::vector<Observation>& of) {
    std::vector<double> values;
    values.reserve(of.size());
    for (const Observation& o : of) values.push_back(o.error_mm);
    return values;
  };
  const std::vector<double> error = errors(f.asked);
  std::vector<double> taken, taken_um, areas;
  for (std::size_t i = 0; i < all.size(); ++i) {
    taken.push_back(error[i] - f.bounded[i]);
    taken_um.push_back(1000 * taken.back());
    areas.push_back(all[i].area_mm2);
  }
  const double total = mean_square(error, all, area, every), left = mean_square(f.at_one_place, all, area, every),
               left_smooth = std::max(left, mean_square(f.smooth, all, area, every)),
               left_limited = std::max(left_smooth, mean_square(f.limited, all, area, every)),
               left_bounded = std::max(left_limited, mean_square(f.bounded, all, area, every));
  // A smooth path is not the least squares' best: what the fit would still move counts where it would gain less.
  const double correctable = std::max(total - left_bounded, mean_square(taken, all, area, every)),
               bounded_by = std::clamp(left_bounded - left_limited, 0.0, std::max(0.0, total - correctable)),
               limited_by = left_limited - left_smooth,
               short_range = std::max(0.0, total - correctable - bounded_by - limited_by - left) * without_bow(f, area);
  out.opposed_um = um(mean_square(f.at_one_place, all, area, [](const Observation& o) { return o.opposed; }));
  out.tip_um = um(mean_square(f.at_one_place, all, area, [](const Observation& o) { return o.at_tip && !o.opposed; }));
  out.short_range_um = um(short_range);
  out.bounded_um = um(bounded_by);
  out.limited_um = um(limited_by);
  out.correctable_um = um(correctable);
  const auto square = [](double value_um) { return value_um * value_um / 1e6; };
  out.bow_um = um(mean_square(errors(all), all, area, every) - correctable - bounded_by - limited_by - short_range -
                  square(out.opposed_um) - square(out.tip_um));
  const removal::ErrorFigures figures = removal::error_figures(taken_um, areas);
  out.correctable_p95_um = figures.p95;
  out.correctable_max_um = std::max(std::abs(figures.min), std::abs(figures.max));
  return out;
}

double depth_p999(std::vector<removal::ValueOfArea> depths, double area_mm2) {
  constexpr double kSpared = 0.001;
  double listed_mm2 = 0;
  for (const removal::ValueOfArea& d : depths) listed_mm2 += d.area_mm2;
  const double below_mm2 = listed_mm2 - kSpared * area_mm2;
  return below_mm2 > 0 ? std::max(0.0, removal::value_at_area(std::move(depths), below_mm2)) : 0;
}

double default_depth_limit_um(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options,
                              double tolerance_um) {
  constexpr double kRoom = 1.25;
  FitShiftOptions least_squares = options;
  least_squares.centred = false;
  const Fits f = fits_of(path, observed, least_squares);
  std::vector<removal::ValueOfArea> depths;
  double area = 0;
  for (std::size_t i = 0; i < f.all.size(); ++i) {
    const double left_mm = f.at_one_place[i] + f.all[i].error_mm - f.asked[i].error_mm;
    depths.push_back({-1000 * left_mm, f.all[i].area_mm2});
    area += f.all[i].area_mm2;
  }
  return std::max(tolerance_um, kRoom * depth_p999(std::move(depths), area));
}

}  // namespace camber::compensate
