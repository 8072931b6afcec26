// camber predict J.toml -o DIR [--json R.json] [--forces-at LINE] [--trace T.csv [--columns MAP.toml]]
//   [--sections N [--section I --stage sweep|solve [--round K]]]
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "camber/sections.h"
#include "cli/console.h"
#include "cli/job_commands.h"
#include "cli/mpi_run.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "distribute/path_sections.h"
#include "report/joined_json.h"

namespace camber::cli {

using distribute::kMaxSectionRounds;

int finish_prediction(const PredictResult& result, std::size_t settled, const std::string& json,
                      const GlobalOptions& options) {
  Diagnostics failed;
  for (const Diagnostic& d : result.unwritten) failed.add(d);
  if (!json.empty()) try_to_write([&] { write_file(json, result.json); }, failed);
  if (!options.quiet) fmt::print("{}", result.printed);
  failed.throw_if_errors();
  settle(std::vector(result.diagnostics.begin() + static_cast<std::ptrdiff_t>(settled), result.diagnostics.end()),
         options);
  for (const std::string& sentence : result.doubts) print_error(sentence);
  return result.doubts.empty() ? kDone : kNumbersDidNotWorkOut;
}

namespace {

/// `json`: gets the figures.
int predict_program(const Job& job, const PredictArguments& arguments, const GlobalOptions& options,
                    std::string& json) {
  std::size_t settled = 0;
  PredictResult result;
  {
    ProgressLine progress(options, "reading");
    RunOptions run = run_options(progress, options, &settled);
    run.warn = [&, warn = run.warn](const std::vector<Diagnostic>& warnings) {
      warn(warnings);
      print_translation(job.machine().translation(), options);
    };
    result = predict(job, arguments.options, run);
  }
  json = result.json;
  return finish_prediction(result, settled, arguments.json, options);
}

/// Each program on what the one before has left, each in a folder of its own.
int predict_in_turn(const JobOfPrograms& all, const PredictArguments& arguments, const GlobalOptions& options) {
  const std::string& folder = arguments.options.output_folder;
  if (!arguments.options.trace.empty() || arguments.options.forces_at > 0) {
    print_error("--trace and --forces-at belong to one program, and the job has several");
    return kCommandLineWrong;
  }
  int status = kDone;
  std::string stock;
  std::vector<std::string> results, folders;
  for (std::size_t i = 0; i < all.programs.size(); ++i) {
    PredictArguments one = arguments;
    one.options.output_folder += "/" + all.name(i);
    one.json.clear();
    if (!options.quiet) fmt::print("{}{}\n", i > 0 ? "\n" : "", all.programs[i]);
    status = std::max(status, predict_program(all.of_program(i, stock), one, options, results.emplace_back()));
    stock = one.options.output_folder + "/stock.vdb";
    folders.push_back(one.options.output_folder);
  }
  const std::string json = report::join_results(all.job.assumed(), all.programs, results, folders);
  write_file(folder + "/summary.json", json);
  if (!arguments.json.empty()) write_file(arguments.json, json);
  return status;
}

int predict_all_sections(const PredictArguments& arguments, const GlobalOptions& options) {
  std::size_t settled = 0;
  PredictResult result;
  {
    ProgressLine progress(options, "reading");
    result = predict_in_sections(arguments.job, arguments.sections, arguments.options,
                                 run_options(progress, options, &settled));
  }
  return finish_prediction(result, settled, arguments.json, options);
}

}  // namespace

int run_predict(const PredictArguments& given, const GlobalOptions& options) {
  PredictArguments arguments = given;
  arguments.options.rows = false;
  arguments.options.throw_if_unwritten = false;
  if (arguments.sections > 0) return predict_all_sections(arguments, options);
  const JobOfPrograms all = read_job_of_programs(arguments.job);
  if (all.programs.size() > 1) return predict_in_turn(all, arguments, options);
  std::string json;
  return predict_program(all.job, arguments, options, json);
}

namespace {

/// Computes one part of a prediction in sections.
int run_section(const PredictArguments& arguments, const SectionOptions& part, const GlobalOptions& options) {
  std::size_t settled = 0;
  SectionResult result;
  {
    ProgressLine progress(options, "reading");
    result =
        predict_section(arguments.job, arguments.options.output_folder, part, run_options(progress, options, &settled));
  }
  if (!options.quiet) {
    if (!result.has_round)
      fmt::print("rigid coupling has one round\n");
    else if (result.computed)
      fmt::print("{}: {} stamps, {} voxels\n", result.part, result.stamps, result.voxels);
    else
      fmt::print("{}: is there already\n", result.part);
  }
  settle(std::vector(result.diagnostics.begin() + static_cast<std::ptrdiff_t>(settled), result.diagnostics.end()),
         options);
  return kDone;
}

void add_section_options(CLI::App& command, SectionOptions& parts, CLI::Option& trace) {
  auto* sections = command
                       .add_option("--sections", parts.sections,
                                   "in this many sections of the path; alone: all of them, and the merge")
                       ->check(CLI::Range(std::size_t{1}, std::size_t{10000}))
                       ->type_name("N")
                       ->excludes(&trace);
  auto* section = command.add_option("--section", parts.section, "only this one, from 1; camber merge joins them")
                      ->check(CLI::Range(std::size_t{1}, std::size_t{10000}))
                      ->type_name("I")
                      ->needs(sections);
  command.add_option("--stage", "of one section: sweep all sections first, then solve them")
      ->check(CLI::IsMember({"sweep", "solve"}).description(""))
      ->type_name("sweep|solve")
      ->needs(section);
  command.add_option("--round", parts.round, "of solving in static coupling")
      ->check(CLI::Range(1, kMaxSectionRounds))
      ->type_name("K")
      ->needs(section);
}

/// Every rank comes here.
int predict_with_mpi(const PredictArguments& arguments, bool in_sections, const GlobalOptions& options) {
  if (in_sections || !arguments.options.trace.empty() || !has_mpi()) {
    print_error(!has_mpi()
                    ? "this camber is built without MPI; without mpirun, or with --sections, it runs"
                    : "under mpirun the ranks are the sections; --sections and --trace are for a single process");
    return kCommandLineWrong;
  }
  return run_predict_on_ranks(arguments, options);
}

}  // namespace

void add_predict_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("predict", "cutting force, deflection and form error of a job");
  auto arguments = std::make_shared<PredictArguments>();
  command->add_option("job", arguments->job, "job.toml")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->options.output_folder, "folder for the results")
      ->required()
      ->type_name("DIR");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  command
      ->add_option("--forces-at", arguments->options.forces_at,
                   "write forces_at_LINE.csv: forces over one revolution of the spindle at this line, tooth by tooth")
      ->check(CLI::Range(std::size_t{1}, std::size_t{2000000000}))
      ->type_name("LINE");
  auto* trace = command->add_option("--trace", arguments->options.trace,
                                    "cut where this servo trace of the program measured the axes, not where the feed "
                                    "model has them; both error maps and their difference");
  trace->type_name("T.csv");
  command
      ->add_option("--columns", arguments->options.columns,
                   "a map of the trace's columns, if they are not t_s, x_act_mm, y_act_mm, z_act_mm ...")
      ->type_name("MAP.toml")
      ->needs(trace);
  auto* meshes = command->add_flag("--meshes", arguments->options.meshes,
                                   "also write machined.stl and machined.ply, the machined part, and "
                                   "form_error_mesh.ply, its surface with the form error in colours");
  auto* explain = command->add_flag("--explain", arguments->options.explain,
                                    "also how uncertain the margins of chatter are: modes, their errors, and what each "
                                    "does to the margin");
  auto parts = std::make_shared<SectionOptions>();
  add_section_options(*command, *parts, *trace);
  command->get_option("--sections")->excludes(meshes)->excludes(explain);
  command->callback([arguments, parts, command, &options, &chosen] {
    const bool in_sections = command->count("--sections") > 0, one = command->count("--section") > 0;
    if (one != (command->count("--stage") > 0)) throw CLI::RequiredError(one ? "--stage" : "--section");
    if (one && parts->section > parts->sections)
      throw CLI::ValidationError("--section", fmt::format("{} of {} sections", parts->section, parts->sections));
    parts->solve = one && command->get_option("--stage")->as<std::string>() == "solve";
    if (command->count("--round") > 0 && !parts->solve) throw CLI::RequiredError("--stage solve");
    chosen = [arguments, parts, in_sections, one, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_output_folder(arguments->options.output_folder);
      std::vector<std::string> outputs{arguments->json};
      for (const char* name : {"summary.json", "stock.vdb"})
        outputs.push_back(arguments->options.output_folder + "/" + name);
      if (!std::filesystem::exists(arguments->options.output_folder)) outputs.resize(1);
      check_outputs(outputs, files_read(arguments->job, {arguments->options.trace, arguments->options.columns}));
      if (started_by_mpi()) return predict_with_mpi(*arguments, in_sections, options);
      if (!in_sections) return run_predict(*arguments, options);
      parts->forces_at = arguments->options.forces_at;
      if (one) return run_section(*arguments, *parts, options);
      arguments->sections = parts->sections;
      return run_predict(*arguments, options);
    };
  });
}

}  // namespace camber::cli
