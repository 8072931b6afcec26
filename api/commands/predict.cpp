#include "api/commands/predict.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <tbb/task_group.h>

#include "api/commands/feed.h"
#include "base/output_file.h"
#include "base/process_memory.h"
#include "base/stage.h"
#include "calib/column_map.h"
#include "calib/trace.h"
#include "calib/traced_motion.h"
#include "checks/plausibility.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "report/feature_results.h"
#include "report/forces_at_csv.h"
#include "report/forces_csv.h"
#include "report/mesh_file.h"
#include "report/report_data.h"
#include "report/spindle_load.h"
#include "report/summary.h"
#include "simulate/chatter.h"
#include "simulate/spindle_power.h"
#include "simulate/turn.h"
#include "simulate/verdict.h"

namespace camber::api {
namespace {

namespace fs = std::filesystem;

/// Times the program once more to write feed.csv, a sample a period; of a trace its own samples.
std::vector<report::PathRow> write_feed(const simulate::SimulatedProgram& program, const simulate::TracedRun* traced,
                                        const machine::Job& job, const std::string& path, Stage& stage) {
  feedmodel::FeedCsv csv(program.text_moves(), path, rotary_columns(program.text_moves(), job.machine));
  const auto write = [&](std::span<const feedmodel::TimedSample> samples,
                         std::span<const feedmodel::JointSample> joints) {
    stage.advance(samples.size());
    joints.empty() ? csv.write(samples) : csv.write(samples, joints);
  };
  std::vector<report::PathRow> rows;
  if (traced) {
    report::PathCollector collector(program.moves);
    write(traced->samples, {});
    collector.add(traced->samples);
    rows = collector.take();
  } else {
    rows = report::rows_of_program(program, job.machine, write);
  }
  csv.commit();
  return rows;
}

/// The trace on the program's moves. Its gaps matter in the cut alone, and are errors there.
calib::TracedMotion read_motion(const simulate::SimulatedProgram& program, const PredictRequest& request,
                                Diagnostics& diagnostics) {
  Diagnostics found;
  const calib::ServoTrace trace =
      request.columns.empty()
          ? calib::read_trace(request.trace, found)
          : calib::read_mapped_trace(request.trace, calib::read_column_map(request.columns, found), found);
  for (const Diagnostic& d : found.all())
    if (d.check != "trace-gap") diagnostics.add(d);
  std::vector<bool> cut = program.selected;
  for (std::size_t i = 0; i < program.holes.size(); ++i) cut[i] = cut[i] || removal::makes_hole(program.holes[i]);
  return calib::traced_motion(trace, program.text, program.moves, cut, diagnostics);
}

/// Gives the program the measured motion; its own goes to the result.
simulate::TracedRun exchange_motion(const machine::Job& job, simulate::SimulatedProgram& program,
                                    const std::string& trace, calib::TracedMotion measured) {
  simulate::TracedRun out{.trace = trace,
                          .by_line = measured.by_line,
                          .period_s = measured.period_s,
                          .off_path_p95_mm = measured.off_path_p95_mm,
                          .off_path_max_mm = measured.off_path_max_mm,
                          .samples = std::move(measured.samples),
                          .model = {},
                          .predicted = {},
                          .difference_um = {}};
  out.model = simulate::motion_at(program, job, out.samples);
  out.model.feed.time_s = measured.time_s;
  out.model.feed.cutting_time_s = measured.cutting_time_s;
  simulate::exchange(program, out.model);
  return out;
}

/// Every thousandth point that is asked for advances the stage.
report::FormErrorPoints counted(report::FormErrorPoints points, Stage& stage) {
  constexpr std::size_t kEvery = 1000;
  return {points.count, [at = std::move(points.at), &stage](std::size_t i) {
            if (i % kEvery == 0) stage.advance(kEvery);
            return at(i);
          }};
}

/// Points of the form error that are asked for, and samples of the feed.
std::size_t work_of_writing(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                            const machine::Job& job) {
  constexpr std::size_t kTimesAsked = 10;
  return kTimesAsked * prediction.surface.size() +
         static_cast<std::size_t>(program.feed.time_s / job.machine.control.period_s);
}

/// What the folder holds but summary.json, side by side. The machined stock is given up once it is saved.
void write_files(const machine::Job& job, const PreparedJob& prepared, simulate::Prediction& prediction,
                 const PredictRequest& request, const Diagnostics& diagnostics) {
  const fs::path folder = request.folder;
  const std::size_t forces_at = request.forces_at;
  const simulate::SimulatedProgram& program = prepared.setup.program;
  const simulate::TracedRun* traced = prepared.traced_run();
  const removal::StockShape stock = removal::stock_shape(*prediction.machined, report::kMaxStockCrossings);
  if (request.meshes) {
    const report::SurfaceMesh mesh = report::machined_mesh(*prediction.machined);
    for (const char* name : {"machined.stl", "machined.ply"}) report::write_mesh(folder / name, mesh);
  }
  Stage stage("writing", work_of_writing(program, prediction, job));
  const report::FormErrorPoints points = counted(report::form_error_points(program, prediction, traced), stage);
  FirstFailure failure;
  tbb::task_group others;
  const auto beside = [&](const auto& write) { others.run([&failure, write] { failure.guard(write); }); };
  beside([&] { report::write_form_error_csv(folder / "form_error.csv", points); });
  beside([&] { report::write_form_error_vtp(folder / "form_error.vtp", points); });
  beside([&] {
    report::write_forces_csv(folder / "forces.csv", job, program, prediction);
    report::write_spindle_load_csv(folder / "spindle_load.csv", report::spindle_loads(job, program, prediction));
    if (forces_at > 0)
      report::write_forces_at_csv(folder / fmt::format("forces_at_{}.csv", forces_at), prediction.cut.turn);
  });
  beside([&] { report::write_form_error_ply(folder / "form_error.ply", points, prediction.form_error_um.p95); });
  if (request.meshes)
    beside([&] {
      report::write_error_mesh(folder / "form_error_mesh.ply", report::error_mesh(points, job.simulation.voxel_mm),
                               prediction.form_error_um.p95);
    });
  const auto features = report::features_of(job, prediction.surface);
  if (!features.empty()) beside([&] { report::write_features_csv(folder / "features.csv", features); });
  failure.guard([&] {
    prediction.machined->unshare();  // what is kept once takes its room again
    prediction.machined->save(folder / "stock.vdb");
    prediction.machined.reset();
    return_freed_memory();
    auto feed = write_feed(program, traced, job, folder / "feed.csv", stage);
    report::ReportData page = report::predict_report(job, program, prediction, stock, std::move(feed), diagnostics);
    report::add_features(page, features, "Features");
    if (traced) report::add_traced(page, program, prediction, *traced, report::rows_of_program(program, job.machine));
    report::write_html_report(folder / "report.html", page);
  });
  others.wait();
  failure.rethrow();
}

void show(const PredictRequest& request, const std::string& what, std::optional<double> share = {}) {
  if (request.progress) request.progress(what, share);
}

}  // namespace

PreparedJob prepare(const machine::Job& job, const PredictRequest& request, Diagnostics& diagnostics) {
  const StageScope stages(request.progress);
  std::optional<calib::TracedMotion> measured;
  const auto check = [&](const simulate::SimulatedProgram& given) {
    checks::check_program(job, given, diagnostics);
    if (!request.trace.empty())
      simulate::refuse_rotary_motion(given.rotary.get(), given.text, "traces are of X, Y and Z", diagnostics);
    if (!request.folder.empty())
      feedmodel::check_feed_csv_size(given.text_moves(), job.machine, request.folder + "/feed.csv", diagnostics);
    diagnostics.throw_if_errors();
    if (!request.trace.empty()) measured = read_motion(given, request, diagnostics);
  };
  Diagnostics of_original;  // a program like the job's: what is to be said of it, the job's own says too
  PreparedJob out{simulate::set_up(job, {.check = check, .clearance = request.trace.empty()},
                                   {.program = diagnostics, .original = of_original, .target = diagnostics},
                                   request.work, request.programs.get()),
                  {}};
  out.setup.original.reset();
  out.setup.target.surface.clear_stamps();  // its points are in the map
  const simulate::SimulatedProgram& program = out.setup.program;
  feedmodel::check_range(program.text_moves(), job.program, job.machine, diagnostics);
  simulate::check_clearance(job, out.setup, diagnostics);
  if (measured) out.traced = exchange_motion(job, out.setup.program, request.trace, *std::move(measured));
  if (request.forces_at > 0)
    out.options.turn_from = simulate::turn_at_line(program, job, request.forces_at, diagnostics);
  return out;
}

simulate::Prediction predict_prepared(const machine::Job& job, PreparedJob& prepared, const PredictRequest& request,
                                      Diagnostics& of_cut) {
  const StageScope stages(request.progress);
  simulate::Setup& setup = prepared.setup;
  prepared.options.progress = [&](double share) { show(request, "cutting", share); };
  prepared.options.surface_read = [&] {
    setup.target.surface.clear();
    // One field again of the blank before and after the allowance, which the machined stock shares.
    setup.target.whole.reset();
    setup.target.blank.share_as_one();
    return_freed_memory();
  };
  if (!prepared.traced) prepared.options.take_map = [&] { return *std::exchange(setup.target.map, std::nullopt); };
  auto prediction = prepared.traced
                        ? simulate::predict_traced(job, setup.target, setup.program, *prepared.traced, prepared.options)
                        : simulate::predict(job, setup.target, setup.program, prepared.options);
  finish_prediction(job, prepared, prediction, of_cut);
  return prediction;
}

void finish_prediction(const machine::Job& job, PreparedJob& prepared, simulate::Prediction& prediction,
                       Diagnostics& of_cut) {
  // Nothing reads them any more, and the files need room.
  prepared.setup.target.blank.clear();
  prepared.setup.target.map.reset();
  prediction.machined->clear_stamps();
  simulate::warn_of_chatter(prepared.setup.program, prediction.chatter, of_cut);
  simulate::check_spindle_power(job.machine, prepared.setup.program, prediction.cut.loads, of_cut);
}

void write_prediction(const machine::Job& job, const PreparedJob& prepared, simulate::Prediction& prediction,
                      const PredictRequest& request, const std::string& summary, const Diagnostics& diagnostics,
                      Diagnostics& failed) {
  const StageScope stages(request.progress);
  const fs::path folder = request.folder;
  try_to_write([&] { write_files(job, prepared, prediction, request, diagnostics); }, failed);
  // The last: where it is new, so is all beside it.
  if (!failed.has_errors()) try_to_write([&] { write_file(folder / "summary.json", summary); }, failed);
}

std::vector<std::string> doubts_of(const machine::Job& job, const simulate::SimulatedProgram& program,
                                   const simulate::Prediction& prediction) {
  std::vector<std::string> wrong = simulate::doubts(job, program, prediction);
  if (std::string unsettled = report::unsettled_sentence(program, prediction); !unsettled.empty())
    wrong.push_back(std::move(unsettled));
  return wrong;
}

}  // namespace camber::api
