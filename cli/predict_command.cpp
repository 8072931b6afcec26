#include "cli/predict_command.h"

#include <chrono>

#include <fmt/format.h>

#include "api/commands/predict.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "report/summary.h"

namespace camber::cli {
namespace {

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

api::StepProgress steps_of(ProgressLine& progress) {
  return [&progress](const std::string& what, std::optional<double> fraction) {
    fraction ? progress.show(what, *fraction) : progress.show(what);
  };
}

}  // namespace

int run_predict(const PredictArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  const api::PredictRequest request{.folder = arguments.output_folder,
                                    .forces_at = arguments.forces_at,
                                    .trace = arguments.trace,
                                    .columns = arguments.columns,
                                    .meshes = arguments.meshes,
                                    .progress = steps_of(progress)};
  api::PreparedJob prepared = api::prepare(job, request, diagnostics);
  const simulate::SimulatedProgram& program = prepared.setup.program;
  progress.clear();
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  make_folder(arguments.output_folder);

  Diagnostics of_cut;
  auto prediction = api::predict_prepared(job, prepared, request, of_cut);
  diagnostics.append(of_cut);
  const double compute_s = seconds_since(begin);
  Diagnostics failed;
  const std::vector<std::string> wrong = api::doubts_of(job, program, prediction);
  const std::string json = report::predict_json(program, prediction, compute_s, prepared.traced_run(), wrong);
  api::write_prediction(job, prepared, prediction, request, json, diagnostics, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  progress.clear();

  if (!options.quiet) fmt::print("{}", report::predict_text(program, prediction, compute_s, prepared.traced_run()));
  failed.throw_if_errors();
  settle(of_cut, options);
  for (const std::string& sentence : wrong) print_error(sentence);
  return wrong.empty() ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
