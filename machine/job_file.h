#pragma once
// A job: program, machine, tools, material, stock and settings. Read from job.toml.
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/adapt_settings.h"
#include "machine/compensation_settings.h"
#include "machine/features.h"
#include "machine/machine_model.h"
#include "machine/material.h"
#include "machine/simulation_settings.h"
#include "machine/tool.h"
#include "machine/workpiece.h"

namespace camber::machine {

struct Job {
  std::string path;
  std::string program;  ///< paths are resolved against the job's folder
  std::string machine_path;
  Machine machine;
  std::optional<bool> inch;  ///< unit of a program without G20/G21: `units = "inch"` or "mm"
  Operations operations;
  std::map<int, Tool> tools;
  Material material;
  StockDescription stock;
  PartDescription part;
  Simulation simulation;
  /// An error without a message where voxel_mm stands, or else [stock]: what is said of memory points there.
  Diagnostic voxel_place;
  CompensationSettings compensation;
  std::optional<AdaptSettings> adapt{};
  std::vector<Feature> features{};  ///< that predict and compensate evaluate
  std::optional<ModelError> model_error{};
  std::vector<Mode> workpiece_modes{};   ///< modes of the work on its table; empty: it is rigid
  std::optional<Workpiece> workpiece{};  ///< not given: rigid
};

/// Reads the job and its machine file. Throws InputError with file:line:column.
Job read_job(const std::string& path, Diagnostics& diagnostics);

/// Reads a job as read_job does, but the program may be missing, in its folder and in the job.
Job read_unprogrammed_job(const std::string& path, Diagnostics& diagnostics);

/// A job, and its programs in their order, one or more; `job.program` is the first. read_job refuses jobs of several
/// programs [several-programs].
struct JobOfPrograms {
  Job job;
  std::vector<std::string> programs;
};

/// Reads a job as read_job does, with one or several programs. Also [program-list], and [several-programs] for keys
/// that belong to one program alone (lines of operations, a target program).
JobOfPrograms read_job_of_programs(const std::string& path, Diagnostics& diagnostics);

/// Text of a job.toml with all defaults filled in and resolved paths.
std::string to_toml(const Job& job);

}  // namespace camber::machine
