#include "camber/fit_parts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "api/job.h"
#include "api/run.h"
#include "calib/parts_fit.h"
#include "report/fit_summary.h"

namespace camber {
namespace {

/// Names of --hold-out that are neither a job nor a part.
void check_hold_out(const std::vector<machine::Job>& jobs, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    bool known = false;
    for (const machine::Job& job : jobs) {
      known = known || calib::job_name(job) == name;
      for (const machine::Feature& f : job.features)
        for (const machine::MeasuredValue& v : f.measured) known = known || v.part == name;
    }
    if (!known)
      fail_on_file("--hold-out " + name,
                   "no job and no measured part has this name; the name of a job's file without "
                   "folder and ending, or of a part, was expected",
                   "hold-out");
  }
}

}  // namespace

FitPartsResult v0::fit_parts(const std::vector<Job>& jobs, const FitPartsOptions& options,
                             const RunOptions& run_options) {
  FitPartsResult out;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found;
    std::vector<machine::Job> given;
    std::vector<std::string> names;
    for (const Job& job : jobs) {
      given.push_back(api::programmed(job));
      names.push_back(job.path());
      found.append(job.impl().found);
    }
    run.settle_first(found);
    check_hold_out(given, options.hold_out);
    calib::FitPartsOptions how;
    how.hold_out = options.hold_out;
    how.progress = run.progress();
    const calib::FitPartsResult fit = calib::fit_parts(given, how);
    for (const calib::PartsParameter& p : fit.parameters)
      out.parameters.push_back({p.name, p.unit, p.value, p.start, p.std_error, p.note});
    out.rms_um = fit.rms_um;
    out.converged = fit.converged;
    out.message = fit.message;
    out.files = report::fit_parts_files(fit, names);
    out.diagnostics = found.all();
    out.json = report::fit_parts_json(fit);
    out.printed = report::fit_parts_text(fit, options.suggest);
  });
  return out;
}

}  // namespace camber
