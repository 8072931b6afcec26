// camber.plan and what it returns.
#include <filesystem>
#include <optional>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calls.h"
#include "camber/plan.h"
#include "parts.h"

namespace py = pybind11;
using namespace pybind11::literals;

namespace camber_python {
namespace {

using Path = std::filesystem::path;

camber::PlanResult make_plan(const Path& path, const std::optional<Path>& operations, bool programs, bool all_programs,
                             const py::object& progress, bool strict, int threads) {
  camber::PlanResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = camber::plan(path.string(),
                          {.operations = operations ? operations->string() : std::string(),
                           .programs = programs,
                           .all_programs = all_programs},
                          run);
  });
  return result;
}

void add_operation(py::module_& module) {
  using camber::PlannedOperation;
  py::class_<PlannedOperation>(module, "PlannedOperation")
      .def_readonly("setup", &PlannedOperation::setup)
      .def_readonly("primitive", &PlannedOperation::primitive)
      .def_readonly("feature", &PlannedOperation::feature)
      .def_readonly("kind", &PlannedOperation::kind)
      .def_readonly("tool", &PlannedOperation::tool)
      .def_readonly("mode", &PlannedOperation::mode)
      .def_readonly("joined", &PlannedOperation::joined)
      .def_readonly("spindle_rpm", &PlannedOperation::spindle_rpm)
      .def_readonly("feed_mm_per_min", &PlannedOperation::feed_mm_per_min)
      .def_readonly("radial_mm", &PlannedOperation::radial_mm)
      .def_readonly("axial_mm", &PlannedOperation::axial_mm)
      .def_readonly("nominal_time_s", &PlannedOperation::nominal_time_s)
      .def_readonly("time_s", &PlannedOperation::time_s)
      .def_readonly("limit", &PlannedOperation::limit)
      .def_readonly("force_N", &PlannedOperation::force_N)
      .def_readonly("form_error_um", &PlannedOperation::form_error_um)
      .def_readonly("power_W", &PlannedOperation::power_W)
      .def_readonly("notes", &PlannedOperation::notes);
}

}  // namespace

void add_plan(py::module_& module) {
  using camber::PlanAlternative, camber::PlanResult;
  add_operation(module);
  py::class_<PlanAlternative>(module, "PlanAlternative")
      .def_readonly("division", &PlanAlternative::division)
      .def_readonly("nominal_time_s", &PlanAlternative::nominal_time_s)
      .def_readonly("time_s", &PlanAlternative::time_s)
      .def_readonly("tool_changes", &PlanAlternative::tool_changes)
      .def_readonly("form_error_p95_um", &PlanAlternative::form_error_p95_um)
      .def_readonly("complete", &PlanAlternative::complete)
      .def_readonly("taken", &PlanAlternative::taken);
  py::class_<PlanResult>(module, "PlanResult")
      .def_readonly("json", &PlanResult::json, "All figures, as --json of the command line writes them.")
      .def_property_readonly(
          "figures", [](const PlanResult& r) { return py::module_::import("json").attr("loads")(r.json); },
          "json as a dictionary.")
      .def_readonly("diagnostics", &PlanResult::diagnostics, "Warnings.")
      .def_readonly("success", &PlanResult::success)
      .def_readonly("unmachined", &PlanResult::unmachined)
      .def_readonly("alternatives", &PlanResult::alternatives)
      .def_readonly("operations", &PlanResult::operations)
      .def_readonly("removal_mm3", &PlanResult::removal_mm3)
      .def_readonly("files", &PlanResult::files);
  module.def("plan", make_plan, "plan"_a, py::kw_only(), "operations"_a = py::none(), "programs"_a = false,
             "all_programs"_a = false, "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Operations, tools, conditions and order from the blank and the part of a plan.toml.");
}

}  // namespace camber_python
