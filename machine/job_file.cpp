// job.toml into a Job.
#include <algorithm>
#include <filesystem>
#include <regex>

#include <fmt/format.h>

#include "base/triangle_mesh.h"
#include "machine/compensation_settings.h"
#include "machine/job_file.h"
#include "machine/job_keys.h"
#include "machine/job_tables.h"
#include "machine/machine_presets.h"
#include "machine/material_reader.h"

namespace camber::machine {
namespace {

namespace fs = std::filesystem;

/// Path at `key` against the job's folder; "" where it is not given. The file must be there.
std::string file_at(TomlTable& table, std::string_view key, const fs::path& folder) {
  const std::string given = table.text(key, "");
  if (given.empty()) return {};
  const std::string path = (folder / given).lexically_normal().string();
  std::error_code ec;
  if (!fs::exists(path, ec))
    table.error_at(key, fmt::format("{}: no such file: {} (paths are relative to the job's folder)", key, path),
                   "file-missing");
  else if (fs::is_directory(path, ec))
    table.error_at(key, fmt::format("{}: {} is a folder; a file was expected", key, path), "file-unreadable");
  return path;
}

std::string required_file_at(TomlTable& table, std::string_view key, const fs::path& folder) {
  if (!table.has(key)) table.missing(key, "the path of a file, in quotes");
  return file_at(table, key, folder);
}

std::optional<Box> read_box(TomlTable& table) {
  const auto rows = table.number_rows("box_mm", 2, 3, kAnyNumber, "[[x, y, z], [x, y, z]], two opposite corners,");
  if (!rows) return std::nullopt;
  Box box;
  for (int i = 0; i < 3; ++i) {
    box.min_mm[i] = (*rows)[0][static_cast<std::size_t>(i)];
    box.max_mm[i] = (*rows)[1][static_cast<std::size_t>(i)];
    if (!(box.min_mm[i] < box.max_mm[i]))
      table.error_at("box_mm",
                     fmt::format("box_mm goes from {0} = {1} to {0} = {2}; the second must be greater than the first",
                                 "xyz"[i], box.min_mm[i], box.max_mm[i]),
                     "stock-box");
  }
  return box;
}

std::optional<Cylinder> read_cylinder(TomlTable& stock) {
  auto table = stock.table("cylinder");
  if (!table) return std::nullopt;
  Cylinder cylinder;
  if (!table->has("base_mm")) table->missing("base_mm", "[x, y, z], the middle of the lower face,");
  if (const auto base = table->numbers("base_mm", 3, kAnyNumber, "[x, y, z], the middle of the lower face,"))
    cylinder.base_mm = {(*base)[0], (*base)[1], (*base)[2]};
  cylinder.diameter_mm = table->required_number("diameter_mm", kPositive);
  cylinder.height_mm = table->required_number("height_mm", kPositive);
  table->finish();
  return cylinder;
}

}  // namespace

TriangleMesh part_mesh(const PartDescription& part) {
  TriangleMesh mesh = read_mesh(part.mesh);
  for (Eigen::Vector3f& p : mesh.points) p = (p.cast<double>() + part.move_mm).cast<float>();
  return mesh;
}

void read_stock(TomlTable table, const fs::path& folder, StockDescription& stock) {
  stock.box = read_box(table);
  stock.cylinder = read_cylinder(table);
  stock.mesh = file_at(table, "mesh", folder);
  stock.vdb = file_at(table, "vdb", folder);
  stock.allowance_mm = table.number("allowance_mm", kNotNegative, 0);
  table.ignore("assumed");  // assumptions.h
  std::string_view first;
  for (const std::string_view key : {"box_mm", "cylinder", "mesh", "vdb"}) {
    if (!table.has(key)) continue;
    if (first.empty())
      first = key;
    else
      table.error_at_name(key, fmt::format("the stock has {} and {}; one of them was expected", first, key),
                          "stock-shape");
  }
  if (first.empty()) table.missing("box_mm", "box_mm = [[x, y, z], [x, y, z]], cylinder, mesh or vdb");
  table.finish();
}

namespace {

constexpr std::size_t kLongestPattern = 400;  // std::regex needs stack for each character

void read_comments(TomlTable& table, Operations& operations) {
  operations.comments = table.text("comments", "");
  if (operations.comments.size() > kLongestPattern) {
    table.error_at("comments",
                   fmt::format("comments has {} characters; at most {} were expected", operations.comments.size(),
                               kLongestPattern),
                   "regular-expression");
    operations.comments.clear();
  }
  try {
    const std::regex check(operations.comments, std::regex::ECMAScript | std::regex::icase);
  } catch (const std::regex_error&) {
    table.error_at(
        "comments",
        fmt::format("comments = \"{}\" is not a regular expression; one such as \"finish|contour\" was expected",
                    operations.comments),
        "regular-expression");
    operations.comments.clear();
  }
}

Operations read_operations(TomlTable table, const std::map<int, Tool>& tools) {
  Operations operations;
  for (const double t :
       table.number_list("tools", kToolNumber, "tool numbers, as in [1, 9],").value_or(std::vector<double>{})) {
    operations.tools.push_back(static_cast<int>(t));
    if (!tools.contains(static_cast<int>(t)))
      table.error_at("tools", fmt::format("operations name T{0}, but there is no [tool.{0}]", t), "tool-missing");
  }
  const auto rows = table.number_rows("blocks", 0, 2, kLineNumber, "ranges of lines, as in [[120, 900]],");
  for (const auto& row : rows.value_or(std::vector<std::vector<double>>{})) {
    operations.blocks.push_back({static_cast<int>(row[0]), static_cast<int>(row[1])});
    if (row[0] > row[1])
      table.error_at("blocks",
                     fmt::format("blocks go from line {} to line {}; the first must not be greater", row[0], row[1]),
                     "value-range");
  }
  read_comments(table, operations);
  table.finish();
  return operations;
}

void read_simulation(TomlTable table, Simulation& simulation) {
  read_numbers<Simulation>(table, kSimulationKeys, simulation);
  simulation.coupling = table.choice("coupling", kCouplingWords, simulation.coupling == Coupling::rigid ? 0 : 1) == 0
                            ? Coupling::rigid
                            : Coupling::static_;
  if (table.has("collisions")) {
    const std::size_t word = table.choice("collisions", kCollisionsWords, kCollisionsWords.size());
    if (word < kCollisionsWords.size()) simulation.collisions = static_cast<Collisions>(word);
  }
  simulation.max_memory_GB = table.optional_number("max_memory_GB", kPositive);
  table.finish();
}

void read_profile(TomlTable& table, CompensationSettings& compensation) {
  constexpr std::string_view kWanted = "[lower, upper], the band of the finished surface,";
  if (const auto band = table.numbers("profile_um", 2, kAnyNumber, kWanted)) {
    compensation.profile_um = {(*band)[0], (*band)[1]};
    if ((*band)[0] >= 0 || (*band)[1] <= 0)
      table.error_at("profile_um",
                     fmt::format("profile_um = [{:g}, {:g}]; a lower end below zero (into the part) and an upper end "
                                 "above it were expected",
                                 (*band)[0], (*band)[1]),
                     "value-range");
  }
  if (table.has("profile_um") && compensation.max_overcut_um > 0)
    table.error_at_name("max_overcut_um",
                        "[compensation] has profile_um and max_overcut_um, which is its lower end; one of them was "
                        "expected",
                        "profile");
}

void read_levers(TomlTable& table, CompensationSettings& compensation) {
  const auto names = table.text_list("levers", kWantedLevers);
  if (!names) return;
  const LeverNames read = levers_of(*names);
  compensation.levers = read.levers;
  for (const std::string& message : read.errors) table.error_at("levers", message, "value-choice");
}

void read_compensation(TomlTable table, const std::map<int, Tool>& tools, CompensationSettings& compensation) {
  read_numbers<CompensationSettings>(table, kCompensationKeys, compensation);
  compensation.max_rounds = static_cast<int>(table.number("max_rounds", kRounds, compensation.max_rounds));
  if (table.choice("reference", kReferenceWords, 0) == 1) compensation.reference = Reference::machine;
  if (table.choice("goal", kGoalWords, 0) == 1) compensation.goal = Goal::tolerance;
  compensation.time_budget_percent = table.optional_number("time_budget_percent", kTimeBudget);
  read_profile(table, compensation);
  read_levers(table, compensation);
  if (const auto operations = table.table("operations")) compensation.operations = read_operations(*operations, tools);
  constexpr std::string_view kOffset = "[x, y, z], the program's zero in machine coordinates,";
  if (const auto offset = table.numbers("work_offset_mm", 3, kAnyNumber, kOffset))
    compensation.work_offset_mm = Vec3((*offset)[0], (*offset)[1], (*offset)[2]);
  table.finish();
}

/// Returns whether a limit bounds the feed from above.
bool read_limits(TomlTable table, AdaptLimits& limits) {
  bool bounded = false;
  for (const LimitKey& k : kLimitKeys) {
    const auto value = table.optional_number(k.key, k.range);
    if (!value) continue;
    limits.*k.field = k.unit.inside_from_file(*value);
    bounded = bounded || (k.key != "chip_min_mm" && k.key != "chatter_margin");
  }
  const bool by_speed_alone = table.has("chatter_margin") && !limits.chip_min_mm;
  if (!bounded && !by_speed_alone)
    table.error_at(
        "",
        "limits has no load that bounds the feed from above; at least one of force_N, torque_Nm, deflection_um, "
        "form_error_um, chip_mm and power_W was expected, or chatter_margin alone",
        "limits-missing");
  if (limits.chip_min_mm && limits.chip_mm && *limits.chip_min_mm >= *limits.chip_mm)
    table.error_at("chip_min_mm",
                   fmt::format("chip_min_mm = {:g} is not below chip_mm = {:g}; a thinner chip was expected",
                               *limits.chip_min_mm, *limits.chip_mm),
                   "value-range");
  table.finish();
  return bounded;
}

void read_adapt_levers(TomlTable& table, AdaptSettings& adapt) {
  constexpr std::string_view kWanted = "a list of \"feed\" and \"speed\"";
  const auto names = table.text_list("levers", kWanted);
  if (!names) return;
  adapt.levers.clear();
  for (const std::string& name : *names) {
    const auto word = std::ranges::find(kAdaptLeverWords, name);
    if (word == kAdaptLeverWords.end())
      table.error_at("levers", fmt::format("levers names \"{}\"; {} was expected", name, kWanted), "value-choice");
    else if (const auto lever = static_cast<AdaptLever>(word - kAdaptLeverWords.begin()); !adapt.has(lever))
      adapt.levers.push_back(lever);
  }
  if (names->empty())
    table.error_at("levers", fmt::format("levers is empty; {} was expected", kWanted), "value-choice");
  if (!names->empty() && adapt.bounds_feed && !adapt.has(AdaptLever::feed))
    table.error_at("levers",
                   "levers does not name \"feed\", by which alone a load is kept within limits; [\"feed\", \"speed\"] "
                   "or chatter_margin as the only limit was expected",
                   "value-choice");
  if (adapt.has(AdaptLever::speed) && table.has("limits") && !adapt.limits.chatter_margin)
    table.error_at("levers",
                   "levers names \"speed\", but limits has no chatter_margin, by which speeds are chosen; limits = { "
                   "chatter_margin = 0.8 } was expected",
                   "value-choice");
}

void read_spindle_speeds(TomlTable& table, AdaptSettings& adapt) {
  constexpr std::string_view kWanted = "[lowest, highest], the spindle speeds that may be used,";
  const auto speeds = table.numbers("spindle_rpm", 2, kPositive, kWanted);
  if (!speeds) return;
  adapt.spindle_rpm = {(*speeds)[0], (*speeds)[1]};
  if ((*speeds)[0] >= (*speeds)[1])
    table.error_at("spindle_rpm",
                   fmt::format("spindle_rpm = [{:g}, {:g}]: the lowest speed is not below the highest; [lowest, "
                               "highest] was expected",
                               (*speeds)[0], (*speeds)[1]),
                   "value-range");
  if (!adapt.has(AdaptLever::speed))
    table.error_at_name("spindle_rpm",
                        "[adapt] has spindle_rpm, but levers does not name \"speed\"; levers = [\"feed\", \"speed\"] "
                        "was expected",
                        "value-choice");
}

AdaptSettings read_adapt(TomlTable table) {
  AdaptSettings out;
  read_numbers<AdaptSettings>(table, kAdaptKeys, out);
  if (table.has("limits")) {
    out.limits_place = table.place_of("limits");
    if (auto limits = table.table("limits")) out.bounds_feed = read_limits(*limits, out.limits);
  } else {
    table.missing("limits", "a table such as { force_N = 150.0 }");
  }
  read_adapt_levers(table, out);
  read_spindle_speeds(table, out);
  constexpr std::string_view kWanted = "[lowest, highest], the feeds that may be used,";
  if (!table.has("feed_mm_per_min")) {
    if (out.bounds_feed || !out.limits.chatter_margin)
      table.missing("feed_mm_per_min", "[lowest, highest], such as [300, 3000]");
  } else if (const auto feeds = table.numbers("feed_mm_per_min", 2, kPositive, kWanted)) {
    out.lowest_feed_mm_per_s = mm_per_s_from_mm_per_min((*feeds)[0]);
    out.highest_feed_mm_per_s = mm_per_s_from_mm_per_min((*feeds)[1]);
    if ((*feeds)[0] >= (*feeds)[1])
      table.error_at("feed_mm_per_min",
                     fmt::format("feed_mm_per_min = [{:g}, {:g}]: the lowest feed is not below the highest; [lowest, "
                                 "highest] was expected",
                                 (*feeds)[0], (*feeds)[1]),
                     "value-range");
  }
  table.finish();
  return out;
}

void read_part(TomlTable table, const fs::path& folder, const std::map<int, Tool>& tools, PartDescription& part) {
  part.mesh = file_at(table, "mesh", folder);
  if (const auto move = table.numbers("move_mm", 3, kAnyNumber, "[x, y, z], by which the mesh is moved,"))
    part.move_mm = Vec3((*move)[0], (*move)[1], (*move)[2]);
  part.program = file_at(table, "program", folder);
  if (const auto operations = table.table("operations")) part.operations = read_operations(*operations, tools);
  if (const auto judged = table.table("judged")) part.judged = read_operations(*judged, tools);
  table.finish();
}

constexpr std::string_view kFixedWanted =
    "\"bottom\", a list of boxes such as [[[x, y, z], [x, y, z]]], or the path of an STL file in quotes";

/// The corners of boxes, two by two: [[x, y, z], [x, y, z]] is one box, and a list of such are several.
std::optional<std::vector<Vec3>> corners_of(const TomlNode& list) {
  std::vector<Vec3> out;
  for (const TomlNode& item : list.items) {
    if (item.kind != TomlNode::Kind::array) return std::nullopt;
    const bool box = !item.items.empty() && item.items[0].kind == TomlNode::Kind::array;
    if (box) {
      const auto own = corners_of(item);
      if (!own || own->size() != 2) return std::nullopt;
      out.insert(out.end(), own->begin(), own->end());
      continue;
    }
    if (item.items.size() != 3) return std::nullopt;
    for (const TomlNode& n : item.items)
      if (n.kind != TomlNode::Kind::number) return std::nullopt;
    out.emplace_back(item.items[0].number, item.items[1].number, item.items[2].number);
  }
  if (out.empty() || out.size() % 2 != 0) return std::nullopt;
  return out;
}

void read_fixed_boxes(TomlTable& table, Workpiece& workpiece) {
  table.ignore("fixed");
  workpiece.fixed_bottom = false;
  const auto entry = std::ranges::find(table.entries(), "fixed", &TomlNode::Entry::key);
  const auto corners = corners_of(entry->value);
  if (!corners)
    return table.error_at("fixed", fmt::format("fixed is not a list of boxes; {} was expected", kFixedWanted),
                          "value-type");
  for (std::size_t i = 0; i < corners->size(); i += 2)
    workpiece.fixed_boxes.push_back(
        {(*corners)[i].cwiseMin((*corners)[i + 1]), (*corners)[i].cwiseMax((*corners)[i + 1])});
}

void read_fixed(TomlTable& table, const fs::path& folder, Workpiece& workpiece) {
  if (!table.has("fixed")) return;
  if (table.is_list("fixed")) return read_fixed_boxes(table, workpiece);
  if (table.text("fixed", "") == "bottom") return;
  workpiece.fixed_bottom = false;
  workpiece.fixed_mesh = file_at(table, "fixed", folder);
}

Workpiece read_workpiece(TomlTable table, const fs::path& folder) {
  Workpiece out;
  out.place = table.place_of("fixed");
  out.youngs_modulus_MPa = MPa_from_GPa(table.required_number("youngs_modulus_GPa", kPositive));
  read_numbers<Workpiece>(table, kWorkpieceKeys, out);
  read_fixed(table, folder, out);
  table.finish();
  return out;
}

void read_tables(TomlTable& top, const fs::path& folder, Job& job, Diagnostics& diagnostics) {
  read_tools(top, folder, job.inch.value_or(false), job.tools, diagnostics);
  if (job.tools.empty() && !top.has("tool")) top.missing("[tool.1]", "a table for each tool of the program");
  if (const auto operations = top.table("operations")) job.operations = read_operations(*operations, job.tools);
  if (auto material = top.table("material"))
    job.material = read_material_table(*material, folder.string(), diagnostics);
  else if (!top.has("material"))
    top.missing("[material]", "a table with the specific cutting forces ktc_MPa, krc_MPa ...");
  if (auto stock = top.table("stock"))
    read_stock(*stock, folder, job.stock), job.voxel_place = stock->place_of("");
  else if (!top.has("stock"))
    top.missing("[stock]", "a table with box_mm, cylinder, mesh or vdb");
  if (auto part = top.table("part")) read_part(*part, folder, job.tools, job.part);
  if (auto simulation = top.table("simulation")) {
    read_simulation(*simulation, job.simulation);
    if (simulation->has("voxel_mm")) job.voxel_place = simulation->place_of("voxel_mm");
  }
  if (auto compensation = top.table("compensation")) read_compensation(*compensation, job.tools, job.compensation);
  if (auto adapt = top.table("adapt")) job.adapt = read_adapt(*adapt);
  job.features = read_features(top, folder);
  job.model_error = read_model_error(top);
  if (auto workpiece = top.table("workpiece")) {
    job.workpiece_modes = read_modes(*workpiece);
    if (job.workpiece_modes.empty() || workpiece->has("youngs_modulus_GPa"))
      job.workpiece = read_workpiece(*workpiece, folder);
    else
      workpiece->finish();
  }
}

}  // namespace

std::string machine_path_at(TomlTable& top, const fs::path& folder) {
  if (top.kind_of("machine") != TomlNode::Kind::text) return required_file_at(top, "machine", folder);
  const std::string given = top.text("machine", "");
  if (!is_preset(given)) return required_file_at(top, "machine", folder);
  if (find_machine_preset(given) == nullptr) top.error_at("machine", unknown_machine_preset(given), "machine-preset");
  return given;
}

namespace {

/// program = ["rough.nc", "finish.nc"]; one or more.
std::vector<std::string> read_programs(TomlTable& top, const fs::path& folder) {
  constexpr std::string_view kWanted = "a list of NC programs, as in [\"rough.nc\", \"finish.nc\"],";
  std::vector<std::string> out;
  for (const std::string& given : top.text_list("program", kWanted).value_or(std::vector<std::string>{})) {
    out.push_back((folder / given).lexically_normal().string());
    std::error_code ec;
    if (!fs::is_regular_file(out.back(), ec))
      top.error_at("program",
                   fmt::format("program: no such file: {} (paths are relative to the job's folder)", out.back()),
                   "file-missing");
  }
  if (out.empty())
    top.error_at("program", "program is an empty list; at least one NC program was expected", "program-list");
  return out;
}

/// Keys that belong to one program alone.
void check_several(TomlTable& top, const JobOfPrograms& read) {
  if (read.programs.size() < 2) return;
  const auto refuse = [&](const char* what) {
    top.error_at("program",
                 fmt::format("the job has {} programs, and {} belong to one; a job for each program was expected",
                             read.programs.size(), what),
                 "several-programs");
  };
  const Job& job = read.job;
  if (!job.operations.blocks.empty() || !job.compensation.operations.blocks.empty()) refuse("the lines of operations");
  if (!job.part.program.empty() || job.part.operations || job.part.judged) refuse("part.program and its operations");
}

enum class ProgramKey { none, one, several };

JobOfPrograms read(const std::string& path, Diagnostics& diagnostics, ProgramKey programs) {
  JobOfPrograms out;
  Job& job = out.job;
  job.path = path;
  const auto file =
      read_toml(path, "a job description (program, machine, [tool.1], [material], [stock] ...)", diagnostics);
  diagnostics.throw_if_errors();
  const fs::path folder = fs::path(path).parent_path();
  TomlTable top = TomlTable::top(*file, diagnostics);
  if (programs != ProgramKey::none && top.is_list("program")) {
    out.programs = read_programs(top, folder);
    if (!out.programs.empty()) job.program = out.programs.front();
    if (programs == ProgramKey::one && out.programs.size() > 1)
      top.error_at("program",
                   fmt::format("the job has {} programs, which predict, compensate and check run one after the other; "
                               "one program was expected here",
                               out.programs.size()),
                   "several-programs");
  } else if (programs != ProgramKey::none) {
    job.program = required_file_at(top, "program", folder);
    out.programs = {job.program};
  } else if (const std::string made = top.text("program", ""); !made.empty()) {
    job.program = (folder / made).lexically_normal().string();
  }
  job.machine_path = machine_path_at(top, folder);
  if (top.has("units")) job.inch = top.choice("units", kUnitWords, 0) == 1;
  read_tables(top, folder, job, diagnostics);
  check_several(top, out);
  top.ignore("force_log");  // fit-force's own
  top.ignore("copy");       // machine/copy_operations.h
  top.finish();
  std::error_code ec;
  if (find_machine_preset(job.machine_path) || fs::is_regular_file(job.machine_path, ec))
    job.machine = read_machine(job.machine_path, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

}  // namespace

Job read_job(const std::string& path, Diagnostics& diagnostics) { return read(path, diagnostics, ProgramKey::one).job; }

Job read_unprogrammed_job(const std::string& path, Diagnostics& diagnostics) {
  return read(path, diagnostics, ProgramKey::none).job;
}

JobOfPrograms read_job_of_programs(const std::string& path, Diagnostics& diagnostics) {
  return read(path, diagnostics, ProgramKey::several);
}

}  // namespace camber::machine
