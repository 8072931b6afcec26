// camber compensate J.toml -o OUT.nc [--report R.html] [--json R.json]; camber compensate --verify DIR [--json R.json]
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "api/compensation.h"
#include "api/job.h"
#include "base/folders.h"
#include "base/output_file.h"
#include "camber/verify.h"
#include "cli/console.h"
#include "cli/job_commands.h"
#include "cli/mpi_run.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "cli/rounds_progress.h"
#include "compensate/verify_program.h"
#include "machine/compensation_settings.h"
#include "report/joined_json.h"

namespace camber::cli {
namespace {

/// Throws InputError, with the warnings of the job.
void check_levers(const std::vector<std::string>& names, const Job& job) {
  if (names.empty()) return;
  Diagnostics found = job.impl().found;
  for (const std::string& message : machine::levers_of(names).errors)
    found.add({Severity::error, {job.path(), 0, 0}, "--levers: " + message, "value-choice", {}});
  found.throw_if_errors();
}

/// One verdict of compensate or verify.
int say_verdict(bool success, const std::string& headline, const std::vector<std::string>& reasons) {
  if (success) return kDone;
  print_error(headline);
  for (const std::string& reason : reasons) print_error(reason);
  return kNumbersDidNotWorkOut;
}

CompensateResult compensate_shown(const Job& job, const CompensateOptions& given, const GlobalOptions& options,
                                  const simulate::Predictor& predictor) {
  CompensateOptions asked = given;
  ProgressLine progress(options, "reading");
  RunOptions run = run_options(progress, options);
  run.warn = [&, warn = run.warn](const std::vector<Diagnostic>& warnings) {
    warn(warnings);
    print_translation(job.machine().translation(), options);
  };
  RoundsProgress rounds(job.impl().job.compensation.max_rounds,
                        static_cast<int>(2 * asked.check_voxels_mm.size() + asked.uncertainty.size()));
  asked.step = [&](const std::string& step, double fraction) {
    const RoundsProgress::Whole whole = rounds.at(step, fraction);
    progress.show_whole(whole.what, whole.share);
  };
  asked.outlook = [&](const std::string& sentence) {
    progress.clear();
    if (!options.quiet) fmt::print("{}\n", sentence);
    std::fflush(stdout);
  };
  return api::compensate(job, asked, run, predictor);
}

/// `json`: the figures; empty where there are none. `emitted`: whether a program was written.
int compensate_program(const Job& job, const CompensateArguments& arguments, const GlobalOptions& options,
                       const simulate::Predictor& predictor, std::string& json, bool& emitted) {
  check_levers(arguments.options.levers, job);
  CompensateOptions asked = arguments.options;
  asked.page = !arguments.report.empty();
  asked.throw_if_unwritten = false;
  CompensateResult result;
  try {
    result = compensate_shown(job, asked, options, predictor);
  } catch (const BeyondModel& beyond) {
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  for (const auto& name : result.unknown_parameters)
    if (!options.quiet)
      fmt::print(stderr, "camber: warning: --uncertainty: {} is not a parameter of the job; ignored [uncertainty]\n",
                 name);
  Diagnostics failed;
  for (const Diagnostic& d : result.unwritten) failed.add(d);
  emitted = result.written;
  json = result.json;
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  if (!arguments.report.empty()) try_to_write([&] { write_file(arguments.report, result.page); }, failed);
  if (!options.quiet) fmt::print("{}", result.printed);
  failed.throw_if_errors();
  const int status = say_verdict(result.success, result.headline, result.reasons);
  if (!result.written && !asked.dry_run)
    print_error(
        fmt::format("{} was not written; --keep-anyway writes the round with the smallest error", asked.output));
  return status;
}

/// "report.html" of "1-rough": "report-1-rough.html".
std::string own_name(const std::string& path, const std::string& program) {
  if (path.empty()) return {};
  const std::filesystem::path p(path);
  return (p.parent_path() / fmt::format("{}-{}{}", p.stem().string(), program, p.extension().string())).string();
}

/// Where the program of a sequence goes: it keeps its name, unless one before it had the same.
std::string own_output(const std::string& folder, const std::string& program, const std::string& name,
                       const std::vector<std::string>& others) {
  const std::filesystem::path given(program);
  std::string out = (std::filesystem::path(folder) / given.filename()).string();
  if (std::ranges::find(others, out) == others.end()) return out;
  return (std::filesystem::path(folder) / (name + given.extension().string())).string();
}

/// Each program on what the compensated one before it has left; the emitted programs have the names of the given ones,
/// in the folder of the output.
int compensate_in_turn(const JobOfPrograms& all, const CompensateArguments& arguments, const GlobalOptions& options,
                       const simulate::Predictor& predictor) {
  if (!arguments.options.measured.empty()) {
    print_error("--measured belongs to one program, and the job has several");
    return kCommandLineWrong;
  }
  int status = kDone;
  const TemporaryFolder folder;
  std::string stock;
  std::vector<std::string> results, outputs;
  for (std::size_t i = 0; i < all.programs.size(); ++i) {
    const Job one = all.of_program(i, stock);
    const std::string name = all.name(i);
    CompensateArguments own = arguments;
    if (!arguments.options.dry_run) {
      make_folder(arguments.options.output);
      own.options.output = own_output(arguments.options.output, one.program_path(), name, outputs);
      check_outputs({own.options.output}, all.programs);
    }
    own.report = own_name(arguments.report, name);
    own.json.clear();
    if (!options.quiet) fmt::print("{}{}\n", i > 0 ? "\n" : "", one.program_path());
    bool emitted = false;
    status = std::max(status, compensate_program(one, own, options, predictor, results.emplace_back(), emitted));
    outputs.push_back(emitted ? own.options.output : "");
    if (i + 1 == all.programs.size()) break;
    Job left = one;
    if (emitted) left.set_program(own.options.output);
    stock = folder.path() + "/" + name + ".vdb";
    predict(left, {.rows = false, .stock = stock});
  }
  if (!arguments.json.empty())
    write_file(arguments.json, report::join_results(all.job.assumed(), all.programs, results, outputs));
  return status;
}

/// Judges a program that compensate wrote, from its text and its record, and writes the job with which predict gives
/// the same figures: OUT.verify.toml beside OUT.nc. Throws InputError.
int run_verify(const std::string& place, const std::string& json, const GlobalOptions& options) {
  const EmittedFiles files = emitted_files(place);
  check_outputs({files.job, json}, {files.program, files.record});
  VerifyResult result;
  try {
    ProgressLine progress(options, "reading");
    result = verify(place, run_options(progress, options));
  } catch (const BeyondModel& beyond) {
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  }
  Diagnostics failed;
  if (!json.empty()) try_to_write([&] { write_file(json, result.json); }, failed);
  if (!options.quiet) fmt::print("{}", result.printed);
  failed.throw_if_errors();
  return say_verdict(result.success, result.headline, result.reasons);
}

/// Returns the path of the record beside the program that is to be written; empty where none is written.
std::string record_of(const CompensateArguments& arguments) {
  std::error_code ec;
  const bool special = std::filesystem::exists(arguments.options.output, ec) &&
                       !std::filesystem::is_regular_file(arguments.options.output, ec);
  return arguments.options.dry_run || special ? "" : compensate::record_path(arguments.options.output);
}

}  // namespace

int run_compensate(const CompensateArguments& arguments, const GlobalOptions& options,
                   const simulate::Predictor& predictor) {
  const JobOfPrograms all = read_job_of_programs(arguments.job);
  if (all.programs.size() > 1) return compensate_in_turn(all, arguments, options, predictor);
  std::string json;
  bool emitted = false;
  return compensate_program(all.job, arguments, options, predictor, json, emitted);
}

void add_compensate_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("compensate", "shift the path of a job against its form error");
  auto arguments = std::make_shared<CompensateArguments>();
  auto* job = command->add_option("job", arguments->job, "job.toml")->type_name("J.toml");
  auto* output = command
                     ->add_option("-o,--output", arguments->options.output,
                                  "the new program; of a job with several programs the folder for them")
                     ->type_name("OUT.nc");
  auto* dry_run = command->add_flag("--dry-run", arguments->options.dry_run, "do everything, but write no program");
  command
      ->add_option("--uncertainty", arguments->options.uncertainty,
                   "output of fit-force or fit-feed, or a percentage: uncertainty of the residual error")
      ->type_name("FILE|PERCENT")
      ->take_all();
  auto* measured =
      command->add_option("--measured", arguments->options.measured,
                          "points measured on a part (x_mm y_mm z_mm nx ny nz error_um): scales the model first");
  measured->type_name("POINTS.csv");
  command
      ->add_option("--measured-program", arguments->options.measured_program,
                   "program that the measured part was cut with; default: the job's")
      ->type_name("P.nc")
      ->needs(measured);
  command
      ->add_option("--check-voxel", arguments->options.check_voxels_mm,
                   "predict both programs again on a grid of this voxel, mm; may be repeated")
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  command
      ->add_option(
          "--time-budget", arguments->options.time_budget_percent,
          "extra machine time, %, for lower feeds and second cuts: the least error within it ([compensation] levers)")
      ->check(CLI::Range(0.0, 1000.0))
      ->type_name("PERCENT");
  command
      ->add_option("--levers", arguments->options.levers,
                   "what may change, instead of the job's: shift,feed,passes,allowance")
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("LIST");
  command->add_flag("--keep-anyway", arguments->options.keep_anyway,
                    "write the program even if it is no better than the given one");
  command->add_flag("--header", arguments->options.header,
                    "add comment lines at the head of the program: what was done, with which model");
  command->add_flag("--header-hash", arguments->options.header_hash, "the same, with a hash of all inputs");
  command->add_option("--report", arguments->report, "report page with before and after")->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  auto* verify = command->add_option("--verify", "judge an emitted program from its text; takes no job");
  verify->type_name("DIR|OUT.nc");
  command->callback([arguments, command, job, output, dry_run, verify, &options, &chosen] {
    if (!verify->empty()) {
      for (const CLI::Option* other : command->get_options())
        if (other != verify && !other->check_lname("json") && !other->empty())
          throw CLI::ExcludesError("--verify", other->get_name());
      chosen = [place = verify->as<std::string>(), json = arguments->json, &options] {
        if (started_by_mpi()) {
          print_error("--verify judges one program; without mpirun it runs");
          return static_cast<int>(kCommandLineWrong);
        }
        return run_verify(place, json, options);
      };
      return;
    }
    if (job->empty()) throw CLI::RequiredError("J.toml or --verify DIR");
    if (output->empty() && dry_run->empty()) throw CLI::RequiredError("-o OUT.nc or --dry-run");
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      const std::vector<std::string> inputs =
          files_read(arguments->job, {arguments->options.measured, arguments->options.measured_program});
      if (has_several_programs(arguments->job)) {
        if (!arguments->options.dry_run) check_output_folder(arguments->options.output);
        check_outputs({arguments->report, arguments->json}, inputs);
        return run_compensate(*arguments, options);
      }
      check_outputs({arguments->options.dry_run ? "" : arguments->options.output, record_of(*arguments),
                     arguments->report, arguments->json},
                    inputs);
      if (!started_by_mpi()) return run_compensate(*arguments, options);
      if (has_mpi()) return run_compensate_on_ranks(*arguments, options);
      print_error("this camber is built without MPI; without mpirun it runs");
      return static_cast<int>(kCommandLineWrong);
    };
  });
}

}  // namespace camber::cli
