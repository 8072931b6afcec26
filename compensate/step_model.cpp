#include "compensate/step_model.h"

#include <algorithm>
#include <cmath>

namespace camber::compensate {

void StepModel::learn(double rms_um, const ErrorSplit& split, double fraction, double new_rms_um) {
  const double correctable = split.correctable_um * split.correctable_um;
  if (correctable <= 0 || fraction <= 0) return;
  const double change = new_rms_um * new_rms_um - rms_um * rms_um;
  curvature_ = std::max(1.0, (change / correctable + 2 * fraction) / (fraction * fraction));
}

double StepModel::best_fraction(double greatest) const { return std::min(greatest, 1 / curvature_); }

double StepModel::effect(double fraction) const {
  return std::clamp(2 * fraction - curvature_ * fraction * fraction, 0.0, 1.0);
}

double StepModel::expected_rms_um(double rms_um, const ErrorSplit& split, double fraction) const {
  const double correctable = split.correctable_um * split.correctable_um;
  return std::sqrt(std::max(0.0, rms_um * rms_um - effect(fraction) * correctable));
}

}  // namespace camber::compensate
