// predict, compensate, adapt and study on the command line.
#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "cli/adapt_command.h"
#include "cli/command_line.h"
#include "cli/compensate_command.h"
#include "cli/console.h"
#include "cli/mpi_run.h"
#include "cli/outputs.h"
#include "cli/predict_command.h"
#include "cli/sections_command.h"
#include "cli/study_command.h"
#include "cli/verify_command.h"
#include "compensate/verify.h"
#include "machine/job_file.h"

namespace camber::cli {
namespace {

int print_effective_job(const std::string& path, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(path, diagnostics);
  settle(diagnostics, options);
  fmt::print("# {}\n{}\n# {}\n{}", path, machine::to_toml(job), job.machine_path, machine::to_toml(job.machine));
  return kDone;
}

/// Every file that a job names, and those of the command line.
std::vector<std::string> files_read(const std::string& job_path, std::vector<std::string> others = {}) {
  Diagnostics diagnostics;
  const auto [job, programs] = machine::read_job_of_programs(job_path, diagnostics);
  others.insert(others.end(), programs.begin(), programs.end());
  others.insert(others.end(), {job_path, job.program, job.machine_path, job.stock.mesh, job.stock.vdb, job.part.mesh,
                               job.part.program});
  return others;
}

bool has_several_programs(const std::string& job_path) {
  Diagnostics ignored;  // the command reads the job again
  return machine::read_job_of_programs(job_path, ignored).programs.size() > 1;
}

void add_section_options(CLI::App& command, SectionsArguments& parts, CLI::Option& trace) {
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
      ->check(CLI::Range(1, api::kMaxSectionRounds))
      ->type_name("K")
      ->needs(section);
}

/// Every rank comes here.
int predict_with_mpi(const PredictArguments& arguments, const SectionsArguments& parts, bool in_sections,
                     const GlobalOptions& options) {
  if (in_sections || !arguments.trace.empty() || !has_mpi()) {
    print_error(!has_mpi()
                    ? "this camber is built without MPI; without mpirun, or with --sections, it runs"
                    : "under mpirun the ranks are the sections; --sections and --trace are for a single process");
    return kCommandLineWrong;
  }
  return run_predict_on_ranks(parts, options);
}

void add_predict(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("predict", "cutting force, deflection and form error of a job");
  auto arguments = std::make_shared<PredictArguments>();
  command->add_option("job", arguments->job, "job.toml")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output_folder, "folder for the results")->required()->type_name("DIR");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  command
      ->add_option("--forces-at", arguments->forces_at,
                   "write forces_at_LINE.csv: forces over one revolution of the spindle at this line, tooth by tooth")
      ->check(CLI::Range(std::size_t{1}, std::size_t{2000000000}))
      ->type_name("LINE");
  auto* trace = command->add_option("--trace", arguments->trace,
                                    "cut where this servo trace of the program measured the axes, not where the feed "
                                    "model has them; both error maps and their difference");
  trace->type_name("T.csv");
  command
      ->add_option("--columns", arguments->columns,
                   "a map of the trace's columns, if they are not t_s, x_act_mm, y_act_mm, z_act_mm ...")
      ->type_name("MAP.toml")
      ->needs(trace);
  auto* meshes = command->add_flag("--meshes", arguments->meshes,
                                   "also write machined.stl and machined.ply, the machined part, and "
                                   "form_error_mesh.ply, its surface with the form error in colours");
  auto parts = std::make_shared<SectionsArguments>();
  add_section_options(*command, *parts, *trace);
  command->get_option("--sections")->excludes(meshes);
  command->callback([arguments, parts, command, &options, &chosen] {
    const bool in_sections = command->count("--sections") > 0, one = command->count("--section") > 0;
    if (one != (command->count("--stage") > 0)) throw CLI::RequiredError(one ? "--stage" : "--section");
    if (one && parts->section > parts->sections)
      throw CLI::ValidationError("--section", fmt::format("{} of {} sections", parts->section, parts->sections));
    parts->solve = one && command->get_option("--stage")->as<std::string>() == "solve";
    if (command->count("--round") > 0 && !parts->solve) throw CLI::RequiredError("--stage solve");
    chosen = [arguments, parts, in_sections, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_output_folder(arguments->output_folder);
      std::vector<std::string> outputs{arguments->json};
      for (const char* name : {"summary.json", "stock.vdb"}) outputs.push_back(arguments->output_folder + "/" + name);
      if (!std::filesystem::exists(arguments->output_folder)) outputs.resize(1);
      check_outputs(outputs, files_read(arguments->job, {arguments->trace, arguments->columns}));
      parts->job = arguments->job, parts->output_folder = arguments->output_folder;
      parts->json = arguments->json, parts->forces_at = arguments->forces_at;
      if (started_by_mpi()) return predict_with_mpi(*arguments, *parts, in_sections, options);
      return in_sections ? run_sections(*parts, options) : run_predict(*arguments, options);
    };
  });
}

void add_merge(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("merge", "join the parts that predict --sections has written");
  auto arguments = std::make_shared<MergeArguments>();
  command->add_option("folder", arguments->folder, "folder of the parts, and for the results")
      ->required()
      ->check(CLI::ExistingDirectory.description(""))
      ->type_name("DIR");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_output_folder(arguments->folder);
      check_outputs({arguments->json}, {});
      return run_merge(*arguments, options);
    };
  });
}

