#pragma once
// The work of camber adapt.
#include "adapt/adapt.h"
#include "base/diagnostics.h"
#include "machine/job_file.h"

namespace camber::api {

/// Throws InputError. Writes nothing.
adapt::AdaptResult adapt_job(const machine::Job& job, const adapt::AdaptOptions& options, Diagnostics& diagnostics);

}  // namespace camber::api
