#include "cli/compensate_command.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "api/commands/compensate.h"
#include "api/commands/program_sequence.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/rounds_progress.h"
#include "compensate/trial.h"
#include "machine/assumptions.h"
#include "machine/job_file.h"
#include "report/feature_results.h"
#include "report/report_data.h"
#include "report/summary.h"
#include "report/verdict_text.h"

namespace camber::cli {
namespace {

/// Reads both programs once more, for their stamps and their feed.
void write_report(const CompensateArguments& arguments, const machine::Job& job,
                  const compensate::CompensationResult& result, const Diagnostics& diagnostics) {
  Diagnostics ignored;  // said already
  const auto machined = [&](SourceText source) {
    return simulate::simulate_motion(std::move(source), job, {}, ignored);
  };
  const auto rows = [&](const simulate::SimulatedProgram& program) {
    return report::rows_of_program(program, job.machine);
  };
  const auto before = machined(SourceText::read(job.program));
  machine::Job emitted_job = job;
  if (job.operations.given() && !result.block_of_line.empty())
    emitted_job.operations = compensate::moved_ranges(result.operations, result.block_of_line);
  const auto after = simulate::simulate_motion(SourceText(job.program, result.text), emitted_job, {}, ignored);
  std::optional<nc::Interpretation> from;
  if (!result.repeated_text.empty()) from = machined(SourceText(job.program, result.repeated_text)).moves;
  report::write_html_report(arguments.report,
                            report::compensate_report(job, result, {before, rows(before), result.loads_before},
                                                      {after, rows(after), result.loads_after}, arguments.output,
                                                      diagnostics, from ? &*from : nullptr));
}

}  // namespace

api::CompensateRequest compensate_request(const CompensateArguments& arguments) {
  return {.uncertainty = arguments.uncertainty,
          .measured = arguments.measured,
          .measured_program = arguments.measured_program,
          .check_voxels_mm = arguments.check_voxels_mm,
          .time_budget_percent = arguments.time_budget_percent,
          .keep_anyway = arguments.keep_anyway,
          .header = arguments.header,
          .header_hash = arguments.header_hash,
          .max_stock_crossings = arguments.report.empty() ? 0 : report::kMaxStockCrossings,
          .levers = arguments.levers,
          .progress = {}};
}

namespace {

/// Beside the emitted program.
std::string features_path(const std::string& output) {
  return (std::filesystem::path(output).parent_path() / "features.csv").string();
}

/// `diagnostics`: of the job. `json`: the figures; empty where there are none. `emitted`: whether a program was
/// written.
int compensate_program(const machine::Job& given, Diagnostics diagnostics, const CompensateArguments& arguments,
                       const GlobalOptions& options, std::string& json, bool& emitted) {
  const auto begin = std::chrono::steady_clock::now();
  ProgressLine progress(options, "reading");
  bool in_rounds = false;  // their share is that of the whole run
  const StageScope stages([&](const std::string& what, double share) {
    if (!in_rounds) progress.show(what, share);
  });
  RoundsProgress rounds(given.compensation.max_rounds,
                        static_cast<int>(2 * arguments.check_voxels_mm.size() + arguments.uncertainty.size()));
  api::CompensateRequest request = compensate_request(arguments);
  request.progress = [&](const std::string& what, double share) {
    in_rounds = true;
    const RoundsProgress::Whole whole = rounds.at(what, share);
    progress.show_whole(whole.what, whole.share);
  };
  request.outlook = [&](const compensate::Outlook& outlook) {
    progress.clear();
    if (!options.quiet) fmt::print("{}\n", report::outlook_sentence(outlook));
    std::fflush(stdout);
  };
  api::CompensatedJob done;
  try {
    done = api::compensate_job(given, request, diagnostics);
  } catch (const BeyondModel& beyond) {
    progress.clear();
    settle(diagnostics, options);
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  const machine::Job& job = done.job;
  const compensate::CompensationResult& result = done.result;
  progress.clear();
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();

  const std::vector<std::string> assumed = machine::assumptions(given);
  for (const auto& name : result.unknown_parameters)
    if (!options.quiet)
      fmt::print(stderr, "camber: warning: --uncertainty: {} is not a parameter of the job; ignored [uncertainty]\n",
                 name);
  Diagnostics failed;
  const bool written = !arguments.dry_run && (result.better || arguments.keep_anyway);
  if (written) try_to_write([&] { api::write_compensated(arguments.output, job, result); }, failed);
  emitted = written;
  const auto features_before = report::features_of(job, result.surface_before);
  const auto features_after = report::features_of(job, result.surface_after);
  std::error_code ec;
  if (written && !features_after.empty() && std::filesystem::is_regular_file(arguments.output, ec))  // not a pipe
    try_to_write([&] { report::write_features_csv(features_path(arguments.output), features_after); }, failed);
  json = machine::with_assumptions(
      report::with_features(report::compensate_json(result, job.compensation, compute_s),
                            {{"features_before", features_before}, {"features_after", features_after}}),
      assumed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  in_rounds = false;
  progress.show("writing the report");
  if (!arguments.report.empty()) try_to_write([&] { write_report(arguments, job, result, diagnostics); }, failed);
  progress.clear();

  if (!options.quiet)
    fmt::print("{}{}{}", machine::assumptions_text(assumed), report::compensate_text(result, compute_s),
               report::features_text(features_before, features_after));
  failed.throw_if_errors();
  const report::VerdictText verdict = report::verdict_text(result, job.compensation);
  if (!verdict.success) {
    print_error(verdict.headline);
    for (const std::string& reason : verdict.reasons) print_error(reason);
  }
  if (!written && !arguments.dry_run)
    print_error(
        fmt::format("{} was not written; --keep-anyway writes the round with the smallest error", arguments.output));
  return verdict.success ? kDone : kNumbersDidNotWorkOut;
}

/// "report.html" of "1-rough": "report-1-rough.html".
std::string own_name(const std::string& path, const std::string& program) {
  if (path.empty()) return {};
  const std::filesystem::path p(path);
  return (p.parent_path() / fmt::format("{}-{}{}", p.stem().string(), program, p.extension().string())).string();
}

/// Each program on what the compensated one before it has left; the emitted programs have the names of the given ones,
/// in the folder of the output.
int compensate_in_turn(const machine::JobOfPrograms& all, const Diagnostics& diagnostics,
                       const CompensateArguments& arguments, const GlobalOptions& options) {
  if (!arguments.measured.empty()) {
    print_error("--measured belongs to one program, and the job has several");
    return kCommandLineWrong;
  }
  int status = kDone;
  const TemporaryFolder folder;
  std::string stock;
  std::vector<std::string> results, outputs;
  for (std::size_t i = 0; i < all.programs.size(); ++i) {
    const machine::Job one = api::job_of_program(all, i, stock);
    const std::string name = api::name_of_program(all.programs, i);
    CompensateArguments own = arguments;
    if (!arguments.dry_run) {
      make_folder(arguments.output);
      own.output = (std::filesystem::path(arguments.output) / std::filesystem::path(one.program).filename()).string();
      if (std::ranges::find(outputs, own.output) != outputs.end())
        own.output =
            (std::filesystem::path(arguments.output) / (name + std::filesystem::path(one.program).extension().string()))
                .string();
      check_outputs({own.output}, all.programs);
    }
    own.report = own_name(arguments.report, name);
    own.json.clear();
    if (!options.quiet) fmt::print("{}{}\n", i > 0 ? "\n" : "", one.program);
    bool emitted = false;
    status = std::max(status, compensate_program(one, i == 0 ? diagnostics : Diagnostics(), own, options,
                                                 results.emplace_back(), emitted));
    outputs.push_back(emitted ? own.output : "");
    if (i + 1 == all.programs.size()) break;
    machine::Job left = one;
    if (emitted) left.program = own.output;
    stock = folder.path() + "/" + name + ".vdb";
    api::save_stock_after(left, stock);
  }
  if (!arguments.json.empty()) write_file(arguments.json, api::join_results(all, results, outputs));
  return status;
}

}  // namespace

int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::JobOfPrograms all = machine::read_job_of_programs(arguments.job, diagnostics);
  if (all.programs.size() > 1) return compensate_in_turn(all, diagnostics, arguments, options);
  std::string json;
  bool emitted = false;
  return compensate_program(all.job, std::move(diagnostics), arguments, options, json, emitted);
}

}  // namespace camber::cli