/// Of the program that is to be written; empty: none.
std::string record_of(const CompensateArguments& arguments) {
  std::error_code ec;
  const bool special =
      std::filesystem::exists(arguments.output, ec) && !std::filesystem::is_regular_file(arguments.output, ec);
  return arguments.dry_run || special ? "" : compensate::record_path(arguments.output);
}

void add_compensate(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("compensate", "shift the path of a job against its form error");
  auto arguments = std::make_shared<CompensateArguments>();
  auto* job = command->add_option("job", arguments->job, "job.toml")->type_name("J.toml");
  auto* output = command
                     ->add_option("-o,--output", arguments->output,
                                  "the new program; of a job with several programs the folder for them")
                     ->type_name("OUT.nc");
  auto* dry_run = command->add_flag("--dry-run", arguments->dry_run, "do everything, but write no program");
  command
      ->add_option("--uncertainty", arguments->uncertainty,
                   "output of fit-force or fit-feed, or a percentage: uncertainty of the residual error")
      ->type_name("FILE|PERCENT")
      ->take_all();
  auto* measured =
      command->add_option("--measured", arguments->measured,
                          "points measured on a part (x_mm y_mm z_mm nx ny nz error_um): scales the model first");
  measured->type_name("POINTS.csv");
  command
      ->add_option("--measured-program", arguments->measured_program,
                   "program that the measured part was cut with; default: the job's")
      ->type_name("P.nc")
      ->needs(measured);
  command
      ->add_option("--check-voxel", arguments->check_voxels_mm,
                   "predict both programs again on a grid of this voxel, mm; may be repeated")
      ->check(CLI::PositiveNumber)
      ->type_name("MM");
  command
      ->add_option(
          "--time-budget", arguments->time_budget_percent,
          "extra machine time, %, for lower feeds and second cuts: the least error within it ([compensation] levers)")
      ->check(CLI::Range(0.0, 1000.0))
      ->type_name("PERCENT");
  command->add_option("--levers", arguments->levers, "what may change, instead of the job's: shift,feed,passes")
      ->delimiter(',')
      ->expected(1)
      ->take_all()
      ->type_name("LIST");
  command->add_flag("--keep-anyway", arguments->keep_anyway,
                    "write the program even if it is no better than the given one");
  command->add_flag("--header", arguments->header,
                    "add comment lines at the head of the program: what was done, with which model");
  command->add_flag("--header-hash", arguments->header_hash, "the same, with a hash of all inputs");
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
        return run_verify({place, json}, options);
      };
      return;
    }
    if (job->empty()) throw CLI::RequiredError("J.toml or --verify DIR");
    if (output->empty() && dry_run->empty()) throw CLI::RequiredError("-o OUT.nc or --dry-run");
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      const std::vector<std::string> inputs =
          files_read(arguments->job, {arguments->measured, arguments->measured_program});
      if (has_several_programs(arguments->job)) {
        if (!arguments->dry_run) check_output_folder(arguments->output);
        check_outputs({arguments->report, arguments->json}, inputs);
        return run_compensate(*arguments, options);
      }
      check_outputs(
          {arguments->dry_run ? "" : arguments->output, record_of(*arguments), arguments->report, arguments->json},
          inputs);
      if (!started_by_mpi()) return run_compensate(*arguments, options);
      if (has_mpi()) return run_compensate_on_ranks(*arguments, options);
      print_error("this camber is built without MPI; without mpirun it runs");
      return static_cast<int>(kCommandLineWrong);
    };
  });
}

void add_adapt(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("adapt", "change the feeds of a job's program by the loads of its cut");
  auto arguments = std::make_shared<AdaptArguments>();
  command->add_option("job", arguments->job, "job.toml with [adapt]")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the new program")->required()->type_name("OUT.nc");
  command
      ->add_option("--time-limit", arguments->time_limit_s,
                   "scale all limits by the least factor with which the program takes no longer than this, s")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_flag("--sweep", arguments->sweep, "also the time for limits from half to twice the given ones");
  command->add_flag("--keep-anyway", arguments->keep_anyway, "write the program even if a limit is not kept");
  command->add_option("--report", arguments->report, "report page with loads and feeds along the path")
      ->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_job(arguments->job, options);
      check_outputs({arguments->output, arguments->report, arguments->json}, files_read(arguments->job));
      return run_adapt(*arguments, options);
    };
  });
}

void add_study(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("study", "a job varied over a grid of its keys: one table, one page");
  auto arguments = std::make_shared<StudyArguments>();
  command->add_option("study", arguments->study, "study.toml: job, command, [grid]")->required()->type_name("S.toml");
  command->add_option("-o,--output", arguments->output_folder, "folder for cases, table and page")
      ->required()
      ->type_name("DIR");
  command->add_flag("--list", arguments->list,
                    "print the commands of the cases that are not done, one a line, and run none");
  command->add_option("--json", arguments->json, "also write the table to this file")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      check_output_folder(arguments->output_folder);
      check_outputs({arguments->json}, {arguments->study});
      return run_study(*arguments, options);
    };
  });
}

}  // namespace

void add_job_commands(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  add_predict(app, options, chosen);
  add_compensate(app, options, chosen);
  add_adapt(app, options, chosen);
  add_study(app, options, chosen);
  add_merge(app, options, chosen);
}

}  // namespace camber::cli
