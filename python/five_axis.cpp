// camber.post and camber.posture, and what they return.
#include <optional>
#include <string>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "calls.h"
#include "camber/post.h"
#include "camber/posture.h"
#include "parts.h"

namespace py = pybind11;
using namespace pybind11::literals;

namespace camber_python {
namespace {

camber::PostResult post(const py::object& program, const py::object& machine, const std::string& to,
                        double tolerance_mm, double rapid_tolerance_mm, bool inverse_time, bool one_degree,
                        double retract_mm, const std::optional<int>& decimals, const py::object& progress, bool strict,
                        int threads) {
  if (to != "joints" && to != "tcp") throw py::value_error("to: joints or tcp was expected");
  const camber::Program text = program_of(program);
  const camber::PostOptions options{.to_tip = to == "tcp",
                                    .tolerance_mm = tolerance_mm,
                                    .rapid_tolerance_mm = rapid_tolerance_mm,
                                    .inverse_time = inverse_time,
                                    .one_degree = one_degree,
                                    .retract_mm = retract_mm,
                                    .decimals = decimals};
  std::optional<camber::Job> job;
  std::optional<camber::Machine> alone;
  if (py::isinstance<camber::Job>(machine))
    job = machine.cast<camber::Job>();
  else
    alone = machine_of(machine);
  camber::PostResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = job ? camber::post(text, *job, options, run) : camber::post(text, *alone, options, run);
  });
  return result;
}

camber::PostureResult posture(const py::object& program, const py::object& job, const std::string& mode, bool indexed,
                              const std::string& write_as, const std::optional<int>& tool, double step_mm,
                              double overhang_step_mm, bool least_error, double clearance_mm, bool stock,
                              double lead_deg, double tilt_deg, double max_tilt_deg, double least_angle_deg,
                              const py::object& progress, bool strict, int threads) {
  const camber::Program text = program_of(program);
  const camber::Job given = unprogrammed_job_of(job);
  const camber::PostureOptions options{.mode = mode,
                                       .indexed = indexed,
                                       .write_as = write_as,
                                       .tool = tool,
                                       .step_mm = step_mm,
                                       .overhang_step_mm = overhang_step_mm,
                                       .least_error = least_error,
                                       .clearance_mm = clearance_mm,
                                       .stock = stock,
                                       .lead_deg = lead_deg,
                                       .tilt_deg = tilt_deg,
                                       .max_tilt_deg = max_tilt_deg,
                                       .least_angle_deg = least_angle_deg};
  camber::PostureResult result;
  call({progress, strict, threads},
       [&](const camber::RunOptions& run) { result = camber::posture(text, given, options, run); });
  return result;
}

template <typename Result>
py::class_<Result> with_json(py::module_& module, const char* name) {
  return py::class_<Result>(module, name)
      .def_readonly("json", &Result::json, "All figures, as --json of the command line writes them.")
      .def_property_readonly(
          "figures", [](const Result& r) { return py::module_::import("json").attr("loads")(r.json); },
          "json as a dictionary.")
      .def_readonly("diagnostics", &Result::diagnostics, "Warnings.")
      .def_readonly("text", &Result::text, "The new program.");
}

void add_post(py::module_& module) {
  using camber::PostResult;
  with_json<PostResult>(module, "PostResult")
      .def_readonly("moves", &PostResult::moves)
      .def_readonly("feed_moves", &PostResult::feed_moves)
      .def_readonly("feed_blocks", &PostResult::feed_blocks)
      .def_readonly("tip_bound_mm", &PostResult::tip_bound_mm)
      .def_readonly("turns_back", &PostResult::turns_back)
      .def_readonly("turns_back_in_cuts", &PostResult::turns_back_in_cuts);
  module.def("post", post, "program"_a, "machine"_a, py::kw_only(), "to"_a = "joints", "tolerance_mm"_a = 0.005,
             "rapid_tolerance_mm"_a = 0.1, "inverse_time"_a = false, "one_degree"_a = false, "retract_mm"_a = 50.0,
             "decimals"_a = py::none(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "A program with rotary axes in joint coordinates, or (to=\"tcp\") back to the tool's tip. machine: also a "
             "Job, with which collisions of its tools are looked for.");
}

void add_posture(py::module_& module) {
  using camber::PostureFigures, camber::PostureResult;
  py::class_<PostureFigures>(module, "PostureFigures")
      .def_readonly("overhang_mm", &PostureFigures::overhang_mm)
      .def_readonly("points", &PostureFigures::points)
      .def_readonly("contacts", &PostureFigures::contacts)
      .def_readonly("unclear", &PostureFigures::unclear)
      .def_readonly("rotary_motion_deg", &PostureFigures::rotary_motion_deg)
      .def_readonly("mean_angle_deg", &PostureFigures::mean_angle_deg)
      .def_readonly("max_angle_deg", &PostureFigures::max_angle_deg)
      .def_readonly("compliance_um_per_N", &PostureFigures::compliance_um_per_N)
      .def_readonly("lag_um", &PostureFigures::lag_um)
      .def_readonly("error_um", &PostureFigures::error_um)
      .def_readonly("time_s", &PostureFigures::time_s);
  with_json<PostureResult>(module, "PostureResult")
      .def_readonly("success", &PostureResult::success)
      .def_readonly("blocked_line", &PostureResult::blocked_line)
      .def_readonly("unclear_line", &PostureResult::unclear_line)
      .def_readonly("of_program", &PostureResult::figures, "PostureFigures of the new program.")
      .def_readonly("overhangs", &PostureResult::overhangs);
  module.def("posture", posture, "program"_a, "job"_a, py::kw_only(), "mode"_a = "chosen", "indexed"_a = false,
             "write_as"_a = "", "tool"_a = py::none(), "step_mm"_a = 1.0, "overhang_step_mm"_a = 0.0,
             "least_error"_a = false, "clearance_mm"_a = 1.0, "stock"_a = true, "lead_deg"_a = 10.0, "tilt_deg"_a = 0.0,
             "max_tilt_deg"_a = 75.0, "least_angle_deg"_a = 10.0, "progress"_a = py::none(), "strict"_a = false,
             "threads"_a = 0, "Tilts the tool of a three-axis finishing program, clear of part and stock.");
}

}  // namespace

void add_five_axis(py::module_& module) {
  add_post(module);
  add_posture(module);
}

}  // namespace camber_python
