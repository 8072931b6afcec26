#pragma once
// An error apart: what a shift of the path can take away, what none can, and what a limit holds back.
#include <span>
#include <vector>

#include "compensate/attribution.h"
#include "compensate/fit_shift.h"
#include "compensate/shift_path.h"

namespace camber::compensate {

/// Root mean squares over the whole surface, um: squares add up to the error's,
///
///   rms^2 = correctable^2 + guard^2 + limited^2 + short_range^2 + opposed^2 + tip^2 + bow^2 + not_compensated^2
///
/// The parts come from least squares of the error against shifts of the path, each one with less freedom:
/// any shift at every point of the path; then smooth along the path; then within the largest shift. The shifts are
/// fitted to the error less the form across the rows, so that they do not follow where the grid shows a row.
struct ErrorSplit {
  double correctable_um = 0;      ///< a shift within the limits takes it away
  double correctable_p95_um = 0;  ///< 95th percentile of its magnitude
  double correctable_max_um = 0;
  double guard_um = 0;            ///< given up by the guard, so as not to cut into the part
  double limited_um = 0;          ///< a shift over max_shift_mm would take it away
  double short_range_um = 0;      ///< changes along the path in less than a smooth path can
  double opposed_um = 0;          ///< surfaces that face each other, made at one place (a slot)
  double tip_um = 0;              ///< about the axis of a round tip
  double bow_um = 0;              ///< changes along the cutter's profile where the cutter is at one place: helix bow
  double not_compensated_um = 0;  ///< made by moves that are not compensated

  double not_correctable_um() const;  ///< short_range, opposed, tip and bow together

  /// Of a surface that the guard has lifted: what is left beyond that of the best program without it was given up.
  void give_to_guard(double free_correctable_um);
};

/// The observations' errors less the form that their rows have across (compensate/row_form), for a fit.
std::vector<Observation> without_row_form(const ShiftPath& path, std::span<const Observation> observations,
                                          const FitShiftOptions& options);

ErrorSplit split_error(const ShiftPath& path, const Observed& observed, const FitShiftOptions& options);

}  // namespace camber::compensate
