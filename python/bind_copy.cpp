// camber.copy and what it returns.
#include <filesystem>
#include <optional>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "calls.h"
#include "camber/copy.h"
#include "parts.h"

namespace py = pybind11;
using namespace pybind11::literals;

namespace camber_python {
namespace {

using Path = std::filesystem::path;

camber::CopyResult make_copy(const Path& job, const std::optional<Path>& hardness, std::optional<double> stop_after_s,
                             const std::optional<Path>& stock, const py::object& progress, bool strict, int threads) {
  camber::CopyOptions options;
  options.stop_after_s = stop_after_s;
  if (hardness) options.hardness = hardness->string();
  if (stock) options.stock = stock->string();
  camber::CopyResult result;
  call({progress, strict, threads},
       [&](const camber::RunOptions& run) { result = camber::copy(job.string(), options, run); });
  return result;
}

}  // namespace

void add_copy(py::module_& module) {
  using camber::CopiedOperation, camber::CopyResult;
  py::class_<CopiedOperation>(module, "CopiedOperation")
      .def_readonly("tool", &CopiedOperation::tool)
      .def_readonly("mode", &CopiedOperation::mode)
      .def_readonly("time_s", &CopiedOperation::time_s)
      .def_readonly("cutting_s", &CopiedOperation::cutting_s)
      .def_readonly("removed_mm3", &CopiedOperation::removed_mm3)
      .def_readonly("levels", &CopiedOperation::levels)
      .def_readonly("passes", &CopiedOperation::passes)
      .def_readonly("ramps", &CopiedOperation::ramps)
      .def_readonly("plunges", &CopiedOperation::plunges)
      .def_readonly("retracts", &CopiedOperation::retracts)
      .def_readonly("nothing_left", &CopiedOperation::nothing_left)
      .def_readonly("target_N", &CopiedOperation::target_N)
      .def_readonly("max_N", &CopiedOperation::max_N)
      .def_readonly("within_share", &CopiedOperation::within_share)
      .def_readonly("trochoid_circles", &CopiedOperation::trochoid_circles);
  py::class_<CopyResult>(module, "CopyResult")
      .def_readonly("json", &CopyResult::json, "All figures, as --json of the command line writes them.")
      .def_property_readonly(
          "figures", [](const CopyResult& r) { return py::module_::import("json").attr("loads")(r.json); },
          "json as a dictionary.")
      .def_readonly("diagnostics", &CopyResult::diagnostics, "Warnings.")
      .def_readonly("program", &CopyResult::program)
      .def_readonly("operations", &CopyResult::operations)
      .def_readonly("time_s", &CopyResult::time_s)
      .def_readonly("removed_mm3", &CopyResult::removed_mm3)
      .def_readonly("ticks", &CopyResult::ticks)
      .def_readonly("blocks", &CopyResult::blocks)
      .def_readonly("gouge_um", &CopyResult::gouge_um)
      .def_readonly("left_p95_um", &CopyResult::left_p95_um)
      .def_readonly("left_max_um", &CopyResult::left_max_um)
      .def_readonly("unreached_mm2", &CopyResult::unreached_mm2)
      .def_readonly("stopped", &CopyResult::stopped)
      .def_readonly("log", &CopyResult::log);
  module.def("copy", make_copy, "job"_a, py::kw_only(), "hardness"_a = py::none(), "stop_after_s"_a = py::none(),
             "stock"_a = py::none(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "The program of a job's [[copy]] tables, made from the part itself.");
}

}  // namespace camber_python
