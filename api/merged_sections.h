#pragma once
// The work of camber merge: the parts of a prediction in sections, joined.
#include <string>
#include <vector>

#include "api/prediction.h"
#include "base/diagnostics.h"
#include "distribute/section_run.h"
#include "machine/job_file.h"

namespace camber::api {

/// Joins all parts of the sweep and of a round, of which one is in memory at a time, and writes the files of a
/// prediction. `options`: its folder, and rows. `programs`: see PredictionWork. Throws InputError where a part is
/// missing or not like the others: nothing is merged then.
PredictResult merge_parts(const machine::Job& job, const distribute::PartKey& key, int round,
                          distribute::PartStore& store, const PredictOptions& options,
                          std::shared_ptr<simulate::ReadPrograms> programs, Run& run);

}  // namespace camber::api
