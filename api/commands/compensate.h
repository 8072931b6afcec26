#pragma once
// The work of camber compensate: a job, as it was measured where points are given, compensated.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/compensate.h"
#include "machine/job_file.h"

namespace camber::api {

struct CompensateRequest {
  std::vector<std::string> uncertainty;    ///< files or percentages
  std::string measured, measured_program;  ///< files; empty: none
  std::vector<double> check_voxels_mm;
  std::optional<double> time_budget_percent{};  ///< machine time for the feed lever
  bool keep_anyway = false;  ///< emit the round with the smallest error even if none is better than the given program
  bool header = false, header_hash = false;
  std::size_t max_stock_crossings = 0;  ///< see compensate::CompensateOptions
  std::vector<std::string> levers{};    ///< by name, instead of the job's; empty: the job's
  simulate::Progress progress;
  std::function<void(const compensate::Outlook&)> outlook{};  ///< see compensate::CompensateOptions
};

struct CompensatedJob {
  machine::Job job;  ///< what was compensated: the given one, or as it was measured
  compensate::CompensationResult result;
};

/// Throws InputError and BeyondModel. Writes nothing.
CompensatedJob compensate_job(const machine::Job& given, const CompensateRequest& request, Diagnostics& diagnostics);

/// The emitted program, and beside it the record by which it can be judged again; a pipe has nothing beside it.
void write_compensated(const std::string& path, const machine::Job& job, const compensate::CompensationResult& result);

}  // namespace camber::api
