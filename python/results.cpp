// What the functions return: figures as attributes, rows as numpy arrays that share the result's memory.
#include <memory>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "camber/camber.h"
#include "parts.h"

namespace py = pybind11;

namespace camber_python {
namespace {

/// One field of all rows of `owner`'s vector: a read-only view with the row's size as its stride. It keeps `owner`
/// alive; nothing is copied.
template <class Row, class Field>
pybind11::array column(const pybind11::object& owner, const std::vector<Row>& rows, Field Row::*field) {
  const Field* first = rows.empty() ? nullptr : &(rows.front().*field);
  pybind11::array_t<Field> view({rows.size()}, {sizeof(Row)}, first, owner);
  view.attr("setflags")(pybind11::arg("write") = false);
  return view;
}

/// Three double fields that stand behind each other, as an array of (n, 3); otherwise as column().
template <class Row>
pybind11::array vectors(const pybind11::object& owner, const std::vector<Row>& rows, double Row::*first) {
  const double* at = rows.empty() ? nullptr : &(rows.front().*first);
  pybind11::array_t<double> view({rows.size(), std::size_t{3}}, {sizeof(Row), sizeof(double)}, at, owner);
  view.attr("setflags")(pybind11::arg("write") = false);
  return view;
}

/// The rows of a result as an object with an attribute for each column.
template <class Row>
struct ColumnTable {
  pybind11::object owner;  ///< the Python object of the result
  const std::vector<Row>* rows = nullptr;
};

template <class Row>
class TableClass {
 public:
  TableClass(pybind11::module_& module, const char* name) : class_(module, name) {
    class_.def("__len__", [](const ColumnTable<Row>& t) { return t.rows->size(); });
    class_.def_property_readonly_static("columns", [names = names_](const pybind11::object&) { return *names; });
  }
  /// (n, 3): three fields that stand behind each other in a row, "x_mm", "y_mm", "z_mm".
  TableClass& add_vectors(const char* name, double Row::*first) {
    class_.def_property_readonly(name, [first](const ColumnTable<Row>& t) { return vectors(t.owner, *t.rows, first); });
    return *this;
  }
  template <class Field>
  TableClass& add(const char* name, Field Row::*field) {
    names_->emplace_back(name);
    class_.def_property_readonly(name, [field](const ColumnTable<Row>& t) { return column(t.owner, *t.rows, field); });
    return *this;
  }

