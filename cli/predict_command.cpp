#include "cli/predict_command.h"

#include <chrono>
#include <filesystem>

#include <fmt/format.h>
#include <tbb/task_group.h>

#include "base/freed_memory.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "nc/interpreter.h"
#include "report/forces_at_csv.h"
#include "report/forces_csv.h"
#include "report/report_data.h"
#include "report/summary.h"
#include "simulate/setup.h"
#include "simulate/spindle_power.h"
#include "simulate/turn.h"
#include "simulate/verdict.h"

namespace camber::cli {
namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Times the program once more to write feed.csv, a sample a period.
std::vector<report::PathRow> write_feed(const simulate::SimulatedProgram& program, const machine::Job& job,
                                        const std::string& path) {
  feedmodel::FeedCsv csv(program.moves, path);
  report::PathCollector collector(program.moves);
  feedmodel::predict_feed(program.moves, job.machine, [&](std::span<const feedmodel::TimedSample> samples) {
    csv.write(samples);
    collector.add(samples);
  });
  csv.commit();
  return collector.take();
}

/// What the folder holds but summary.json, side by side. The machined stock is given up once it is saved.
void write_files(const machine::Job& job, const simulate::SimulatedProgram& program, simulate::Prediction& prediction,
                 std::size_t forces_at, const fs::path& folder, const Diagnostics& diagnostics) {
  const removal::StockShape stock = removal::stock_shape(*prediction.machined, report::kMaxStockCrossings);
  const report::FormErrorPoints points = report::form_error_points(program, prediction);
  tbb::task_group others;
  others.run([&] {
    prediction.machined->save(folder / "stock.vdb");
    prediction.machined.reset();
  });
  others.run([&] { report::write_form_error_csv(folder / "form_error.csv", points); });
  others.run([&] { report::write_form_error_vtp(folder / "form_error.vtp", points); });
  others.run([&] {
    report::write_forces_csv(folder / "forces.csv", job, program, prediction);
    if (forces_at > 0)
      report::write_forces_at_csv(folder / fmt::format("forces_at_{}.csv", forces_at), prediction.cut.turn);
  });
  others.run([&] { report::write_form_error_ply(folder / "form_error.ply", points, prediction.form_error_um.p95); });
  others.run_and_wait([&] {
    auto feed = write_feed(program, job, folder / "feed.csv");
    report::write_html_report(folder / "report.html",
                              report::predict_report(job, program, prediction, stock, std::move(feed), diagnostics));
  });
}

}  // namespace

int run_predict(const PredictArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  const auto check = [&](const simulate::SimulatedProgram& given) {
    simulate::check_program(job, given, diagnostics);
    feedmodel::check_feed_csv_size(given.moves, job.machine, arguments.output_folder + "/feed.csv", diagnostics);
    diagnostics.throw_if_errors();
    progress.show("cutting as the target");
  };
  Diagnostics of_original;  // a program like the job's: what is to be said of it, the job's own says too
  simulate::Setup setup =
      simulate::set_up(job, {.check = check}, {.program = diagnostics, .original = of_original, .target = diagnostics});
  setup.original.reset();
  const simulate::SimulatedProgram& program = setup.program;
  feedmodel::check_range(program.moves, job.program, job.machine, diagnostics);
  simulate::PredictOptions predict_options;
  if (arguments.forces_at > 0)
    predict_options.turn_from = simulate::turn_at_line(program, job, arguments.forces_at, diagnostics);
  progress.show("looking for collisions");
  simulate::check_clearance(job, setup, diagnostics);
  progress.clear();
  settle(diagnostics, options);
  print_translation(job.machine.translation, options);
  const fs::path folder = arguments.output_folder;
  make_folder(folder);

  progress.show("cutting", 0);
  predict_options.progress = [&](double share) { progress.show("cutting", share); };
  predict_options.surface_read = [&] {
    setup.target.surface.clear();
    return_freed_memory();
  };
  auto prediction = simulate::predict(job, setup.target, program, predict_options);
  setup.target.blank.clear();  // nothing reads it any more, and the files need room
  Diagnostics of_cut;
  simulate::check_spindle_power(job.machine, program, prediction.cut.loads, of_cut);
  diagnostics.append(of_cut);
  const double compute_s = seconds_since(begin);
  progress.show("writing");

  Diagnostics failed;
  try_to_write([&] { write_files(job, program, prediction, arguments.forces_at, folder, diagnostics); }, failed);
  const std::string json = report::predict_json(program, prediction, compute_s);
  // The last: where it is new, so is all beside it.
  if (!failed.has_errors()) try_to_write([&] { write_file(folder / "summary.json", json); }, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, json); }, failed);
  progress.clear();

  if (!options.quiet) fmt::print("{}", report::predict_text(program, prediction, compute_s));
  failed.throw_if_errors();
  settle(of_cut, options);
  std::vector<std::string> wrong = simulate::doubts(job, program, prediction);
  if (std::string unsettled = report::unsettled_sentence(program, prediction); !unsettled.empty())
    wrong.push_back(std::move(unsettled));
  for (const std::string& sentence : wrong) print_error(sentence);
  return wrong.empty() ? kDone : kNumbersDidNotWorkOut;
}

}  // namespace camber::cli
