#pragma once
// How the form error is spread over the surface, as a picture that needs no script.
#include <array>
#include <string>
#include <vector>

#include "report/surface_samples.h"

namespace camber::report {

/// Per cent of the area in each of `bins` from -limit to limit; what lies beyond is in the first and the last.
std::vector<double> error_histogram(const SurfaceSamples& samples, double SurfaceSample::*error, double limit_um,
                                    int bins);

/// Bars of the error; with `compared` error_um in grey and error_after_um in blue on one axis, named by `names`.
std::string histogram_svg(const SurfaceSamples& samples, bool compared, double limit_um,
                          const std::array<std::string, 2>& names = {"before", "after"});

}  // namespace camber::report
