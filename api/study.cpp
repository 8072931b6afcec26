#include "camber/study.h"

#include "api/commands/study.h"

namespace camber {

Study v0::open_study(const std::string& path, const std::string& folder) {
  Diagnostics found;
  const api::StudyPlan plan = api::plan_study(path, folder, found);
  const report::StudyTable table = api::study_table(plan);
  Study out{.command = table.command,
            .keys = table.keys,
            .diagnostics = found.all(),
            .csv = report::study_csv(table),
            .json = report::study_json(table),
            .page = report::study_page(table)};
  for (std::size_t i = 0; i < plan.cases.size(); ++i) {
    const api::PlannedCase& one = plan.cases[i];
    out.cases.push_back({.hash = one.hash,
                         .job_path = one.job_path,
                         .folder = one.folder,
                         .output = one.output == one.folder ? "" : one.output,
                         .report = one.report_path,
                         .json = one.json_path,
                         .values = table.rows[i].values,
                         .done = one.done()});
  }
  return out;
}

}  // namespace camber
