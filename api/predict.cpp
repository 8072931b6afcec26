#include "camber/predict.h"

#include "api/feed_points.h"
#include "api/job.h"
#include "api/prediction.h"
#include "base/output_file.h"
#include "report/mesh_file.h"
#include "report/report_data.h"

namespace camber {
namespace {

Mesh mesh_of(const report::SurfaceMesh& mesh) {
  Mesh out;
  out.points.reserve(mesh.vertices.size());
  for (const report::SurfaceSample& v : mesh.vertices)
    out.points.push_back({v.place_mm.x(), v.place_mm.y(), v.place_mm.z(), v.normal.x(), v.normal.y(), v.normal.z(),
                          v.error_um, v.error_um - v.contour_um, v.contour_um, v.block});
  for (const auto& t : report::triangles_of(mesh)) out.triangles.push_back({t[0], t[1], t[2]});
  return out;
}

void add_meshes(const machine::Job& job, const api::PreparedJob& prepared, const simulate::Prediction& prediction,
                PredictResult& result) {
  result.machined_mesh = mesh_of(report::machined_mesh(*prediction.machined));
  result.error_mesh = mesh_of(report::error_mesh(
      report::form_error_points(prepared.setup.program, prediction, prepared.traced_run()), job.simulation.voxel_mm));
}

void add_feed_points(const machine::Job& job, const api::PreparedJob& prepared, PredictResult& result) {
  const simulate::SimulatedProgram& program = prepared.setup.program;
  const feedmodel::SampleSink sink = api::points_sink(program.moves_in_part(), result.feed);
  if (prepared.traced)
    sink(prepared.traced->samples);
  else
    feedmodel::predict_feed(program.moves_of_axes(), job.machine, sink);
}

}  // namespace

PredictResult v0::predict(const Job& given, const PredictOptions& options, const RunOptions& run_options) {
  const machine::Job& job = api::programmed(given);
  PredictResult result;
  api::Run run(run_options);
  run.execute([&] {
    Diagnostics found = given.impl().found;
    api::PreparedJob prepared = api::prepare(job, options, {.progress = run.steps()}, found);
    run.settle_first(found);
    if (!options.output_folder.empty()) make_folder(options.output_folder);
    Diagnostics of_cut;
    auto prediction = api::predict_prepared(job, prepared, run.steps(), of_cut);
    found.append(of_cut);
    run.settle(of_cut);
    if (options.meshes && options.rows) add_meshes(job, prepared, prediction, result);
    if (options.feed) add_feed_points(job, prepared, result);
    api::finish_result({.job = job,
                        .prepared = prepared,
                        .prediction = prediction,
                        .doubts = api::doubts_of(job, prepared.setup.program, prediction)},
                       options, run, found, result);
  });
  return result;
}

}  // namespace camber
