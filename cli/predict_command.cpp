#include "cli/predict_command.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "api/commands/predict.h"
#include "api/commands/program_sequence.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "machine/job_file.h"
#include "report/feature_results.h"
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

/// `diagnostics`: of the job. `result`: the figures as JSON.
int predict_program(const machine::Job& job, Diagnostics diagnostics, const PredictArguments& arguments,
                    const GlobalOptions& options, std::string& result) {
  const auto begin = std::chrono::steady_clock::now();
  ProgressLine progress(options, "reading");
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
  const std::vector<std::string> assumed = machine::assumptions(job);
  const auto features = report::features_of(job, prediction.surface);
  const std::string& json = result = machine::with_assumptions(
      report::with_features(report::predict_json(program, prediction, compute_s, prepared.traced_run(), wrong),
                            {{"features", features}}),
      assumed);
  api::write_prediction(job, prepared, prediction, request, json, diagnostics, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  progress.clear();

  if (!options.quiet)
    fmt::print("{}{}{}", machine::assumptions_text(assumed),
               report::predict_text(program, prediction, compute_s, prepared.traced_run()),
               report::features_text(features));
  failed.throw_if_errors();
  settle(of_cut, options);
  for (const std::string& sentence : wrong) print_error(sentence);
  return wrong.empty() ? kDone : kNumbersDidNotWorkOut;
}

/// Each program on what the one before has left, each in a folder of its own.
int predict_in_turn(const machine::JobOfPrograms& all, const Diagnostics& diagnostics,
                    const PredictArguments& arguments, const GlobalOptions& options) {
  if (!arguments.trace.empty() || arguments.forces_at > 0) {
    print_error("--trace and --forces-at belong to one program, and the job has several");
    return kCommandLineWrong;
  }
  int status = kDone;
  std::string stock;
  std::vector<std::string> results, folders;
  for (std::size_t i = 0; i < all.programs.size(); ++i) {
    PredictArguments one = arguments;
    one.output_folder += "/" + api::name_of_program(all.programs, i);
    one.json.clear();
    if (!options.quiet) fmt::print("{}{}\n", i > 0 ? "\n" : "", all.programs[i]);
    const int own = predict_program(api::job_of_program(all, i, stock), i == 0 ? diagnostics : Diagnostics(), one,
                                    options, results.emplace_back());
    status = std::max(status, own);
    stock = one.output_folder + "/stock.vdb";
    folders.push_back(one.output_folder);
  }
  const std::string json = api::join_results(all, results, folders);
  write_file(arguments.output_folder + "/summary.json", json);
  if (!arguments.json.empty()) write_file(arguments.json, json);
  return status;
}

}  // namespace

int run_predict(const PredictArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::JobOfPrograms all = machine::read_job_of_programs(arguments.job, diagnostics);
  if (all.programs.size() > 1) return predict_in_turn(all, diagnostics, arguments, options);
  std::string json;
  return predict_program(all.job, std::move(diagnostics), arguments, options, json);
}

}  // namespace camber::cli
