#pragma once
// Frequency responses in universal files (data sets 58 and 164).
#include "base/diagnostics.h"
#include "dynamics/frequency_response.h"

namespace camber::dynamics {

/// See read_frequency_response.
FrequencyResponse read_universal_file(const SourceText& source);

}  // namespace camber::dynamics
