#include "api/commands/compensate.h"

#include <filesystem>
#include <optional>

#include "base/output_file.h"
#include "compensate/header.h"
#include "compensate/measured.h"
#include "compensate/recheck.h"
#include "compensate/verify.h"
#include "feedmodel/fitted_range.h"
#include "machine/compensation_settings.h"
#include "nc/interpreter.h"
#include "simulate/rotary_motion.h"

namespace camber::api {
namespace {

nc::Interpretation moves_of(SourceText source, const machine::Job& job) {
  Diagnostics ignored;  // said already
  const auto text = nc::read_program(std::move(source), ignored);
  return nc::interpret(text, simulate::interpreter_options(job, simulate::names_rotary_axes(job.machine, text)),
                       ignored);
}

/// The job as it was measured; the fit goes to `fit`.
machine::Job as_measured(const machine::Job& job, const CompensateRequest& request, Diagnostics& diagnostics,
                         const simulate::Progress& progress, std::optional<compensate::MeasuredFit>& fit) {
  if (request.measured.empty()) return job;
  const auto points = compensate::read_measured(request.measured);
  fit = compensate::fit_measured(job, request.measured, points, request.measured_program, diagnostics, progress);
  return compensate::softened(job, fit->scale);
}

std::string header_of(const machine::Job& job, const compensate::CompensationResult& c, bool hash) {
  const std::string lines = compensate::header_lines(job, c, CAMBER_VERSION);
  return hash ? lines + "\nINPUTS " + compensate::hash_of_inputs(job) : lines;
}

/// The job with the levers of the request. Throws InputError.
machine::Job with_levers(const machine::Job& job, const std::vector<std::string>& names, Diagnostics& diagnostics) {
  machine::Job out = job;
  if (names.empty()) return out;
  const machine::LeverNames read = machine::levers_of(names);
  for (const std::string& message : read.errors)
    diagnostics.add({Severity::error, {job.path, 0, 0}, "--levers: " + message, "value-choice", {}});
  diagnostics.throw_if_errors();
  out.compensation.levers = read.levers;
  return out;
}

compensate::CompensateOptions options_of(const CompensateRequest& request) {
  compensate::CompensateOptions options;
  options.progress = request.progress;
  options.outlook = request.outlook;
  for (const auto& u : request.uncertainty)
    for (auto& group : compensate::read_uncertainty(u)) options.uncertainty.push_back(std::move(group));
  options.max_stock_crossings = request.max_stock_crossings;
  options.time_budget_percent = request.time_budget_percent;
  options.keep_anyway = request.keep_anyway;
  options.recheck_voxels_mm = request.check_voxels_mm;
  return options;
}

}  // namespace

CompensatedJob compensate_job(const machine::Job& given, const CompensateRequest& request, Diagnostics& diagnostics) {
  compensate::CompensateOptions options = options_of(request);
  std::optional<compensate::MeasuredFit> fit;
  CompensatedJob out{
      as_measured(with_levers(given, request.levers, diagnostics), request, diagnostics, options.progress, fit), {}};
  const machine::Job& job = out.job;
  if (request.header || request.header_hash)
    options.header = [&](const auto& c) { return header_of(job, c, request.header_hash); };
  out.result = compensate::compensate(job, diagnostics, options);
  out.result.measured = fit;
  feedmodel::check_range(moves_of(SourceText::read(job.program), job), job.program, job.machine, diagnostics);
  return out;
}

void write_compensated(const std::string& path, const machine::Job& job, const compensate::CompensationResult& result) {
  write_file(path, result.text);
  std::error_code ec;
  if (!std::filesystem::is_regular_file(path, ec)) return;
  write_file(compensate::record_path(path), compensate::record_json(compensate::make_record(job, result, path)));
}

}  // namespace camber::api
