// The functions of the module. Where a function takes a program, a machine or a job, a path does as well.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calls.h"
#include "camber/camber.h"
#include "parts.h"

namespace py = pybind11;
using py::literals::operator""_a;

namespace camber_python {
namespace {

using Path = std::filesystem::path;

std::string path_of(const py::handle& object) { return object.cast<Path>().string(); }

}  // namespace

camber::Program program_of(const py::handle& object) {
  if (py::isinstance<camber::Program>(object)) return object.cast<camber::Program>();
  return camber::read_program(path_of(object));
}

camber::Machine machine_of(const py::handle& object) {
  if (py::isinstance<camber::Machine>(object)) return object.cast<camber::Machine>();
  return camber::read_machine(path_of(object));
}

camber::Job job_of(const py::handle& object) {
  if (py::isinstance<camber::Job>(object)) return object.cast<camber::Job>();
  return camber::read_job(path_of(object));
}

camber::Job unprogrammed_job_of(const py::handle& object) {
  if (py::isinstance<camber::Job>(object)) return object.cast<camber::Job>();
  return camber::read_unprogrammed_job(path_of(object));
}

namespace {

camber::ReadOptions read_options(const std::optional<std::string>& units, bool block_skip,
                                 const std::vector<int>& skip_switches, const std::string& dialect,
                                 bool least_increments, const std::map<int, double>& tool_lengths,
                                 const std::map<std::string, std::vector<double>>& work_offsets) {
  if (units && *units != "mm" && *units != "inch") throw py::value_error("units: mm or inch was expected");
  return {.inch = units ? std::optional(*units == "inch") : std::nullopt,
          .skip_slash_blocks = block_skip,
          .skip_switches = skip_switches,
          .dialect = dialect,
          .least_increments = least_increments ? std::optional(true) : std::nullopt,
          .tool_lengths_mm = tool_lengths,
          .work_offsets = work_offsets};
}

camber::CheckResult check(const py::object& program, const py::object& machine, const py::object& job,
                          const py::object& progress, bool strict, int threads) {
  if (!machine.is_none() && !job.is_none()) throw py::value_error("machine or job was expected, not both");
  const camber::Program text = program_of(program);
  std::optional<camber::Job> of_job;
  std::optional<camber::Machine> on;
  if (!job.is_none()) of_job = job_of(job);
  if (!machine.is_none()) on = machine_of(machine);
  camber::CheckResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = of_job ? camber::check(text, *of_job, run) : on ? camber::check(text, *on, run) : camber::check(text, run);
  });
  return result;
}

camber::FeedResult feed(const py::object& program, const py::object& machine, bool points, const py::object& progress,
                        bool strict, int threads) {
  const camber::Machine on = machine_of(machine);
  const camber::Program text = program_of(program);
  camber::FeedResult result;
  call({progress, strict, threads},
       [&](const camber::RunOptions& run) { result = camber::feed(text, on, {.points = points}, run); });
  return result;
}

camber::TimeResult time(const py::object& program, const py::object& machine, const std::optional<Path>& trace,
                        const std::vector<std::string>& sweeps, const py::object& progress, bool strict, int threads) {
  const camber::Machine on = machine_of(machine);
  const camber::Program text = program_of(program);
  camber::TimeResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = camber::time(text, on, {.trace = trace ? trace->string() : std::string(), .sweeps = sweeps}, run);
  });
  return result;
}

camber::FitFeedResult fit_feed(const std::vector<std::pair<py::object, Path>>& traces, const py::object& machine,
                               const std::optional<Path>& columns, bool update, const py::object& progress, bool strict,
                               int threads) {
  const camber::Machine start = machine_of(machine);
  std::vector<camber::FeedTrace> runs;
  for (const auto& [program, trace] : traces) runs.push_back({program_of(program), trace.string()});
  std::optional<camber::FitFeedResult> result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result =
        camber::fit_feed(runs, start, {.columns = columns ? columns->string() : std::string(), .update = update}, run);
  });
  return *std::move(result);
}

