#include "camber/predict.h"

#include <chrono>
#include <limits>
#include <optional>

#include "api/commands/predict.h"
#include "api/error_figures.h"
#include "api/feed_points.h"
#include "api/job.h"
#include "api/predict_result.h"
#include "api/run.h"
#include "base/output_file.h"
#include "machine/assumptions.h"
#include "report/feature_results.h"
#include "report/forces_csv.h"
#include "report/mesh_file.h"
#include "report/report_data.h"
#include "report/spindle_load.h"
#include "report/summary.h"

namespace camber {
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

Mesh mesh_of(const report::SurfaceMesh& mesh) {
  Mesh out;
  out.points.reserve(mesh.vertices.size());
  for (const report::SurfaceSample& v : mesh.vertices)
    out.points.push_back({v.place_mm.x(), v.place_mm.y(), v.place_mm.z(), v.normal.x(), v.normal.y(), v.normal.z(),
                          v.error_um, v.error_um - v.contour_um, v.contour_um, v.block});
  for (const auto& t : report::triangles_of(mesh)) out.triangles.push_back({t[0], t[1], t[2]});
  return out;
}

TraceComparison comparison_of(const simulate::TracedRun& t) {
  return {.by_line = t.by_line,
          .samples = static_cast<std::int64_t>(t.samples.size()),
          .period_s = t.period_s,
          .machine_time_s = t.model.feed.time_s,
          .off_path_p95_um = 1000 * t.off_path_p95_mm,
          .off_path_max_um = 1000 * t.off_path_max_mm,
          .form_error_um = api::figures_of(t.predicted.form_error_um),
          .difference_um = api::figures_of(t.difference_um)};
}

}  // namespace

PredictResult api::result_of(const machine::Job& job, const PreparedJob& prepared, const simulate::Prediction& p) {
  const simulate::SimulatedProgram& program = prepared.setup.program;
  PredictResult out{.machine_time_s = program.feed.time_s,
                    .cutting_time_s = program.feed.cutting_time_s,
                    .chips_mm3 = report::chips_mm3(p),
                    .stock_mm3 = p.cut.stock_mm3,
                    .form_error_um = api::figures_of(p.form_error_um),
                    .deflection_um = api::figures_of(p.deflection_um),
                    .contour_um = api::figures_of(p.contour_um),
                    .unseen_mm2 = p.unseen_mm2,
                    .form_error = points_of(report::form_error_points(program, p, prepared.traced_run())),
                    .doubts = api::doubts_of(job, program, p)};
  out.tool_deflection_um = p.deflection_parts_um ? api::figures_of(p.deflection_parts_um->tool_um) : out.deflection_um;
  if (p.deflection_parts_um) out.part_deflection_um = api::figures_of(p.deflection_parts_um->part_um);
  if (prepared.traced) out.trace = comparison_of(*prepared.traced);
  out.force_max_N = report::largest_force_N(p);
  report::for_each_force_row(job, program, p, [&](const report::ForceRow& row) { out.forces.push_back(row_of(row)); });
  for (const report::SpindleLoad& l : report::spindle_loads(job, program, p))
    out.spindle_load.push_back({l.tool, static_cast<std::int64_t>(l.line), l.power_W, l.torque_Nm});
  return out;
}

PredictResult v0::predict(const Job& given, const PredictOptions& options, const RunOptions& run_options) {
  const auto begin = std::chrono::steady_clock::now();
  const machine::Job& job = api::programmed(given);
  PredictResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = given.impl().found;
    const api::PredictRequest request{
        .folder = options.output_folder,
        .forces_at = options.forces_at,
        .trace = options.trace,
        .columns = options.columns,
        .meshes = options.meshes,
        .progress = [&](const std::string& what, std::optional<double> share) { run.show(what, share.value_or(0)); }};
    api::PreparedJob prepared = api::prepare(job, request, found);
    run.settle(found);
    if (!request.folder.empty()) make_folder(request.folder);
    Diagnostics of_cut;
    auto prediction = api::predict_prepared(job, prepared, request, of_cut);
    found.append(of_cut);
    run.settle(of_cut);
    const simulate::SimulatedProgram& program = prepared.setup.program;
    result = api::result_of(job, prepared, prediction);
    if (options.meshes) {
      result.machined_mesh = mesh_of(report::machined_mesh(*prediction.machined));
      result.error_mesh = mesh_of(report::error_mesh(
          report::form_error_points(program, prediction, prepared.traced_run()), job.simulation.voxel_mm));
    }
    if (options.feed && prepared.traced)
      api::points_sink(program.moves_in_part(), result.feed)(prepared.traced->samples);
    else if (options.feed && program.turns())
      feedmodel::predict_feed(program.moves_of_axes(), job.machine,
                              api::points_sink(program.moves_in_part(), result.feed));
    else if (options.feed)
      feedmodel::predict_feed(program.moves_in_part(), job.machine,
                              api::points_sink(program.moves_in_part(), result.feed));
    const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    result.json = machine::with_assumptions(
        report::with_features(
            report::predict_json(program, prediction, compute_s, prepared.traced_run(), result.doubts),
            {{"features", report::features_of(job, prediction.surface)}}),
        machine::assumptions(job));
    result.diagnostics = found.all();
    if (request.folder.empty()) return;
    Diagnostics failed;
    api::write_prediction(job, prepared, prediction, request, result.json, found, failed);
    failed.throw_if_errors();
  });
  return result;
}

}  // namespace camber
