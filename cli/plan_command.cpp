#include "cli/plan_command.h"

#include <chrono>
#include <memory>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "api/commands/plan.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "report/plan_summary.h"

namespace camber::cli {
namespace {

std::vector<std::string> texts_of(const Diagnostics& diagnostics) {
  std::vector<std::string> out;
  for (const Diagnostic& d : diagnostics.all()) out.push_back(to_string(d));
  return out;
}

int print_cases_error(const plan::PlanInput& input) {
  fmt::print("{}", report::cases_error_text(input.cases));
  return kDone;
}

}  // namespace

int run_plan(const PlanArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const plan::PlanInput input = plan::read_plan_input(arguments.plan, diagnostics);
  if (arguments.cases_error) return progress.clear(), settle(diagnostics, options), print_cases_error(input);
  const StageScope stages([&](const std::string& what, double share) { progress.show(what, share); });
  const api::PlannedFiles done = api::plan_job(
      input,
      {.operations = arguments.operations, .programs = arguments.programs, .all_programs = arguments.all_programs},
      diagnostics);
  progress.clear();
  settle(diagnostics, options);
  print_translation(input.machine.translation, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  make_folder(arguments.output_folder);
  Diagnostics failed;
  const auto write = [&](const std::string& path, const std::string& text) {
    try_to_write([&] { write_file(path, text); }, failed);
  };
  for (const auto& [name, text] : done.files) write(arguments.output_folder + "/" + name, text);
  const std::string json = report::plan_json(input, done.result, compute_s);
  write(arguments.output_folder + "/plan.json", json);
  if (!arguments.json.empty()) write(arguments.json, json);
  write(arguments.output_folder + "/report.html", report::plan_page(input, done.result, texts_of(diagnostics)));
  if (!options.quiet) fmt::print("{}", report::plan_text(input, done.result, compute_s));
  if (arguments.learn) {
    const api::LearnedCases learned = api::learn_cases(input, done.result);
    if (learned.added > 0) write(input.cases.path, learned.text);
    if (!options.quiet) fmt::print("{} new cases in {}\n", learned.added, input.cases.path);
  }
  failed.throw_if_errors();
  const std::vector<std::string> failures = report::plan_failures(done.result);
  for (const std::string& failure : failures) print_error(failure);
  return failures.empty() ? kDone : kNumbersDidNotWorkOut;
}

void add_plan_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("plan", "operations, tools, conditions and order from a blank and a part");
  auto arguments = std::make_shared<PlanArguments>();
  command->add_option("plan", arguments->plan, "plan.toml: blank, part, machine, tools, case base")
      ->required()
      ->type_name("PLAN.toml");
  auto* output =
      command->add_option("-o,--output", arguments->output_folder, "folder for the results")->type_name("DIR");
  command
      ->add_option("--operations", arguments->operations,
                   "go on from this table of operations (DIR/operations.toml of an earlier run, edited)")
      ->type_name("T.toml");
  command->add_flag("--programs", arguments->programs,
                    "also the programs of the plan, by copy milling, and their times by the feed model");
  command->add_flag("--all-programs", arguments->all_programs,
                    "programs of all three plans; their times decide which plan is taken");
  command->add_option("--json", arguments->json, "also write the figures to this file")->type_name("R.json");
  auto* cases = command->add_flag("--cases-error", arguments->cases_error,
                                  "print how well the cases predict each other, and plan nothing");
  command->add_flag("--learn", arguments->learn, "add the conditions of the operations to the case base")
      ->excludes(cases);
  command->callback([arguments, output, &options, &chosen] {
    if (output->empty() && !arguments->cases_error) throw CLI::RequiredError("-o DIR or --cases-error");
    chosen = [arguments, &options] {
      if (!arguments->cases_error) {
        check_output_folder(arguments->output_folder);
        check_outputs({arguments->json}, {arguments->plan, arguments->operations});
      }
      return run_plan(*arguments, options);
    };
  });
}

}  // namespace camber::cli