camber::PredictResult predict(const py::object& job, bool feed, const std::optional<Path>& output_folder,
                              std::size_t forces_at, const std::optional<Path>& trace,
                              const std::optional<Path>& columns, bool meshes, const py::object& progress, bool strict,
                              int threads) {
  const camber::Job given = job_of(job);
  camber::PredictResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = camber::predict(given,
                             {.feed = feed,
                              .output_folder = output_folder ? output_folder->string() : std::string(),
                              .forces_at = forces_at,
                              .trace = trace ? trace->string() : std::string(),
                              .columns = columns ? columns->string() : std::string(),
                              .meshes = meshes},
                             run);
  });
  return result;
}

camber::CompensateResult compensate(const py::object& job, const std::vector<std::string>& uncertainty,
                                    const std::optional<Path>& measured, const std::optional<Path>& measured_program,
                                    const std::vector<double>& check_voxels_mm, const std::vector<std::string>& levers,
                                    const std::optional<double>& time_budget_percent, bool keep_anyway, bool header,
                                    bool header_hash, const std::optional<Path>& output, const py::object& progress,
                                    bool strict, int threads) {
  const camber::Job given = job_of(job);
  const camber::CompensateOptions options{
      .uncertainty = uncertainty,
      .measured = measured ? measured->string() : std::string(),
      .measured_program = measured_program ? measured_program->string() : std::string(),
      .check_voxels_mm = check_voxels_mm,
      .levers = levers,
      .time_budget_percent = time_budget_percent,
      .keep_anyway = keep_anyway,
      .header = header,
      .header_hash = header_hash,
      .output = output ? output->string() : std::string()};
  camber::CompensateResult result;
  call({progress, strict, threads},
       [&](const camber::RunOptions& run) { result = camber::compensate(given, options, run); });
  return result;
}

camber::VerifyResult verify(const Path& place, const py::object& progress, bool strict, int threads) {
  camber::VerifyResult result;
  call({progress, strict, threads},
       [&](const camber::RunOptions& run) { result = camber::verify(place.string(), run); });
  return result;
}

camber::AdaptResult adapt(const py::object& job, const std::optional<double>& time_limit_s, bool sweep,
                          const py::object& progress, bool strict, int threads) {
  const camber::Job given = job_of(job);
  camber::AdaptResult result;
  call({progress, strict, threads}, [&](const camber::RunOptions& run) {
    result = camber::adapt(given, {.time_limit_s = time_limit_s, .sweep = sweep}, run);
  });
  return result;
}

void add_readers(py::module_& module) {
  module.def(
      "read_program",
      [](const Path& path, const std::optional<std::string>& units, bool block_skip,
         const std::vector<int>& skip_switches, const std::string& dialect, bool least_increments,
         const std::map<int, double>& tool_lengths, const std::map<std::string, std::vector<double>>& work_offsets) {
        return camber::read_program(path.string(), read_options(units, block_skip, skip_switches, dialect,
                                                                least_increments, tool_lengths, work_offsets));
      },
      "path"_a, py::kw_only(), "units"_a = py::none(), "block_skip"_a = false, "skip_switches"_a = std::vector<int>(),
      "dialect"_a = "", "least_increments"_a = false, "tool_lengths"_a = std::map<int, double>(),
      "work_offsets"_a = std::map<std::string, std::vector<double>>());
  module.def(
      "program_from_text",
      [](const std::string& name, const std::string& text, const std::optional<std::string>& units, bool block_skip,
         const std::vector<int>& skip_switches, const std::string& dialect, bool least_increments,
         const std::map<int, double>& tool_lengths, const std::map<std::string, std::vector<double>>& work_offsets) {
        return camber::program_from_text(
            name, text,
            read_options(units, block_skip, skip_switches, dialect, least_increments, tool_lengths, work_offsets));
      },
      "name"_a, "text"_a, py::kw_only(), "units"_a = py::none(), "block_skip"_a = false,
      "skip_switches"_a = std::vector<int>(), "dialect"_a = "", "least_increments"_a = false,
      "tool_lengths"_a = std::map<int, double>(), "work_offsets"_a = std::map<std::string, std::vector<double>>());
  module.def(
      "read_machine", [](const Path& path) { return camber::read_machine(path.string()); }, "path"_a);
  module.def(
      "read_job", [](const Path& path) { return camber::read_job(path.string()); }, "path"_a);
  module.def(
      "read_unprogrammed_job", [](const Path& path) { return camber::read_unprogrammed_job(path.string()); }, "path"_a);
}

}  // namespace

