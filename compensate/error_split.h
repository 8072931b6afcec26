#pragma once
// Error decomposition: which part of the error a shift of the path can correct, which part none can and why, and which
// part a limit prevents.
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/fit_shift.h"
#include "compensate/shift_path.h"
#include "removal/form_error.h"

namespace camber::compensate {

/// Root mean squares over the judged surface, um: squares add up to the error's,
///
///   rms^2 = correctable^2 + guard^2 + bounded^2 + limited^2 + short_range^2 + opposed^2 + tip^2 + bow^2 +
///   not_compensated^2
///
/// The parts come from least squares of the error against shifts of the path, each one with less freedom:
/// any shift at every point of the path; then smooth along the path; then within the largest shift; then without a
/// place that becomes worse than given (Observation::bound_mm), where the options are bounded. The shifts are
/// fitted to the error less the form across the rows, so that they do not follow where the grid shows a row.
struct ErrorSplit {
  double correctable_um = 0;      ///< correctable by a shift within the limits
  double correctable_p95_um = 0;  ///< 95th percentile of its magnitude
  double correctable_max_um = 0;
  double guard_um = 0;            ///< given up by the guard to keep the depth limit
  double bounded_um = 0;          ///< given up so that no place becomes worse than given
  double limited_um = 0;          ///< needs a shift over max_shift_mm
  double short_range_um = 0;      ///< changes along the path faster than a smooth path can
  double opposed_um = 0;          ///< opposite surfaces generated at one path position (a slot)
  double tip_um = 0;              ///< near the axis of a round tip
  double bow_um = 0;              ///< varies along the cutter profile at one path position: helix bow
  double not_compensated_um = 0;  ///< due to moves that are not compensated

  double not_correctable_um() const;  ///< short_range, opposed, tip and bow together

  /// Decomposition of a surface that the guard has lifted: correctable error beyond that of the best program without
  /// the guard was given up.
  void give_to_guard(double free_correctable_um);
};

/// The observations' errors less the form that their rows have across (compensate/row_form), for a fit.
std::vector<Observation> without_row_form(const ShiftPath& path, std::span<const Observation> observations,
                                          const FitShiftOptions& options);

/// Returns the error that the best smooth shift within the limit would leave at each observation, mm.
std::vector<double> left_by_shift_mm(const ShiftPath& path, std::span<const Observation> observations,
                                     const FitShiftOptions& options);

/// Cause of a part of an error; ErrorSplit has the meanings.
enum class Cause { correctable, guard, bounded, limited, short_range, opposed, tip, bow, not_compensated };

/// The error point by point, one per entry of Observed: which cause most of it has, and how much that is.
struct PointCause {
  Cause cause = Cause::correctable;
  double error_mm = 0;
};

/// `causes`: null: not needed. The guard's part has no points of its own: they count as correctable.
ErrorSplit split_error(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options,
                       std::vector<PointCause>* causes = nullptr);

/// The depth limit where a job gives none, um: `tolerance_um`, or a quarter more than the gouge depth of 99.9 % of the
/// surface if every place of the path had the shift that suits it best. A bow of +-7 um across a wall cannot be kept
/// within 5 um without giving up half of the correction. `observed`: of the given program.
double default_depth_limit_um(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options,
                              double tolerance_um);

/// Depth that no more than a thousandth of `area_mm2` exceeds.
double depth_p999(std::vector<removal::ValueOfArea> depths, double area_mm2);

}  // namespace camber::compensate
