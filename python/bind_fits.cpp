// compress, resegment, raster, protocol, lobes, fit_modes, fit_force and fit_parts, and what they return.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

#include "calls.h"
#include "camber/compress.h"
#include "camber/fit_force.h"
#include "camber/fit_modes.h"
#include "camber/fit_parts.h"
#include "camber/lobes.h"
#include "camber/protocol.h"
#include "camber/resegment.h"
#include "parts.h"

namespace py = pybind11;
using namespace pybind11::literals;

namespace camber_python {
namespace {

using Path = std::filesystem::path;

template <typename Result>
py::class_<Result> with_figures(py::module_& module, const char* name) {
  return py::class_<Result>(module, name)
      .def_readonly("json", &Result::json, "All figures, as --json of the command line writes them.")
      .def_property_readonly(
          "figures", [](const Result& r) { return py::module_::import("json").attr("loads")(r.json); },
          "json as a dictionary.");
}

void add_compress(py::module_& module) {
  using camber::CompressResult, camber::ProgramCounts;
  py::class_<ProgramCounts>(module, "ProgramCounts")
      .def_readonly("blocks", &ProgramCounts::blocks)
      .def_readonly("lines", &ProgramCounts::lines)
      .def_readonly("arcs", &ProgramCounts::arcs)
      .def_readonly("length_mm", &ProgramCounts::length_mm);
  with_figures<CompressResult>(module, "CompressResult")
      .def_readonly("program", &CompressResult::program)
      .def_readonly("before", &CompressResult::before)
      .def_readonly("after", &CompressResult::after)
      .def_readonly("runs", &CompressResult::runs)
      .def_readonly("max_deviation_mm", &CompressResult::max_deviation_mm)
      .def_readonly("max_kink_deg", &CompressResult::max_kink_deg)
      .def_readonly("time_before_s", &CompressResult::time_before_s)
      .def_readonly("time_after_s", &CompressResult::time_after_s)
      .def_readonly("unchanged_because", &CompressResult::unchanged_because)
      .def_readonly("diagnostics", &CompressResult::diagnostics, "Warnings.");
  module.def(
      "compress",
      [](const py::object& program, double tolerance_mm, const py::object& machine, double tangent_deg, bool lines_only,
         bool helices, bool switch_planes, const py::object& progress, bool strict, int threads) {
        const camber::Program text = program_of(program);
        std::optional<camber::Machine> on;
        if (!machine.is_none()) on = machine_of(machine);
        const camber::CompressOptions options{.tolerance_mm = tolerance_mm,
                                              .tangent_deg = tangent_deg,
                                              .lines_only = lines_only,
                                              .helices = helices,
                                              .switch_planes = switch_planes};
        CompressResult result;
        call({progress, strict, threads}, [&](const camber::RunOptions& run) {
          result = on ? camber::compress(text, *on, options, run) : camber::compress(text, options, run);
        });
        return result;
      },
      "program"_a, "tolerance_mm"_a, py::kw_only(), "machine"_a = py::none(), "tangent_deg"_a = 1.0,
      "lines_only"_a = false, "helices"_a = false, "switch_planes"_a = false, "progress"_a = py::none(),
      "strict"_a = false, "threads"_a = 0, "Replaces many G1 by few G1, G2 and G3 within a tolerance.");
}

void add_resegment(py::module_& module) {
  using camber::ContourError, camber::RasterResult, camber::ResegmentResult;
  py::class_<ContourError>(module, "ContourError")
      .def_readonly("time_s", &ContourError::time_s)
      .def_readonly("max_um", &ContourError::max_um)
      .def_readonly("rms_um", &ContourError::rms_um);
  with_figures<ResegmentResult>(module, "ResegmentResult")
      .def_readonly("program", &ResegmentResult::program)
      .def_readonly("within_limit", &ResegmentResult::within_limit)
      .def_readonly("before", &ResegmentResult::before)
      .def_readonly("after", &ResegmentResult::after)
      .def_readonly("contour_before", &ResegmentResult::contour_before)
      .def_readonly("contour_after", &ResegmentResult::contour_after)
      .def_readonly("max_deviation_mm", &ResegmentResult::max_deviation_mm)
      .def_readonly("unchanged_because", &ResegmentResult::unchanged_because)
      .def_readonly("diagnostics", &ResegmentResult::diagnostics, "Warnings.");
  with_figures<RasterResult>(module, "RasterResult")
      .def_readonly("program", &RasterResult::program)
      .def_readonly("within_limit", &RasterResult::within_limit)
      .def_readonly("scallops_too_high", &RasterResult::scallops_too_high)
      .def_readonly("largest_scallop_mm", &RasterResult::largest_scallop_mm)
      .def_readonly("rows", &RasterResult::rows)
      .def_readonly("after", &RasterResult::after)
      .def_readonly("contour_after", &RasterResult::contour_after)
      .def_readonly("diagnostics", &RasterResult::diagnostics, "Warnings.");
  module.def(
      "resegment",
      [](const py::object& program, const py::object& machine, double tolerance_mm, double length_mm, double contour_mm,
         const py::object& progress, bool strict, int threads) {
        const camber::Machine on = machine_of(machine);
        const camber::Program text = program_of(program);
        ResegmentResult result;
        call({progress, strict, threads}, [&](const camber::RunOptions& run) {
          result = camber::resegment(
              text, on, {.tolerance_mm = tolerance_mm, .length_mm = length_mm, .contour_mm = contour_mm}, run);
        });
        return result;
      },
      "program"_a, "machine"_a, "tolerance_mm"_a, py::kw_only(), "length_mm"_a = 0.0, "contour_mm"_a = 0.0,
      "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
      "Divides runs of G1 into segments just long enough for the control.");
  module.def(
      "raster",
      [](const py::object& job, double tolerance_mm, double scallop_mm, double feed_mm_per_min, double spindle_rpm,
         const std::optional<int>& tool, const std::optional<Path>& part, double direction_deg,
         const std::vector<double>& boundary_mm, const std::optional<double>& clearance_mm, double length_mm,
         double contour_mm, const py::object& progress, bool strict, int threads) {
        const camber::Job given = unprogrammed_job_of(job);
        const camber::RasterOptions options{.layout = {.tolerance_mm = tolerance_mm,
                                                       .length_mm = length_mm,
                                                       .contour_mm = contour_mm,
                                                       .output = "program.nc"},
                                            .part = part ? part->string() : std::string(),
                                            .tool = tool,
                                            .scallop_mm = scallop_mm,
                                            .feed_mm_per_min = feed_mm_per_min,
                                            .spindle_rpm = spindle_rpm,
                                            .direction_deg = direction_deg,
                                            .boundary_mm = boundary_mm,
                                            .clearance_mm = clearance_mm};
        RasterResult result;
        call({progress, strict, threads},
             [&](const camber::RunOptions& run) { result = camber::raster(given, options, run); });
        return result;
      },
      "job"_a, py::kw_only(), "tolerance_mm"_a, "scallop_mm"_a, "feed_mm_per_min"_a, "spindle_rpm"_a,
      "tool"_a = py::none(), "part"_a = py::none(), "direction_deg"_a = 0.0, "boundary_mm"_a = std::vector<double>(),
      "clearance_mm"_a = py::none(), "length_mm"_a = 0.0, "contour_mm"_a = 0.0, "progress"_a = py::none(),
      "strict"_a = false, "threads"_a = 0, "A finishing raster on the offset surface of a job's part.");
}

void add_lobes(py::module_& module) {
  using camber::LobePoint, camber::LobesResult;
  py::class_<LobePoint>(module, "LobePoint")
      .def_readonly("speed_rpm", &LobePoint::speed_rpm)
      .def_readonly("depth_mm", &LobePoint::depth_mm)
      .def_readonly("chatter_hz", &LobePoint::chatter_hz)
      .def_readonly("border", &LobePoint::border);
  with_figures<LobesResult>(module, "LobesResult")
      .def_readonly("tool", &LobesResult::tool)
      .def_readonly("lobes", &LobesResult::lobes)
      .def_readonly("csv", &LobesResult::csv)
      .def_readonly("diagnostics", &LobesResult::diagnostics, "Warnings.");
  module.def(
      "lobes",
      [](const py::object& job, double radial_mm, const std::vector<double>& speeds_rpm, const std::optional<int>& tool,
         bool up, bool zero_order, double chip_mm, double process_damping_N_per_mm, const py::object& progress,
         bool strict, int threads) {
        const camber::Job given = unprogrammed_job_of(job);
        const camber::LobesOptions options{.tool = tool,
                                           .radial_mm = radial_mm,
                                           .speeds_rpm = speeds_rpm,
                                           .up = up,
                                           .zero_order = zero_order,
                                           .chip_mm = chip_mm,
                                           .process_damping_N_per_mm = process_damping_N_per_mm};
        LobesResult result;
        call({progress, strict, threads},
             [&](const camber::RunOptions& run) { result = camber::lobes(given, options, run); });
        return result;
      },
      "job"_a, "radial_mm"_a, "speeds_rpm"_a, py::kw_only(), "tool"_a = py::none(), "up"_a = false,
      "zero_order"_a = false, "chip_mm"_a = 0.05, "process_damping_N_per_mm"_a = 0.0, "progress"_a = py::none(),
      "strict"_a = false, "threads"_a = 0, "Critical depths of a tool over the spindle speed.");
}

void add_fit_modes(py::module_& module) {
  using camber::FitModesResult, camber::FittedMode;
  py::class_<FittedMode>(module, "FittedMode")
      .def_readonly("frequency_hz", &FittedMode::frequency_hz)
      .def_readonly("frequency_error_hz", &FittedMode::frequency_error_hz)
      .def_readonly("damping_percent", &FittedMode::damping_percent)
      .def_readonly("damping_error_percent", &FittedMode::damping_error_percent)
      .def_readonly("stiffness_N_per_um", &FittedMode::stiffness_N_per_um)
      .def_readonly("stiffness_error_N_per_um", &FittedMode::stiffness_error_N_per_um);
  with_figures<FitModesResult>(module, "FitModesResult")
      .def_readonly("modes", &FitModesResult::modes)
      .def_readonly("misfit", &FitModesResult::misfit)
      .def_readonly("tables", &FitModesResult::tables);
  module.def(
      "fit_modes",
      [](const Path& response, int tool, const std::string& direction, const std::optional<int>& modes,
         const std::pair<double, double>& band_hz, const py::object& progress, bool strict, int threads) {
        FitModesResult result;
        call({progress, strict, threads}, [&](const camber::RunOptions& run) {
          result = camber::fit_modes(
              response.string(),
              {.tool = tool, .direction = direction, .modes = modes, .from_hz = band_hz.first, .to_hz = band_hz.second},
              run);
        });
        return result;
      },
      "response"_a, py::kw_only(), "tool"_a = 1, "direction"_a = "x", "modes"_a = py::none(),
      "band_hz"_a = std::pair(0.0, 0.0), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
      "Fits natural modes of a tool to a tap test.");
}

void add_fit_force(py::module_& module) {
  using camber::FitForceResult, camber::FittedCoefficient;
  py::class_<FittedCoefficient>(module, "FittedCoefficient")
      .def_readonly("name", &FittedCoefficient::name)
      .def_readonly("unit", &FittedCoefficient::unit)
      .def_readonly("value", &FittedCoefficient::value)
      .def_readonly("std_error", &FittedCoefficient::std_error)
      .def_readonly("note", &FittedCoefficient::note);
  with_figures<FitForceResult>(module, "FitForceResult")
      .def_readonly("coefficients", &FitForceResult::coefficients)
      .def_readonly("residual_rms_N", &FitForceResult::residual_rms_N)
      .def_readonly("held_out_rms_N", &FitForceResult::held_out_rms_N)
      .def_readonly("success", &FitForceResult::success)
      .def_readonly("message", &FitForceResult::message)
      .def_readonly("material", &FitForceResult::material)
      .def_readonly("diagnostics", &FitForceResult::diagnostics, "Warnings.");
  module.def(
      "fit_force",
      [](const std::vector<std::pair<Path, Path>>& logs, const py::object& progress, bool strict, int threads) {
        std::vector<camber::ForceLogFile> files;
        for (const auto& [log, job] : logs) files.push_back({log.string(), job.string()});
        FitForceResult result;
        call({progress, strict, threads},
             [&](const camber::RunOptions& run) { result = camber::fit_force(files, run); });
        return result;
      },
      "logs"_a, py::kw_only(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
      "Fits force coefficients to pairs of a dynamometer log and its job.");
}

void add_fit_parts(py::module_& module) {
  using camber::FitPartsResult, camber::FittedPartsParameter;
  py::class_<FittedPartsParameter>(module, "FittedPartsParameter")
      .def_readonly("name", &FittedPartsParameter::name)
      .def_readonly("unit", &FittedPartsParameter::unit)
      .def_readonly("value", &FittedPartsParameter::value)
      .def_readonly("start", &FittedPartsParameter::start)
      .def_readonly("std_error", &FittedPartsParameter::std_error)
      .def_readonly("note", &FittedPartsParameter::note);
  with_figures<FitPartsResult>(module, "FitPartsResult")
      .def_readonly("parameters", &FitPartsResult::parameters)
      .def_readonly("rms_um", &FitPartsResult::rms_um)
      .def_readonly("converged", &FitPartsResult::converged)
      .def_readonly("message", &FitPartsResult::message)
      .def_readonly("files", &FitPartsResult::files)
      .def_readonly("diagnostics", &FitPartsResult::diagnostics, "Warnings.");
  module.def(
      "fit_parts",
      [](const std::vector<py::object>& jobs, const std::vector<std::string>& hold_out, const py::object& progress,
         bool strict, int threads) {
        std::vector<camber::Job> given;
        for (const py::object& job : jobs) given.push_back(job_of(job));
        FitPartsResult result;
        call({progress, strict, threads},
             [&](const camber::RunOptions& run) { result = camber::fit_parts(given, {.hold_out = hold_out}, run); });
        return result;
      },
      "jobs"_a, py::kw_only(), "hold_out"_a = std::vector<std::string>(), "progress"_a = py::none(), "strict"_a = false,
      "threads"_a = 0, "Fits forces, stiffness, gains and tool diameters to measured features of parts.");
}

void add_protocol(py::module_& module) {
  module.def(
      "protocol",
      [](const py::object& machine, bool part, double diameter_mm) {
        std::vector<std::pair<std::string, std::string>> out;
        for (auto& file : camber::protocol(machine_of(machine), {.part = part, .diameter_mm = diameter_mm}))
          out.emplace_back(file.name, file.text);
        return out;
      },
      "machine"_a, py::kw_only(), "part"_a = false, "diameter_mm"_a = 6.0,
      "Names and texts of programs that provide fit_feed with the data it needs; or of a test piece.");
}

}  // namespace

void add_fits(py::module_& module) {
  add_compress(module);
  add_resegment(module);
  add_lobes(module);
  add_fit_modes(module);
  add_fit_force(module);
  add_fit_parts(module);
  add_protocol(module);
}

}  // namespace camber_python