void add_functions(py::module_& module) {
  add_readers(module);
  module.def("check", check, "program"_a, py::kw_only(), "machine"_a = py::none(), "job"_a = py::none(),
             "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Statistics of a program, and whether a machine or a job can run it.");
  module.def(
      "explain_kinematics",
      [](const py::object& machine) {
        return py::isinstance<camber::Job>(machine) ? camber::explain_kinematics(machine.cast<camber::Job>())
                                                    : camber::explain_kinematics(machine_of(machine));
      },
      "machine"_a,
      "The axes of a machine from the part to the spindle, and what a positive word of each turns which way.");
  module.def("feed", feed, "program"_a, "machine"_a, py::kw_only(), "points"_a = true, "progress"_a = py::none(),
             "strict"_a = false, "threads"_a = 0, "Actual axis positions and feed at every interpolation period.");
  module.def("time", time, "program"_a, "machine"_a, py::kw_only(), "trace"_a = py::none(),
             "sweep"_a = std::vector<std::string>(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Cycle time by kind of operation and by tool.");
  module.def("fit_feed", fit_feed, "traces"_a, "machine"_a, py::kw_only(), "columns"_a = py::none(), "update"_a = false,
             "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Fits the feed model of a machine to pairs of a program and its trace.");
  module.def("predict", predict, "job"_a, py::kw_only(), "feed"_a = false, "output_folder"_a = py::none(),
             "forces_at"_a = 0, "trace"_a = py::none(), "columns"_a = py::none(), "meshes"_a = false,
             "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Cutting force, deflection and form error of a job.");
  module.def("compensate", compensate, "job"_a, py::kw_only(), "uncertainty"_a = std::vector<std::string>(),
             "measured"_a = py::none(), "measured_program"_a = py::none(), "check_voxels_mm"_a = std::vector<double>(),
             "levers"_a = std::vector<std::string>(), "time_budget_percent"_a = py::none(), "keep_anyway"_a = false,
             "header"_a = false, "header_hash"_a = false, "output"_a = py::none(), "progress"_a = py::none(),
             "strict"_a = false, "threads"_a = 0,
             "Compensates the program of a job: shifts its path against the form error.");
  module.def("verify", verify, "place"_a, py::kw_only(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Judges a program that compensate has written again, from its text.");
  module.def(
      "open_study",
      [](const Path& path, const Path& folder) { return camber::open_study(path.string(), folder.string()); }, "path"_a,
      "folder"_a, "The cases of a study, each with a job of its own in the folder, and their table so far.");
  module.def(
      "predict_section",
      [](const Path& job_path, const Path& folder, std::size_t sections, std::size_t section, bool solve, int round,
         std::size_t forces_at, const py::object& progress, bool strict, int threads) {
        camber::SectionResult result;
        call({progress, strict, threads}, [&](const camber::RunOptions& run) {
          result = camber::predict_section(
              job_path.string(), folder.string(),
              {.sections = sections, .section = section, .solve = solve, .round = round, .forces_at = forces_at}, run);
        });
        return result;
      },
      "job_path"_a, "folder"_a, py::kw_only(), "sections"_a, "section"_a, "solve"_a = false, "round"_a = 1,
      "forces_at"_a = 0, "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
      "Computes one part of a prediction in sections of the path, unless it is there.");
  module.def(
      "merge",
      [](const Path& folder, const py::object& progress, bool strict, int threads) {
        camber::PredictResult result;
        call({progress, strict, threads},
             [&](const camber::RunOptions& run) { result = camber::merge(folder.string(), run); });
        return result;
      },
      "folder"_a, py::kw_only(), "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
      "Joins the parts that predict_section has written.");
  module.def("adapt", adapt, "job"_a, py::kw_only(), "time_limit_s"_a = py::none(), "sweep"_a = false,
             "progress"_a = py::none(), "strict"_a = false, "threads"_a = 0,
             "Changes the feeds of a job's program so that the loads of its cut keep the limits of [adapt].");
}

}  // namespace camber_python

PYBIND11_MODULE(_camber, module) {
  module.attr("__version__") = camber::version();
  camber_python::add_exceptions(module);
  camber_python::add_inputs(module);
  camber_python::add_results(module);
  camber_python::add_functions(module);
  camber_python::add_copy(module);
  camber_python::add_plan(module);
  camber_python::add_five_axis(module);
  camber_python::add_fits(module);
}
