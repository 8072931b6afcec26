// camber study: a grid of jobs, case after case or as a list of commands.
#include <memory>
#include <new>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "camber/study.h"
#include "cli/console.h"
#include "cli/job_commands.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct StudyArguments {
  std::string study;
  std::string output_folder;
  std::string json;   ///< copy of study.json; empty: none
  bool list = false;  ///< print the commands of the open cases, and run none
};

/// The command of a case, as its command line would run it. Returns its exit status.
int run_case(const std::string& command, const StudyCase& one, const GlobalOptions& options) {
  if (command == "compensate")
    return run_compensate(
        {.job = one.job_path, .report = one.report, .json = one.json, .options = {.output = one.output}}, options);
  if (command == "adapt")
    return run_adapt({.job = one.job_path, .output = one.output, .report = one.report, .json = one.json}, options);
  return run_predict({.job = one.job_path, .options = {.output_folder = one.folder}}, options);
}

/// A case whose input is wrong does not end the study.
int guarded_case(const std::string& command, const StudyCase& one, const GlobalOptions& options) {
  try {
    return run_case(command, one, options);
  } catch (const InputError& problem) {
    print_diagnostics(problem.diagnostics(), options);
  } catch (const std::bad_alloc&) {
    print_error(fmt::format("not enough memory for {} [memory]", one.job_path));
  }
  return kInputWrong;
}

int run_study(const StudyArguments& arguments, const GlobalOptions& options) {
  Study study = open_study(arguments.study, arguments.output_folder);
  settle(study.diagnostics, options);
  std::size_t failed = 0;
  if (arguments.list) {
    for (const StudyCase& one : study.cases)
      if (!one.done) fmt::print("{}\n", one.command_line);
  } else {
    GlobalOptions of_case = options;
    of_case.quiet = true;
    ProgressLine progress(options, "studying");
    for (std::size_t i = 0; i < study.cases.size(); ++i) {
      progress.show_whole(fmt::format("case {} of {}", i + 1, study.cases.size()),
                          static_cast<double>(i) / static_cast<double>(study.cases.size()));
      const StudyCase& one = study.cases[i];
      if (!one.done && guarded_case(study.command, one, of_case) == kInputWrong) ++failed;
    }
    progress.clear();
  }
  study.read_results();
  write_file(arguments.output_folder + "/study.csv", study.csv);
  write_file(arguments.output_folder + "/study.json", study.json);
  write_file(arguments.output_folder + "/study.html", study.page);
  if (!arguments.json.empty()) write_file(arguments.json, study.json);
  if (!arguments.list && !options.quiet) fmt::print("{}", study.printed);
  if (failed > 0) {
    print_error(fmt::format("{} of {} cases could not be computed; the same command tries them again", failed,
                            study.cases.size()));
    return kInputWrong;
  }
  if (study.doubtful == 0 || arguments.list) return kDone;
  print_error(fmt::format("in {} of {} cases the numbers did not work out; their pages say why", study.doubtful,
                          study.cases.size()));
  return kNumbersDidNotWorkOut;
}

}  // namespace

void add_study_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
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

}  // namespace camber::cli
