#pragma once
// The work of camber study: the cases of a grid, each a folder with a job of its own, and their table.
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "machine/job_file.h"
#include "machine/study_file.h"
#include "report/study_table.h"

namespace camber::api {

/// A case, ready for its command.
///
/// Its folder is named after a hash of all that the result depends on: version, command, job and the contents of the
/// files that the job reads. A case is done when its folder has the command's results, whoever ran the command.
struct PlannedCase {
  machine::StudyCase values;
  std::string hash;
  std::string folder;       ///< holds job.toml and, with other feeds, program.nc
  std::string job_path;     ///< job.toml
  std::string output;       ///< output of the command: a folder (predict) or a program
  std::string report_path;  ///< report.html
  std::string json_path;    ///< summary.json
  bool done() const;
};

struct StudyPlan {
  machine::Study study;
  std::string folder;  ///< folder of the whole study
  std::vector<PlannedCase> cases;
};

/// Reads a study, writes the job of every case into `folder`, and reads them all: a wrong value is found before the
/// first case runs. Throws InputError.
StudyPlan plan_study(const std::string& path, const std::string& folder, Diagnostics& diagnostics);

/// The command line of a case, for a shell.
std::string command_line(const StudyPlan& plan, const PlannedCase& one);

/// The rows of the cases that are finished so far.
report::StudyTable study_table(const StudyPlan& plan);

/// study.csv, study.json and study.html in the study's folder.
void write_study(const StudyPlan& plan, const report::StudyTable& table);

}  // namespace camber::api