 private:
  pybind11::class_<ColumnTable<Row>> class_;
  std::shared_ptr<std::vector<std::string>> names_ = std::make_shared<std::vector<std::string>>();
};

/// Binds the members of every result: `json`, the same parsed as `figures`, and `diagnostics`.
template <class Result>
py::class_<Result> result_class(py::module_& module, const char* name) {
  return py::class_<Result>(module, name)
      .def_readonly("json", &Result::json, "All figures, as --json of the command line writes them.")
      .def_property_readonly(
          "figures", [](const Result& r) { return py::module_::import("json").attr("loads")(r.json); },
          "json as a dictionary.")
      .def_readonly("diagnostics", &Result::diagnostics, "Warnings.");
}

/// A property that is a table of the result's rows.
template <class Result, class Row>
void add_table(py::class_<Result>& of, const char* name, std::vector<Row> Result::*rows) {
  of.def_property_readonly(name, [rows](const py::object& self) {
    return ColumnTable<Row>{self, &(self.cast<const Result&>().*rows)};
  });
}

void add_tables(py::module_& module) {
  using camber::CompensatedPoint, camber::ErrorPoint, camber::FeedPoint, camber::ForceRow;
  TableClass<FeedPoint>(module, "FeedPoints")
      .add("t_s", &FeedPoint::t_s)
      .add("block", &FeedPoint::block)
      .add("x_mm", &FeedPoint::x_mm)
      .add("y_mm", &FeedPoint::y_mm)
      .add("z_mm", &FeedPoint::z_mm)
      .add("vx_mm_per_min", &FeedPoint::vx_mm_per_min)
      .add("vy_mm_per_min", &FeedPoint::vy_mm_per_min)
      .add("vz_mm_per_min", &FeedPoint::vz_mm_per_min)
      .add("feed_cmd_mm_per_min", &FeedPoint::feed_cmd_mm_per_min)
      .add("feed_mm_per_min", &FeedPoint::feed_mm_per_min)
      .add_vectors("points", &FeedPoint::x_mm);
  TableClass<camber::PosePoint>(module, "PosePoints")
      .add("a_deg", &camber::PosePoint::a_deg)
      .add("b_deg", &camber::PosePoint::b_deg)
      .add("c_deg", &camber::PosePoint::c_deg)
      .add("tip_x_mm", &camber::PosePoint::tip_x_mm)
      .add("tip_y_mm", &camber::PosePoint::tip_y_mm)
      .add("tip_z_mm", &camber::PosePoint::tip_z_mm)
      .add("axis_x", &camber::PosePoint::axis_x)
      .add("axis_y", &camber::PosePoint::axis_y)
      .add("axis_z", &camber::PosePoint::axis_z);
  TableClass<ForceRow>(module, "ForceRows")
      .add("t_s", &ForceRow::t_s)
      .add("block", &ForceRow::block)
      .add("x_mm", &ForceRow::x_mm)
      .add("y_mm", &ForceRow::y_mm)
      .add("z_mm", &ForceRow::z_mm)
      .add("fx_max_N", &ForceRow::fx_max_N)
      .add("fy_max_N", &ForceRow::fy_max_N)
      .add("fz_max_N", &ForceRow::fz_max_N)
      .add("f_max_N", &ForceRow::f_max_N)
      .add("fx_mean_N", &ForceRow::fx_mean_N)
      .add("fy_mean_N", &ForceRow::fy_mean_N)
      .add("fz_mean_N", &ForceRow::fz_mean_N)
      .add("dx_um", &ForceRow::dx_um)
      .add("dy_um", &ForceRow::dy_um)
      .add("dz_um", &ForceRow::dz_um)
      .add("mrr_mm3_per_s", &ForceRow::mrr_mm3_per_s)
      .add("removed_mm3", &ForceRow::removed_mm3)
      .add("torque_max_Nm", &ForceRow::torque_max_Nm)
      .add("torque_mean_Nm", &ForceRow::torque_mean_Nm)
      .add("power_W", &ForceRow::power_W)
      .add("h_max_mm", &ForceRow::h_max_mm)
      .add("h_mean_mm", &ForceRow::h_mean_mm)
      .add("specific_energy_MPa", &ForceRow::specific_energy_MPa)
      .add("f_axial_max_N", &ForceRow::f_axial_max_N)
      .add("valid", &ForceRow::valid)
      .add("chatter_margin", &ForceRow::chatter_margin)
      .add("chatter_Hz", &ForceRow::chatter_hz)
      .add_vectors("points", &ForceRow::x_mm);
  TableClass<ErrorPoint>(module, "ErrorPoints")
      .add("x_mm", &ErrorPoint::x_mm)
      .add("y_mm", &ErrorPoint::y_mm)
      .add("z_mm", &ErrorPoint::z_mm)
      .add("nx", &ErrorPoint::nx)
      .add("ny", &ErrorPoint::ny)
      .add("nz", &ErrorPoint::nz)
      .add("error_um", &ErrorPoint::error_um)
      .add("deflection_um", &ErrorPoint::deflection_um)
      .add("contour_um", &ErrorPoint::contour_um)
      .add("total_error_um", &ErrorPoint::total_error_um)
      .add("model_error_um", &ErrorPoint::model_error_um)
      .add("area_mm2", &ErrorPoint::area_mm2)
      .add("block", &ErrorPoint::block)
      .add("tool", &ErrorPoint::tool)
      .add("valid", &ErrorPoint::valid)
      .add("tool_deflection_um", &ErrorPoint::tool_deflection_um)
      .add("part_deflection_um", &ErrorPoint::part_deflection_um)
      .add_vectors("points", &ErrorPoint::x_mm)
      .add_vectors("normals", &ErrorPoint::nx);
  TableClass<CompensatedPoint>(module, "CompensatedPoints")
      .add("x_mm", &CompensatedPoint::x_mm)
      .add("y_mm", &CompensatedPoint::y_mm)
      .add("z_mm", &CompensatedPoint::z_mm)
      .add("nx", &CompensatedPoint::nx)
      .add("ny", &CompensatedPoint::ny)
      .add("nz", &CompensatedPoint::nz)
      .add("before_um", &CompensatedPoint::before_um)
      .add("after_um", &CompensatedPoint::after_um)
      .add("area_mm2", &CompensatedPoint::area_mm2)
      .add_vectors("points", &CompensatedPoint::x_mm)
      .add_vectors("normals", &CompensatedPoint::nx);
  using camber::SpindleLoadRow;
  TableClass<SpindleLoadRow>(module, "SpindleLoads")
      .add("tool", &SpindleLoadRow::tool)
      .add("line", &SpindleLoadRow::line)
      .add("power_W", &SpindleLoadRow::power_W)
      .add("torque_Nm", &SpindleLoadRow::torque_Nm);
}

/// (m, 3) of point indices, as matplotlib takes them.
py::array triangles_of(const py::object& owner, const camber::Mesh& mesh) {
  const auto& rows = mesh.triangles;
  py::array_t<std::int64_t> view({rows.size(), std::size_t{3}}, {sizeof(camber::MeshTriangle), sizeof(std::int64_t)},
                                 rows.empty() ? nullptr : &rows.front().a, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

/// The same flat, each with its number of points before it, as PyVista takes them.
py::array faces_of(const camber::Mesh& mesh) {
  py::array_t<std::int64_t> out(static_cast<py::ssize_t>(4 * mesh.triangles.size()));
  std::int64_t* at = out.mutable_data();
  for (const auto& t : mesh.triangles)
    for (const std::int64_t v : {std::int64_t{3}, t.a, t.b, t.c}) *at++ = v;
  return out;
}

/// A mesh of a result; its arrays share the result's memory.
struct MeshView {
  py::object owner;
  const camber::Mesh* mesh = nullptr;
};

void add_mesh(py::module_& module) {
  using camber::MeshPoint;
  py::class_<MeshView> view(module, "Mesh",
                            "Triangles for PyVista (points, faces) and matplotlib (points, triangles).");
  const auto add = [&](const char* name, auto field) {
    view.def_property_readonly(name, [field](const MeshView& m) { return column(m.owner, m.mesh->points, field); });
  };
  view.def("__len__", [](const MeshView& m) { return m.mesh->points.size(); })
      .def_property_readonly("points",
                             [](const MeshView& m) { return vectors(m.owner, m.mesh->points, &MeshPoint::x_mm); })
      .def_property_readonly("normals",
                             [](const MeshView& m) { return vectors(m.owner, m.mesh->points, &MeshPoint::nx); })
      .def_property_readonly("triangles", [](const MeshView& m) { return triangles_of(m.owner, *m.mesh); })
      .def_property_readonly("faces", [](const MeshView& m) { return faces_of(*m.mesh); });
  add("error_um", &MeshPoint::error_um);
  add("deflection_um", &MeshPoint::deflection_um);
  add("contour_um", &MeshPoint::contour_um);
  add("block", &MeshPoint::block);
}

void add_check(py::module_& module) {
  using camber::CheckResult, camber::ToolUse;
  py::class_<camber::Box>(module, "Box")
      .def_readonly("min_mm", &camber::Box::min_mm)
      .def_readonly("max_mm", &camber::Box::max_mm);
  py::class_<ToolUse>(module, "ToolUse")
      .def_readonly("tool", &ToolUse::tool)
      .def_readonly("line", &ToolUse::line)
      .def_readonly("calls", &ToolUse::calls)
      .def_readonly("cutting_moves", &ToolUse::cutting_moves)
      .def_readonly("cutting_length_mm", &ToolUse::cutting_length_mm)
      .def_readonly("rapid_length_mm", &ToolUse::rapid_length_mm)
      .def_readonly("cutting", &ToolUse::cutting);
  result_class<CheckResult>(module, "CheckResult")
      .def_readonly("blocks", &CheckResult::blocks)
      .def_readonly("blocks_with_words", &CheckResult::blocks_with_words)
      .def_readonly("rapids", &CheckResult::rapids)
      .def_readonly("lines", &CheckResult::lines)
      .def_readonly("arcs", &CheckResult::arcs)
      .def_readonly("dwells", &CheckResult::dwells)
      .def_readonly("rotary_moves", &CheckResult::rotary_moves)
      .def_readonly("cutting_length_mm", &CheckResult::cutting_length_mm)
      .def_readonly("rapid_length_mm", &CheckResult::rapid_length_mm)
      .def_readonly("dwell_s", &CheckResult::dwell_s)
      .def_readonly("cutting", &CheckResult::cutting)
      .def_readonly("rapid", &CheckResult::rapid)
      .def_readonly("tools", &CheckResult::tools)
      .def_readonly("memory_GB", &CheckResult::memory_GB);
}

void add_explain_kinematics(py::module_& module) {
  using camber::ChainAxis, camber::KinematicsExplanation;
  py::class_<ChainAxis>(module, "ChainAxis")
      .def_readonly("letter", &ChainAxis::letter)
      .def_readonly("rotary", &ChainAxis::rotary)
      .def_readonly("table", &ChainAxis::table)
      .def_readonly("positive", &ChainAxis::positive)
      .def_readonly("limits", &ChainAxis::limits);
  result_class<KinematicsExplanation>(module, "KinematicsExplanation")
      .def_readonly("machine_type", &KinematicsExplanation::machine_type)
      .def_readonly("drawing", &KinematicsExplanation::drawing)
      .def_readonly("axes", &KinematicsExplanation::axes)
      .def_readonly("reach", &KinematicsExplanation::reach)
      .def_readonly("text", &KinematicsExplanation::text);
}

void add_sections(py::module_& module) {
  using camber::SectionResult;
  py::class_<SectionResult>(module, "SectionResult")
      .def_readonly("part", &SectionResult::part)
      .def_readonly("computed", &SectionResult::computed)
      .def_readonly("stamps", &SectionResult::stamps)
      .def_readonly("voxels", &SectionResult::voxels)
      .def_readonly("solved_again", &SectionResult::solved_again)
      .def_readonly("diagnostics", &SectionResult::diagnostics);
}

void add_study(py::module_& module) {
  using camber::Study, camber::StudyCase;
  py::class_<StudyCase>(module, "StudyCase")
      .def_readonly("hash", &StudyCase::hash)
      .def_readonly("job_path", &StudyCase::job_path)
      .def_readonly("folder", &StudyCase::folder)
      .def_readonly("output", &StudyCase::output)
      .def_readonly("report", &StudyCase::report)
      .def_readonly("json", &StudyCase::json)
      .def_readonly("values", &StudyCase::values)
      .def_readonly("done", &StudyCase::done);
  result_class<Study>(module, "Study")
      .def_readonly("command", &Study::command)
      .def_readonly("keys", &Study::keys)
      .def_readonly("cases", &Study::cases)
      .def_readonly("csv", &Study::csv)
      .def_readonly("page", &Study::page);
}

void add_feed_and_time(py::module_& module) {
  using camber::FeedResult, camber::TimeResult, camber::TimeUse;
  auto feed = result_class<FeedResult>(module, "FeedResult")
                  .def_readonly("time_s", &FeedResult::time_s)
                  .def_readonly("cutting_time_s", &FeedResult::cutting_time_s)
                  .def_readonly("blocks", &FeedResult::blocks);
  add_table(feed, "points", &FeedResult::points);
  add_table(feed, "poses", &FeedResult::poses);
  py::class_<TimeUse>(module, "TimeUse")
      .def_readonly("tool", &TimeUse::tool)
      .def_readonly("tool_changes", &TimeUse::tool_changes)
      .def_readonly("cutting_moves", &TimeUse::cutting_moves)
      .def_readonly("cutting_s", &TimeUse::cutting_s)
      .def_readonly("positioning_s", &TimeUse::positioning_s)
      .def_readonly("spindle_s", &TimeUse::spindle_s)
      .def_readonly("tool_change_s", &TimeUse::tool_change_s)
      .def_readonly("m_code_s", &TimeUse::m_code_s)
      .def_readonly("dwell_s", &TimeUse::dwell_s)
      .def_readonly("index_s", &TimeUse::index_s)
      .def_readonly("pallet_s", &TimeUse::pallet_s)
      .def_readonly("total_s", &TimeUse::total_s)
      .def_readonly("cutting_length_mm", &TimeUse::cutting_length_mm)
      .def_readonly("positioning_length_mm", &TimeUse::positioning_length_mm)
      .def_readonly("commanded_feed_mm_per_min", &TimeUse::commanded_feed_mm_per_min)
      .def_readonly("average_feed_mm_per_min", &TimeUse::average_feed_mm_per_min)
      .def_readonly("e", &TimeUse::e)
      .def_readonly("k", &TimeUse::k);
  result_class<TimeResult>(module, "TimeResult")
      .def_readonly("all", &TimeResult::all)
      .def_readonly("tools", &TimeResult::tools)
      .def_readonly("sweep", &TimeResult::sweep)
      .def_readonly("notes", &TimeResult::notes);
}

void add_fit(py::module_& module) {
  using camber::FitFeedResult, camber::FitParameter;
  py::class_<FitParameter>(module, "FitParameter")
      .def_readonly("name", &FitParameter::name)
      .def_readonly("value", &FitParameter::value)
      .def_readonly("unit", &FitParameter::unit)
      .def_readonly("std_error", &FitParameter::std_error)
      .def_readonly("note", &FitParameter::note)
      .def_readonly("written", &FitParameter::written)
      .def_readonly("stretches", &FitParameter::stretches)
      .def_readonly("changed_from", &FitParameter::changed_from);
  result_class<FitFeedResult>(module, "FitFeedResult")
      .def_readonly("machine", &FitFeedResult::machine)
      .def_readonly("parameters", &FitFeedResult::parameters)
      .def_readonly("converged", &FitFeedResult::converged)
      .def_readonly("message", &FitFeedResult::message);
}

void add_predict_and_compensate(py::module_& module) {
  using camber::CompensateResult, camber::CompensationRound, camber::ErrorFigures, camber::PredictResult;
  py::class_<ErrorFigures>(module, "ErrorFigures")
      .def_readonly("min", &ErrorFigures::min)
      .def_readonly("max", &ErrorFigures::max)
      .def_readonly("mean", &ErrorFigures::mean)
      .def_readonly("rms", &ErrorFigures::rms)
      .def_readonly("p95", &ErrorFigures::p95)
      .def_readonly("area_mm2", &ErrorFigures::area_mm2);
  using camber::TraceComparison;
  py::class_<TraceComparison>(module, "TraceComparison")
      .def_readonly("by_line", &TraceComparison::by_line)
      .def_readonly("samples", &TraceComparison::samples)
      .def_readonly("period_s", &TraceComparison::period_s)
      .def_readonly("machine_time_s", &TraceComparison::machine_time_s)
      .def_readonly("off_path_p95_um", &TraceComparison::off_path_p95_um)
      .def_readonly("off_path_max_um", &TraceComparison::off_path_max_um)
      .def_readonly("form_error_um", &TraceComparison::form_error_um)
      .def_readonly("difference_um", &TraceComparison::difference_um);
  auto predict = result_class<PredictResult>(module, "PredictResult")
                     .def_readonly("machine_time_s", &PredictResult::machine_time_s)
                     .def_readonly("cutting_time_s", &PredictResult::cutting_time_s)
                     .def_readonly("force_max_N", &PredictResult::force_max_N)
                     .def_readonly("chips_mm3", &PredictResult::chips_mm3)
                     .def_readonly("stock_mm3", &PredictResult::stock_mm3)
                     .def_readonly("form_error_um", &PredictResult::form_error_um)
                     .def_readonly("deflection_um", &PredictResult::deflection_um)
                     .def_readonly("tool_deflection_um", &PredictResult::tool_deflection_um)
                     .def_readonly("part_deflection_um", &PredictResult::part_deflection_um)
                     .def_readonly("contour_um", &PredictResult::contour_um)
                     .def_readonly("unseen_mm2", &PredictResult::unseen_mm2)
                     .def_readonly("trace", &PredictResult::trace)
                     .def_readonly("doubts", &PredictResult::doubts);
  add_table(predict, "forces", &PredictResult::forces);
  add_table(predict, "form_error", &PredictResult::form_error);
  add_table(predict, "feed", &PredictResult::feed);
  add_table(predict, "spindle_load", &PredictResult::spindle_load);
  for (const auto& [name, mesh] :
       {std::pair{"error_mesh", &PredictResult::error_mesh}, {"machined_mesh", &PredictResult::machined_mesh}})
    predict.def_property_readonly(name, [mesh = mesh](const py::object& self) {
      return MeshView{self, &(self.cast<const PredictResult&>().*mesh)};
    });
  py::class_<CompensationRound>(module, "CompensationRound")
      .def_readonly("error_um", &CompensationRound::error_um)
      .def_readonly("largest_shift_mm", &CompensationRound::largest_shift_mm)
      .def_readonly("machine_time_s", &CompensationRound::machine_time_s)
      .def_readonly("repeated_runs", &CompensationRound::repeated_runs);
  py::class_<camber::TimePoint>(module, "TimePoint")
      .def_readonly("allowed_percent", &camber::TimePoint::allowed_percent)
      .def_readonly("round", &camber::TimePoint::round);
  py::class_<camber::RepeatedLines>(module, "RepeatedLines")
      .def_readonly("first", &camber::RepeatedLines::first)
      .def_readonly("last", &camber::RepeatedLines::last);
  auto compensate = result_class<CompensateResult>(module, "CompensateResult")
                        .def_readonly("program", &CompensateResult::program)
                        .def_readonly("better", &CompensateResult::better)
                        .def_readonly("success", &CompensateResult::success)
                        .def_readonly("headline", &CompensateResult::headline)
                        .def_readonly("reasons", &CompensateResult::reasons)
                        .def_readonly("before_um", &CompensateResult::before_um)
                        .def_readonly("after_um", &CompensateResult::after_um)
                        .def_readonly("rounds", &CompensateResult::rounds)
                        .def_readonly("best_round", &CompensateResult::best_round)
                        .def_readonly("time_points", &CompensateResult::time_points)
                        .def_readonly("repeated", &CompensateResult::repeated)
                        .def_readonly("pass_allowance_mm", &CompensateResult::pass_allowance_mm)
                        .def_readonly("given_allowance_mm", &CompensateResult::given_allowance_mm)
                        .def_readonly("allowance_mm", &CompensateResult::allowance_mm)
                        .def_readonly("stop", &CompensateResult::stop)
                        .def_readonly("blocks_before", &CompensateResult::blocks_before)
                        .def_readonly("blocks_after", &CompensateResult::blocks_after)
                        .def_readonly("blocks_changed", &CompensateResult::blocks_changed)
                        .def_readonly("max_shift_mm", &CompensateResult::max_shift_mm);
  add_table(compensate, "surface", &CompensateResult::surface);
  using camber::VerifyResult;
  result_class<VerifyResult>(module, "VerifyResult")
      .def_readonly("program", &VerifyResult::program)
      .def_readonly("job", &VerifyResult::job)
      .def_readonly("success", &VerifyResult::success)
      .def_readonly("headline", &VerifyResult::headline)
      .def_readonly("reasons", &VerifyResult::reasons)
      .def_readonly("error_um", &VerifyResult::error_um)
      .def_readonly("deflection_um", &VerifyResult::deflection_um)
      .def_readonly("contour_um", &VerifyResult::contour_um)
      .def_readonly("gouge_depth_p999_um", &VerifyResult::gouge_depth_p999_um)
      .def_readonly("depth_limit_um", &VerifyResult::depth_limit_um)
      .def_readonly("machine_time_s", &VerifyResult::machine_time_s);
}

void add_adapt(py::module_& module) {
  using camber::AdaptedLoad, camber::AdaptResult, camber::LimitSweepRow, camber::OverLimitBlock;
  py::class_<AdaptedLoad>(module, "AdaptedLoad")
      .def_readonly("name", &AdaptedLoad::name)
      .def_readonly("limit", &AdaptedLoad::limit)
      .def_readonly("max_before", &AdaptedLoad::max_before)
      .def_readonly("max_after", &AdaptedLoad::max_after)
      .def_readonly("max_elsewhere", &AdaptedLoad::max_elsewhere);
  py::class_<OverLimitBlock>(module, "OverLimitBlock")
      .def_readonly("line", &OverLimitBlock::line)
      .def_readonly("new_line", &OverLimitBlock::new_line)
      .def_readonly("name", &OverLimitBlock::name)
      .def_readonly("value", &OverLimitBlock::value)
      .def_readonly("feed_mm_per_min", &OverLimitBlock::feed_mm_per_min)
      .def_readonly("reason", &OverLimitBlock::reason);
  py::class_<LimitSweepRow>(module, "LimitSweepRow")
      .def_readonly("factor", &LimitSweepRow::factor)
      .def_readonly("time_s", &LimitSweepRow::time_s)
      .def_readonly("constant_feed_mm_per_min", &LimitSweepRow::constant_feed_mm_per_min)
      .def_readonly("constant_time_s", &LimitSweepRow::constant_time_s);
  using camber::AdaptedSpeed;
  py::class_<AdaptedSpeed>(module, "AdaptedSpeed")
      .def_readonly("tool", &AdaptedSpeed::tool)
      .def_readonly("speed_before_rpm", &AdaptedSpeed::speed_before_rpm)
      .def_readonly("speed_after_rpm", &AdaptedSpeed::speed_after_rpm)
      .def_readonly("margin_before", &AdaptedSpeed::margin_before)
      .def_readonly("margin_after", &AdaptedSpeed::margin_after)
      .def_readonly("line", &AdaptedSpeed::line)
      .def_readonly("new_line", &AdaptedSpeed::new_line)
      .def_readonly("chatter_Hz", &AdaptedSpeed::chatter_hz)
      .def_readonly("kept_depth_mm", &AdaptedSpeed::kept_depth_mm)
      .def_readonly("stable_speed_rpm", &AdaptedSpeed::stable_speed_rpm)
      .def_readonly("probability", &AdaptedSpeed::probability)
      .def_readonly("modes_given", &AdaptedSpeed::modes_given)
      .def_readonly("kept", &AdaptedSpeed::kept)
      .def_readonly("reason", &AdaptedSpeed::reason);
  result_class<AdaptResult>(module, "AdaptResult")
      .def_readonly("program", &AdaptResult::program)
      .def_readonly("success", &AdaptResult::success)
      .def_readonly("reasons", &AdaptResult::reasons)
      .def_readonly("time_before_s", &AdaptResult::time_before_s)
      .def_readonly("time_after_s", &AdaptResult::time_after_s)
      .def_readonly("constant_feed_mm_per_min", &AdaptResult::constant_feed_mm_per_min)
      .def_readonly("constant_time_s", &AdaptResult::constant_time_s)
      .def_readonly("blocks_before", &AdaptResult::blocks_before)
      .def_readonly("blocks_after", &AdaptResult::blocks_after)
      .def_readonly("blocks_changed", &AdaptResult::blocks_changed)
      .def_readonly("loads", &AdaptResult::loads)
      .def_readonly("over_limit", &AdaptResult::over_limit)
      .def_readonly("speeds", &AdaptResult::speeds)
      .def_readonly("sweep", &AdaptResult::sweep)
      .def_readonly("limit_factor", &AdaptResult::limit_factor);
}

}  // namespace

void add_results(py::module_& module) {
  add_tables(module);
  add_mesh(module);
  add_check(module);
  add_explain_kinematics(module);
  add_study(module);
  add_sections(module);
  add_feed_and_time(module);
  add_fit(module);
  add_predict_and_compensate(module);
  add_adapt(module);
}

}  // namespace camber_python
