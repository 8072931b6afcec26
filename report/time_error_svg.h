#pragma once
// Machine time against error, as a picture that needs no script.
#include <string>

#include "compensate/compensate.h"

namespace camber::report {

/// The 95th percentile of every predicted round over its machine time, small; the best program for each time allowed
/// joined by a line, filled where runs are cut twice; the emitted program marked; a dashed line at `tolerance_um`.
/// Rounds whose error is far above those of the times (the given program's, as a rule) are left out. Empty where the
/// compensation had no lever that takes time.
std::string time_error_svg(const compensate::CompensationResult& c, double tolerance_um);

}  // namespace camber::report
