#pragma once
// How the form error is spread over the surface, as a picture that needs no script.
#include <array>
#include <string>
#include <vector>

#include "compensate/compensate_path.h"
#include "report/surface_samples.h"

namespace camber::report {

/// Per cent of the area in each of `bins` from -limit to limit; what lies beyond is in the first and the last.
std::vector<double> error_histogram(const SurfaceSamples& samples, double SurfaceSample::*error, double limit_um,
                                    int bins);

/// Bars of the error; with `compared` error_um in grey and error_after_um in blue on one axis, named by `names`.
std::string histogram_svg(const SurfaceSamples& samples, bool compared, double limit_um,
                          const std::array<std::string, 2>& names = {"before", "after"});

// Machine time against error, as a picture that needs no script.

/// The 95th percentile of every predicted round over its machine time, small; the best program for each time allowed
/// joined by a line, filled where runs are cut twice; the emitted program marked; a dashed line at `tolerance_um`.
/// Rounds whose error is far above those of the times (the given program's, as a rule) are left out. Empty where the
/// compensation had no lever that takes time.
std::string time_error_svg(const compensate::CompensationResult& c, double tolerance_um);

}  // namespace camber::report
