#pragma once
// Speed against chord length, both on logarithmic axes: where a control is saturated, the points lie on V = L / T_b.
#include <string>

#include "calib/block_time.h"

namespace camber::report {

/// A whole SVG file.
std::string block_time_svg(const calib::BlockTimeFit& fit);

}  // namespace camber::report
