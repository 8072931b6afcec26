#pragma once
// Frequency responses of tap tests: files of them, and what they measure.
#include <complex>
#include <string>
#include <vector>

namespace camber::dynamics {

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

}  // namespace camber::dynamics
