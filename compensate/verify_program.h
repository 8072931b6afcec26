#pragma once
// Judging an emitted program again from its text: the record beside it, the job with which predict judges it, and the
// verdict.
#include <cstddef>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/compensate_path.h"
#include "machine/job_file.h"
#include "simulate/setup.h"

namespace camber::compensate {

/// `count` lines of the emitted program, from `emitted` on, correspond to as many of the given one, from `given` on.
/// Lines count from 1.
struct LineRun {
  std::size_t emitted = 0, given = 0, count = 0;
};

/// Data needed to judge an emitted program as compensate did.
struct Record {
  std::string program, program_hash;  ///< file name beside the record; hash of its text
  std::string given, given_hash;      ///< path of the given program, from the record's folder
  std::string job;                    ///< TOML; paths are relative to the record's folder
  double depth_limit_um = 0;
  removal::ErrorFigures judged_um;  ///< error that compensate found
  std::vector<LineRun> lines;       ///< ascending; lines that are in none of them are new
};

/// "OUT.nc.record.json".
std::string record_path(const std::string& program);

/// Returns the record of the program that was written to `output`; `job`: that it was made with.
Record make_record(const machine::Job& job, const CompensationResult& result, const std::string& output);

/// Convert the record to JSON and back. read_record throws InputError [record-format].
std::string record_json(const Record& record);
Record read_record(const std::string& path);

/// The job with which predict judges the program: it is the program, the given program (or what that was judged
/// against) is the target, ranges of lines are those of the emitted program, and where not all simulated moves were
/// compensated, only the surface of those that were is judged.
machine::Job judging_job(const machine::Job& job, const CompensationResult& result, const std::string& output);

/// Finds the record of an earlier run: `place` is its folder or the emitted program. Throws InputError
/// [file-missing], [record-missing], [record-several].
std::string find_record(const std::string& place);

/// Throws InputError [program-edited] if the emitted or the given program has changed since the record was written.
void check_record(const Record& record, const std::string& record_path);

struct Verification {
  PlainFigures plain;
  machine::Reference reference = machine::Reference::commanded;
  bool within_tolerance = false, within_part = true, settled = true;
  Depth depth;
  double depth_limit_um = 0;
  double unseen_mm2 = 0, border_mm2 = 0, not_judged_mm2 = 0;
  bool between = false;
  removal::ErrorFigures recorded_um;  ///< error that compensate found
  std::vector<std::string> doubts;    ///< reasons why the figures are not reliable (simulate/verdict.h)
  double machine_time_s = 0;
};

/// Predicts the job's program; the verdict is on all of its surface. Throws InputError and BeyondModel.
Verification verify(const machine::Job& job, const Record& record, Diagnostics& diagnostics,
                    const simulate::Progress& progress);

}  // namespace camber::compensate
