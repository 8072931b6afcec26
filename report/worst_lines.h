#pragma once
// The lines of a program whose surface is worst.
#include <string_view>

#include "report/html_report.h"

namespace camber::report {

/// The ten lines with the greatest root mean square of the form error over the surface that they left, weighted by
/// area, the worst first; lines that left less than a thousandth of the whole surface are passed over. `after`: of the
/// emitted program's error. No rows where no line is known.
TextTable worst_lines_table(const SurfaceSamples& surface, std::string_view program_text, bool after);

}  // namespace camber::report
