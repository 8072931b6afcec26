#include "api/prediction.h"

#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <tbb/task_group.h>

#include "api/feed_points.h"
#include "base/output_file.h"
#include "base/process_memory.h"
#include "base/stage.h"
#include "calib/column_map.h"
#include "calib/trace.h"
#include "calib/traced_motion.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "machine/assumptions.h"
#include "plausibility/plausibility.h"
#include "report/chatter_page.h"
#include "report/feature_results.h"
#include "report/figures_json.h"
#include "report/forces_csv.h"
#include "report/mesh_file.h"
#include "report/report_data.h"
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
  feedmodel::FeedCsv csv(program.moves_in_program(), path, rotary_columns(program.moves_in_program(), job.machine));
  const auto write = [&](std::span<const feedmodel::TimedSample> samples,
                         std::span<const feedmodel::JointSample> joints) {
    stage.advance(samples.size());
    joints.empty() ? csv.write(samples) : csv.write(samples, joints);
  };
  std::vector<report::PathRow> rows;
  if (traced) {
    report::PathCollector collector(program.moves_in_part());
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
calib::TracedMotion read_motion(const simulate::SimulatedProgram& program, const PredictOptions& options,
                                Diagnostics& diagnostics) {
  Diagnostics found;
  const calib::ServoTrace trace =
      options.columns.empty()
          ? calib::read_trace(options.trace, found)
          : calib::read_mapped_trace(options.trace, calib::read_column_map(options.columns, found), found);
  for (const Diagnostic& d : found.all())
    if (d.check != "trace-gap") diagnostics.add(d);
  std::vector<bool> cut = program.selected;
  for (std::size_t i = 0; i < program.holes.size(); ++i) cut[i] = cut[i] || removal::makes_hole(program.holes[i]);
  return calib::traced_motion(trace, program.text(), program.moves_in_part(), cut, diagnostics);
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
  out.model = motion::motion_at(program, job, out.samples);
  out.model.feed.time_s = measured.time_s;
  out.model.feed.cutting_time_s = measured.cutting_time_s;
  motion::exchange(program, out.model);
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

/// Writes all files of the folder but summary.json, side by side. The machined stock is given up once it is saved.
void write_files(const machine::Job& job, const PreparedJob& prepared, simulate::Prediction& prediction,
                 const PredictOptions& options, const Diagnostics& diagnostics) {
  const fs::path folder = options.output_folder;
  const std::size_t forces_at = options.forces_at;
  const simulate::SimulatedProgram& program = prepared.setup.program;
  const simulate::TracedRun* traced = prepared.traced_run();
  const removal::StockShape stock = removal::stock_shape(*prediction.machined, report::kMaxStockCrossings);
  if (options.meshes) {
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
  if (options.meshes)
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

}  // namespace

PreparedJob prepare(const machine::Job& job, const PredictOptions& options, const PredictionWork& given,
                    Diagnostics& diagnostics) {
  const StageScope stages(given.progress);
  std::optional<calib::TracedMotion> measured;
  const auto check = [&](const simulate::SimulatedProgram& program) {
    plausibility::check_program(job, program, diagnostics);
    if (!options.trace.empty()) kinematics::refuse_rotary_motion(program, "traces are of X, Y and Z", diagnostics);
    if (!options.output_folder.empty())
      feedmodel::check_feed_csv_size(program.moves_in_program(), job.machine, options.output_folder + "/feed.csv",
                                     diagnostics);
    diagnostics.throw_if_errors();
    if (!options.trace.empty()) measured = read_motion(program, options, diagnostics);
  };
  Diagnostics of_original;  // a program like the job's: what is to be said of it, the job's own says too
  PreparedJob out{simulate::set_up(job, {.check = check, .clearance = options.trace.empty()},
                                   {.program = diagnostics, .original = of_original, .target = diagnostics}, given.work,
                                   given.programs.get()),
                  {}};
  out.setup.original.reset();
  out.setup.target.surface.clear_stamps();  // its points are in the map
  const simulate::SimulatedProgram& program = out.setup.program;
  feedmodel::check_range(program.moves_in_program(), job.program, job.machine, diagnostics);
  simulate::check_clearance(job, out.setup, diagnostics);
  if (measured) out.traced = exchange_motion(job, out.setup.program, options.trace, *std::move(measured));
  if (options.forces_at > 0)
    out.options.turn_from = simulate::turn_at_line(program, job, options.forces_at, diagnostics);
  return out;
}

simulate::Prediction predict_prepared(const machine::Job& job, PreparedJob& prepared, const StepProgress& progress,
                                      Diagnostics& of_cut) {
  const StageScope stages(progress);
  simulate::Setup& setup = prepared.setup;
  prepared.options.progress = [&](double share) {
    if (progress) progress("cutting", share);
  };
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

ErrorFigures figures_of(const removal::ErrorFigures& f) { return {f.min, f.max, f.mean, f.rms, f.p95, f.area_mm2}; }

namespace {

ForceRow row_of(const report::ForceRow& r) {
  return {.t_s = r.t_s,
          .x_mm = r.tip_mm.x(),
          .y_mm = r.tip_mm.y(),
          .z_mm = r.tip_mm.z(),
          .fx_max_N = r.force_max_N.x(),
          .fy_max_N = r.force_max_N.y(),
          .fz_max_N = r.force_max_N.z(),
          .f_max_N = r.lateral_max_N,
          .fx_mean_N = r.force_mean_N.x(),
          .fy_mean_N = r.force_mean_N.y(),
          .fz_mean_N = r.force_mean_N.z(),
          .dx_um = r.deflection_um.x(),
          .dy_um = r.deflection_um.y(),
          .dz_um = r.deflection_um.z(),
          .mrr_mm3_per_s = r.mrr_mm3_per_s,
          .removed_mm3 = r.removed_mm3,
          .torque_max_Nm = r.torque_max_Nm,
          .torque_mean_Nm = r.torque_mean_Nm,
          .power_W = r.power_W,
          .h_max_mm = r.chip_max_mm,
          .h_mean_mm = r.chip_mean_mm,
          .specific_energy_MPa = r.specific_energy_MPa,
          .block = static_cast<std::int64_t>(r.line),
          .f_axial_max_N = r.axial_max_N,
          .valid = r.valid,
          .chatter_margin = r.chatter_margin,
          .chatter_hz = r.chatter_hz};
}

std::vector<ErrorPoint> points_of(const report::FormErrorPoints& points) {
  std::vector<ErrorPoint> out;
  out.reserve(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    const report::FormErrorPoint p = points.at(i);
    out.push_back({p.place_mm.x(), p.place_mm.y(), p.place_mm.z(), p.normal.x(), p.normal.y(), p.normal.z(), p.error_um,
                   p.deflection_um(), p.contour_um, p.total_error_um, p.model_error_um, p.area_mm2, p.block, p.tool,
                   p.valid, p.tool_um(), p.part_yields() ? p.part_um : 0});
  }
  return out;
}

TraceComparison comparison_of(const simulate::TracedRun& t) {
  return {.by_line = t.by_line,
          .samples = static_cast<std::int64_t>(t.samples.size()),
          .period_s = t.period_s,
          .machine_time_s = t.model.feed.time_s,
          .off_path_p95_um = 1000 * t.off_path_p95_mm,
          .off_path_max_um = 1000 * t.off_path_max_mm,
          .form_error_um = figures_of(t.predicted.form_error_um),
          .difference_um = figures_of(t.difference_um)};
}

void add_rows(const FinishedPrediction& done, PredictResult& out) {
  const simulate::SimulatedProgram& program = done.prepared.setup.program;
  const simulate::Prediction& p = done.prediction;
  out.form_error = points_of(report::form_error_points(program, p, done.prepared.traced_run()));
  report::for_each_force_row(done.job, program, p,
                             [&](const report::ForceRow& row) { out.forces.push_back(row_of(row)); });
  for (const report::SpindleLoad& l : report::spindle_loads(done.job, program, p))
    out.spindle_load.push_back({l.tool, static_cast<std::int64_t>(l.line), l.power_W, l.torque_Nm});
}

void add_figures(const FinishedPrediction& done, PredictResult& out) {
  const simulate::SimulatedProgram& program = done.prepared.setup.program;
  const simulate::Prediction& p = done.prediction;
  out.machine_time_s = program.feed.time_s;
  out.cutting_time_s = program.feed.cutting_time_s;
  out.force_max_N = report::largest_force_N(p);
  out.chips_mm3 = report::chips_mm3(p);
  out.stock_mm3 = p.cut.stock_mm3;
  out.form_error_um = figures_of(p.form_error_um);
  out.deflection_um = figures_of(p.deflection_um);
  out.contour_um = figures_of(p.contour_um);
  out.tool_deflection_um = p.deflection_parts_um ? figures_of(p.deflection_parts_um->tool_um) : out.deflection_um;
  if (p.deflection_parts_um) out.part_deflection_um = figures_of(p.deflection_parts_um->part_um);
  out.unseen_mm2 = p.unseen_mm2;
  out.doubts = done.doubts;
  if (done.prepared.traced) out.trace = comparison_of(*done.prepared.traced);
}

}  // namespace

void finish_result(const FinishedPrediction& done, const PredictOptions& options, Run& run, const Diagnostics& found,
                   PredictResult& result) {
  const simulate::SimulatedProgram& program = done.prepared.setup.program;
  const simulate::Prediction& prediction = done.prediction;
  const simulate::TracedRun* traced = done.prepared.traced_run();
  const double compute_s = run.seconds();
  add_figures(done, result);
  if (options.rows) add_rows(done, result);
  const std::vector<std::string> assumed = machine::assumptions(done.job);
  const auto features = report::features_of(done.job, prediction.surface);
  std::string json = report::predict_json(program, prediction, compute_s, traced, done.doubts);
  if (done.with_more) json = done.with_more(json);
  result.json = machine::with_assumptions(report::with_features(std::move(json), {{"features", features}}), assumed);
  result.printed = machine::assumptions_text(assumed) + report::predict_text(program, prediction, compute_s, traced) +
                   report::features_text(features);
  if (options.explain) result.printed += report::chatter_explanation(done.job, prediction.chatter);
  result.diagnostics = found.all();
  if (!options.stock.empty()) prediction.machined->save(options.stock);
  if (options.output_folder.empty()) return;
  const StageScope stages(run.steps());
  Diagnostics failed;
  try_to_write([&] { write_files(done.job, done.prepared, done.prediction, options, found); }, failed);
  // The last: where it is new, so is all beside it.
  if (!failed.has_errors())
    try_to_write([&] { write_file(fs::path(options.output_folder) / "summary.json", result.json); }, failed);
  if (options.throw_if_unwritten) failed.throw_if_errors();
  result.unwritten = failed.all();
}

std::vector<std::string> doubts_of(const machine::Job& job, const simulate::SimulatedProgram& program,
                                   const simulate::Prediction& prediction) {
  std::vector<std::string> wrong = simulate::doubts(job, program, prediction);
  if (std::string unsettled = report::unsettled_sentence(program, prediction); !unsettled.empty())
    wrong.push_back(std::move(unsettled));
  return wrong;
}

}  // namespace camber::api
