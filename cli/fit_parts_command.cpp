#include "cli/fit_parts_command.h"

#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/output_file.h"
#include "calib/fit_parts.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "machine/force_law.h"
#include "machine/material_reader.h"
#include "report/fit_parts_report.h"

namespace camber::cli {
namespace {

std::vector<machine::Job> read_jobs(const std::vector<std::string>& paths, const GlobalOptions& options) {
  std::vector<machine::Job> out;
  for (const std::string& path : paths) {
    Diagnostics diagnostics;
    out.push_back(machine::read_job(path, diagnostics));
    settle(diagnostics, options);
  }
  return out;
}

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

constexpr const char* kFiles[] = {"machine.toml", "tools.toml", "material.toml", "report.html"};

/// What the jobs read is not written over.
void check_files(const std::vector<machine::Job>& jobs, const std::string& folder) {
  std::error_code ec;
  for (const machine::Job& job : jobs)
    for (const std::string& input : {job.path, job.machine_path, job.program})
      for (const char* name : kFiles) {
        const std::filesystem::path output = std::filesystem::path(folder) / name;
        if (std::filesystem::equivalent(output, input, ec))
          fail_on_file(output.string(), "is an input of a job; another folder was expected", "output-is-input");
      }
}

void write_results(const FitPartsArguments& arguments, const calib::FitPartsResult& result) {
  namespace fs = std::filesystem;
  const fs::path folder = arguments.folder;
  make_folder(arguments.folder);
  const std::string head = fmt::format("# Fitted by camber fit-parts to {}; residual {:.3g} um rms.\n",
                                       fmt::join(arguments.jobs, ", "), result.rms_um);
  const auto of_machine = [](const std::string& n) { return n.starts_with("axis."); };
  const auto of_tools = [](const std::string& n) { return n.starts_with("tool."); };
  const auto of_material = [](const std::string& n) { return machine::find_coefficient(n) != nullptr; };
  const machine::Job& first = result.jobs.front();
  write_file(folder / "machine.toml",
             head + report::parameter_comments(result, of_machine) + machine::to_toml(first.machine));
  write_file(folder / "tools.toml",
             head + report::parameter_comments(result, of_tools) +
                 fmt::format("# For the job, what the fit leaves uncertain:\n# [model_error]\n"
                             "# deflection_percent = {:.3g}\n# contour_percent = {:.3g}\n"
                             "# size_um = {:.3g}\n",
                             100 * result.error.deflection, 100 * result.error.contour, 1000 * result.error.size_mm) +
                 report::fitted_tools_toml(result));
  write_file(folder / "material.toml", head + report::parameter_comments(result, of_material) + "[material]\n" +
                                           machine::material_text(first.material));
  write_file(folder / "report.html", report::fit_parts_page(result));
}

}  // namespace

int run_fit_parts(const FitPartsArguments& arguments, const GlobalOptions& options) {
  const std::vector<machine::Job> jobs = read_jobs(arguments.jobs, options);
  check_hold_out(jobs, arguments.hold_out);
  check_files(jobs, arguments.folder);
  ProgressLine progress(options, "predicting");
  calib::FitPartsOptions fit;
  fit.hold_out = arguments.hold_out;
  fit.progress = [&](const std::string& what, double share) { progress.show(what, share); };
  const calib::FitPartsResult result = calib::fit_parts(jobs, fit);
  progress.clear();
  if (!options.quiet) fmt::print("{}", report::fit_parts_text(result, arguments.suggest));
  write_results(arguments, result);
  if (!arguments.json.empty()) write_file(arguments.json, report::fit_parts_json(result));
  if (!result.converged) print_error(result.message);
  return result.converged ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
