#pragma once
// A measured frequency response and its fit, as a picture.
#include <string>

#include "dynamics/fit_modes.h"

namespace camber::report {

/// Magnitudes over the frequency: measured grey, fitted blue.
std::string response_svg(const dynamics::FrequencyResponse& response, const dynamics::ModeFit& fit);

}  // namespace camber::report
