#pragma once
// The work of camber merge: the parts of a prediction in sections, joined.
#include <string>
#include <vector>

#include "api/commands/predict.h"
#include "base/diagnostics.h"
#include "distribute/section_run.h"
#include "machine/job.h"

namespace camber::api {

/// How the pieces of a path were joined.
struct SectionFigures {
  std::size_t pieces = 0, rounds = 1;
  std::vector<std::size_t> solved_again{};  ///< pieces, of each round from the second on
  std::vector<double> largest_change_um{};  ///< largest change of the stock before a piece, likewise
};
/// summary.json of a prediction with them.
std::string with_sections(const std::string& json, const SectionFigures& figures);

/// A prediction joined from parts.
struct MergedJob {
  PreparedJob prepared;
  simulate::Prediction prediction;
  SectionFigures figures;
  std::string doubt;  ///< about static coupling; empty: none
};
/// Joins all parts of the sweep and of a round, of which one is in memory at a time. `request`: as for a prediction;
/// its `work` is not looked at. `found`: what should be shown before. Throws InputError where a part is missing or not
/// like the others: nothing is merged then.
MergedJob merge_parts(const machine::Job& job, const distribute::PartKey& key, int round, distribute::PartStore& store,
                      const PredictRequest& request, Diagnostics& found, Diagnostics& of_cut);

}  // namespace camber::api
