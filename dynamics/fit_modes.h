#pragma once
// Modes from a measured frequency response.
//
// Model, a receptance times s^0, s or s^2:  H = sum of 1 / (k (1 - r^2 + 2 i zeta r)) + a + b / s^2,  r = f / f_m,
// with the answer of higher modes (a) and of rigid motion (b) where they explain the response better.
// Start: a rational fraction by relocation of its poles (Gustavsen, Semlyen, Rational approximation of frequency domain
// responses by vector fitting, IEEE Trans. Power Delivery 14 (1999) 1052-1061). Then least squares in the modes'
// own parameters (Levenberg, Marquardt). Points are weighted by their noise, a part of the value and a part of the
// peak, which the differences of neighbours show. The number of modes is that with the least Bayesian information
// criterion.
#include <optional>

#include "dynamics/frequency_response.h"

namespace camber::dynamics {

struct FitModesOptions {
  std::optional<int> modes;       ///< not given: up to kMostModes, by the criterion
  double from_hz = 0, to_hz = 0;  ///< band of the fit; 0: all
};
inline constexpr int kMostModes = 8;

/// A value with its standard error.
struct Fitted {
  double value = 0, error = 0;
};

struct FittedMode {
  Fitted frequency_hz, damping_ratio, stiffness_N_per_mm;
};

struct ModeFit {
  std::vector<FittedMode> modes;   ///< ascending by frequency; empty: nothing was found that is a mode
  double residual_mm_per_N = 0;    ///< a
  double inertia_mm_per_N_s2 = 0;  ///< b
  double noise_of_value = 0, noise_of_peak = 0;
  double misfit = 0;  ///< rms of (fit - measured) over the noise; near 1 the model explains the response
  std::vector<std::complex<double>> fitted;  ///< at the response's frequencies, in its unit
};

ModeFit fit_modes(const FrequencyResponse& response, const FitModesOptions& options = {});

}  // namespace camber::dynamics
