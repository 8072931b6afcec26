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
#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace camber::dynamics {

// Frequency responses of tap tests: files of them, and what they measure.

/// The measured quantity per force. With s = 2 pi i f it is a receptance times 1, s or s^2.
enum class ResponseKind { receptance, mobility, accelerance };

struct FrequencyResponse {
  std::string path;
  ResponseKind kind = ResponseKind::receptance;
  std::vector<double> hz;                   ///< ascending
  std::vector<std::complex<double>> value;  ///< mm/N, mm/s/N or mm/s2/N
};

/// s^0, s or s^2 at a frequency.
std::complex<double> response_factor(ResponseKind kind, double hz);

/// Reads a CSV or, of a file whose first line is -1, a universal file.
///
/// CSV: a header with frequency_Hz and either re_UNIT, im_UNIT or magnitude_UNIT, phase_deg (or phase_rad); UNIT is
/// m_per_N, mm_per_N, um_per_N, m_per_s_per_N, mm_per_s_per_N, m_per_s2_per_N, mm_per_s2_per_N or g_per_N.
///
/// Universal file: data set 58 in text, a frequency response (function type 4) of displacement, velocity or
/// acceleration over force, even or uneven spacing, real numbers excepted; units from data set 164, or SI. Of several
/// responses the one at the point and in the direction of the tap is taken; two such are an error. Source of the
/// format: Universal File Formats for Modal Analysis Testing, SDRC, University of Cincinnati.
///
/// Throws InputError [response-file], [response-header], [response-value], [response-count].
FrequencyResponse read_frequency_response(const std::string& path);

// Poles of a frequency response: a rational fraction in partial fractions whose poles are moved until they fit.

/// `pairs` complex pole pairs of sum of residues / (s - pole) + d + e / s^2, those with the positive imaginary part,
/// rad/s. `value` a receptance, `weight` of each point; frequencies above zero.
/// Source: Gustavsen, Semlyen 1999 (see fit_modes.h).
std::vector<std::complex<double>> fitted_poles(std::span<const double> hz, std::span<const std::complex<double>> value,
                                               std::span<const double> weight, int pairs);

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
