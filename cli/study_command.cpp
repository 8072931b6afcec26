#include "cli/study_command.h"

#include <new>

#include <fmt/format.h>

#include "api/commands/study.h"
#include "base/output_file.h"
#include "cli/adapt_command.h"
#include "cli/compensate_command.h"
#include "cli/console.h"
#include "cli/predict_command.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

/// The command of a case, as its command line would run it. Returns its exit status.
int run_case(const api::StudyPlan& plan, const api::PlannedCase& one, const GlobalOptions& options) {
  switch (plan.study.command) {
    case machine::StudyCommand::compensate: {
      CompensateArguments arguments;
      arguments.job = one.job_path, arguments.output = one.output;
      arguments.report = one.report_path, arguments.json = one.json_path;
      return run_compensate(arguments, options);
    }
    case machine::StudyCommand::adapt: {
      AdaptArguments arguments;
      arguments.job = one.job_path, arguments.output = one.output;
      arguments.report = one.report_path, arguments.json = one.json_path;
      return run_adapt(arguments, options);
    }
    case machine::StudyCommand::predict:
      break;
  }
  PredictArguments arguments;
  arguments.job = one.job_path, arguments.output_folder = one.output;
  return run_predict(arguments, options);
}

/// A case whose input is wrong does not end the study.
int guarded_case(const api::StudyPlan& plan, const api::PlannedCase& one, const GlobalOptions& options) {
  try {
    return run_case(plan, one, options);
  } catch (const InputError& problem) {
    print_diagnostics(problem.diagnostics(), options);
  } catch (const std::bad_alloc&) {
    print_error(fmt::format("not enough memory for {} [memory]", one.job_path));
  }
  return kInputWrong;
}

}  // namespace

int run_study(const StudyArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  const api::StudyPlan plan = api::plan_study(arguments.study, arguments.output_folder, diagnostics);
  settle(diagnostics, options);
  std::size_t failed = 0;
  if (arguments.list) {
    for (const api::PlannedCase& one : plan.cases)
      if (!one.done()) fmt::print("{}\n", api::command_line(plan, one));
  } else {
    GlobalOptions of_case = options;
    of_case.quiet = true;
    ProgressLine progress(options, "studying");
    for (std::size_t i = 0; i < plan.cases.size(); ++i) {
      progress.show_whole(fmt::format("case {} of {}", i + 1, plan.cases.size()),
                          static_cast<double>(i) / static_cast<double>(plan.cases.size()));
      const api::PlannedCase& one = plan.cases[i];
      if (!one.done() && guarded_case(plan, one, of_case) == kInputWrong) ++failed;
    }
    progress.clear();
  }
  const report::StudyTable table = api::study_table(plan);
  api::write_study(plan, table);
  if (!arguments.json.empty()) write_file(arguments.json, report::study_json(table));
  if (!arguments.list && !options.quiet) fmt::print("{}", report::study_text(table));
  if (failed > 0) {
    print_error(fmt::format("{} of {} cases could not be computed; the same command tries them again", failed,
                            plan.cases.size()));
    return kInputWrong;
  }
  const std::size_t doubtful = table.count(report::StudyState::doubtful);
  if (doubtful == 0 || arguments.list) return kDone;
  print_error(
      fmt::format("in {} of {} cases the numbers did not work out; their pages say why", doubtful, plan.cases.size()));
  return kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
