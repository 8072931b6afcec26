#pragma once
// What compensation could and could not do, as tables of text.
#include <vector>

#include "compensate/compensate.h"
#include "report/html_report.h"

namespace camber::report {

/// Error decomposition; the depth into the part; the second prediction and the band, where they were asked for.
std::vector<TextTable> compensation_tables(const compensate::CompensationResult& result);

}  // namespace camber::report
