#pragma once
// Expected gain of another round of shifts: mean square m - (2 t - c t^2) R after the fraction t of a step.
#include "compensate/error_split.h"

namespace camber::compensate {

/// The mean square m of the error against the fraction t of a fitted step:
///
///   m(t) = m - (2 t - c t^2) R
///
/// with R the mean square that shifts can correct (ErrorSplit::correctable_um, squared). With c = 1 the errors follow
/// the shifts as the fit has it; a round shows the c that they have in truth. The slope at t = 0 is that of the fit.
class StepModel {
 public:
  /// A step of the fraction `fraction` changed an error of `rms_um`, which could be corrected as `split` says, to
  /// `new_rms_um`. Where nothing could be corrected, c stays.
  void learn(double rms_um, const ErrorSplit& split, double fraction, double new_rms_um);

  /// Fraction at which m(t) is least; not over `greatest`.
  double best_fraction(double greatest) const;
  /// 2 t - c t^2: how much of R a step takes away; from 0 to 1.
  double effect(double fraction) const;
  /// sqrt(m(t)).
  double expected_rms_um(double rms_um, const ErrorSplit& split, double fraction) const;

 private:
  double curvature_ = 1;
};

}  // namespace camber::compensate
