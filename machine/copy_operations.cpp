#include "machine/copy_operations.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "machine/number_key.h"

namespace camber::machine {
namespace {

inline constexpr std::array<std::string_view, 3> kModeWords{"scanning-line", "contour-line", "drilling"};
inline constexpr std::array<std::string_view, 3> kSenseWords{"climb", "conventional", "both"};
inline constexpr std::array<std::string_view, 3> kCycleWords{"centre", "peck", "ream"};
inline constexpr std::array<std::string_view, 3> kSlottingWords{"by-load", "full-width", "trochoidal"};
inline constexpr NumberRange kRampDeg{.min = 0, .max = 45, .above_min = true};
inline constexpr NumberRange kAngleDeg{.min = -360, .max = 360};

/// Numbers that an operation has anyway. Spindle speed and feed must be given.
inline constexpr std::array kCopyKeys{
    NumberKey<CopyOperation>{"spindle_rpm", &CopyOperation::spindle_rpm, kPositive},
    NumberKey<CopyOperation>{"feed_mm_per_min", &CopyOperation::feed_mm_per_s, kPositive, kPerMinute},
    NumberKey<CopyOperation>{"radial_depth_mm", &CopyOperation::radial_depth_mm, kPositive},
    NumberKey<CopyOperation>{"axial_depth_mm", &CopyOperation::axial_depth_mm, kPositive},
    NumberKey<CopyOperation>{"allowance_mm", &CopyOperation::allowance_mm, kNotNegative},
    NumberKey<CopyOperation>{"scallop_mm", &CopyOperation::scallop_mm, kPositive},
    NumberKey<CopyOperation>{"angle_deg", &CopyOperation::angle_rad, kAngleDeg, kDegrees},
    NumberKey<CopyOperation>{"ramp_deg", &CopyOperation::ramp_rad, kRampDeg, kDegrees},
};

constexpr std::string_view kTwoCorners = "[[x, y], [x, y]], two opposite corners,";
constexpr std::string_view kPlaces = "places [x, y], as in [[10, 20], [30, 20]],";

std::vector<Vec2> points_of(TomlTable& table, std::string_view key, std::size_t rows, std::string_view wanted) {
  std::vector<Vec2> out;
  const auto given = table.number_rows(key, rows, 2, kAnyNumber, wanted);
  for (const auto& row : given.value_or(std::vector<std::vector<double>>{})) out.emplace_back(row[0], row[1]);
  return out;
}

constexpr std::string_view kBoxes = "boxes [x, y, z, x, y, z] of two opposite corners,";

void read_boxes(TomlTable& table, CopyRegion& out) {
  const auto rows = table.number_rows("boxes_mm", 0, 6, kAnyNumber, kBoxes);
  if (!rows) return;
  for (const auto& r : *rows) {
    out.boxes_mm.push_back({Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5])});
    if (!(out.boxes_mm.back()[0].array() < out.boxes_mm.back()[1].array()).all())
      table.error_at("boxes_mm",
                     fmt::format("box {} of boxes_mm is empty; the second corner must be greater in X, Y and Z than "
                                 "the first",
                                 out.boxes_mm.size()),
                     "region-empty");
  }
  if (out.boxes_mm.empty())
    table.error_at("boxes_mm", "boxes_mm has no box; one at least was expected", "region-empty");
  for (const std::string_view other : {"box_mm", "polygon_mm", "z_mm"})
    if (table.has(other))
      table.error_at_name(other, fmt::format("the region has boxes_mm and {}; one of them was expected", other),
                          "region");
}

/// Levels of the tip in all boxes.
std::array<double, 2> heights_of(const std::vector<CopyRegion::Box>& boxes) {
  std::array<double, 2> out{boxes.front()[0].z(), boxes.front()[1].z()};
  for (const CopyRegion::Box& b : boxes) out = {std::min(out[0], b[0].z()), std::max(out[1], b[1].z())};
  return out;
}

CopyRegion read_region(TomlTable table) {
  CopyRegion out;
  if (table.has("box_mm")) {
    if (const auto corners = points_of(table, "box_mm", 2, kTwoCorners); corners.size() == 2) {
      out.box_mm = {corners[0], corners[1]};
      if (!(corners[0].array() < corners[1].array()).all())
        table.error_at("box_mm", "box_mm is empty; the second corner must be greater in X and Y than the first",
                       "region-empty");
    }
  }
  if (table.has("polygon_mm")) {
    out.polygon_mm = points_of(table, "polygon_mm", 0, "corners [x, y], three at least,");
    if (out.polygon_mm.size() < 3)
      table.error_at("polygon_mm",
                     fmt::format("polygon_mm has {} corners; three at least were expected", out.polygon_mm.size()),
                     "region-empty");
    if (out.box_mm)
      table.error_at_name("polygon_mm", "the region has box_mm and polygon_mm; one of them was expected", "region");
  }
  read_boxes(table, out);
  if (const auto z = table.numbers("z_mm", 2, kAnyNumber, "[lowest, highest], levels of the tip,")) {
    out.z_mm = {(*z)[0], (*z)[1]};
    if ((*z)[0] >= (*z)[1])
      table.error_at("z_mm",
                     fmt::format("z_mm goes from {:g} to {:g}; [lowest, highest] was expected", (*z)[0], (*z)[1]),
                     "region-empty");
  }
  if (!out.boxes_mm.empty()) out.z_mm = heights_of(out.boxes_mm);
  table.finish();
  return out;
}

void check_boxes(TomlTable& table, const CopyOperation& operation) {
  if (operation.region.boxes_mm.empty()) return;
  if (operation.mode == CopyMode::drilling || operation.scallop_mm > 0)
    table.error_at("region",
                   fmt::format("boxes_mm in {}; they are for loops and rows level by level",
                               operation.mode == CopyMode::drilling ? "drilling" : "finishing by scallop"),
                   "copy-mode");
}

void require_depths(TomlTable& table, const CopyOperation& operation) {
  const bool drilling = operation.mode == CopyMode::drilling, finishing = operation.scallop_mm > 0;
  if (finishing && operation.mode != CopyMode::scanning_line)
    table.error_at(
        "scallop_mm",
        fmt::format("scallop_mm in mode {}; finishing by scallop is for scanning-line", word_of(operation.mode)),
        "copy-mode");
  if (!drilling && !finishing && !table.has("radial_depth_mm"))
    table.missing("radial_depth_mm", "the distance between loops or rows, or scallop_mm,");
  if (!finishing && !(drilling && operation.cycle != HoleCycle::peck) && !table.has("axial_depth_mm"))
    table.missing("axial_depth_mm", drilling ? "the depth of a peck" : "the distance between levels");
}

void check_slotting(TomlTable& table, const CopyOperation& operation) {
  if (!table.has("slotting")) return;
  if (operation.mode == CopyMode::drilling || operation.scallop_mm > 0)
    table.error_at_name("slotting",
                        fmt::format("slotting in {}; it is for loops and rows level by level",
                                    operation.mode == CopyMode::drilling ? "drilling" : "finishing by scallop"),
                        "copy-mode");
}

void check_tool(TomlTable& table, const CopyOperation& operation, const Job& job) {
  const auto found = job.tools.find(operation.tool);
  if (found == job.tools.end()) {
    table.error_at("tool", fmt::format("tool = {0}, but there is no [tool.{0}]", operation.tool), "tool-missing");
    return;
  }
  const ToolType type = found->second.type;
  const bool rounded = type == ToolType::ball || type == ToolType::flat || type == ToolType::bull;
  if (operation.mode != CopyMode::drilling && !rounded)
    table.error_at("tool",
                   fmt::format("[tool.{}] is no ball, flat or bull-nose cutter; one of them was expected for {}",
                               operation.tool, word_of(operation.mode)),
                   "tool-type");
  if (operation.mode != CopyMode::drilling && operation.radial_depth_mm > found->second.diameter_mm)
    table.error_at("radial_depth_mm",
                   fmt::format("radial_depth_mm = {:g} is more than the tool's diameter of {:g} mm",
                               operation.radial_depth_mm, found->second.diameter_mm),
                   "value-range");
  if (operation.spindle_rpm > job.machine.spindle.max_rpm)
    table.error_at("spindle_rpm",
                   fmt::format("spindle_rpm = {:g}; the machine's spindle turns at {:g} rpm at most",
                               operation.spindle_rpm, job.machine.spindle.max_rpm),
                   "spindle-speed");
}

void check_holes(TomlTable& table, const CopyOperation& operation) {
  if (operation.mode != CopyMode::drilling) {
    if (!operation.holes_mm.empty()) table.error_at_name("holes_mm", "holes_mm is for drilling", "copy-mode");
    return;
  }
  if (operation.holes_mm.empty() && !operation.region.box_mm)
    table.missing("holes_mm", "the places of the holes, or a region with box_mm,");
  if (!operation.region.z_mm)
    table.error_at("region",
                   "drilling needs region = { z_mm = [bottom, top] }: the tip's depth, and where the hole begins",
                   "region");
}

CopyOperation read_operation(TomlTable table, const Job& job) {
  CopyOperation out;
  out.place = table.place_of("");
  out.tool = static_cast<int>(table.required_number("tool", {.min = 0, .max = 99999999, .whole = true}));
  const auto mode = table.required_choice("mode", kModeWords);
  if (mode) out.mode = static_cast<CopyMode>(*mode);
  for (const std::string_view key : {"spindle_rpm", "feed_mm_per_min"})
    if (!table.has(key)) table.missing(key, "a number greater than zero");
  read_numbers<CopyOperation>(table, kCopyKeys, out);
  out.sense =
      static_cast<MillingSense>(table.choice("sense", kSenseWords, out.mode == CopyMode::scanning_line ? 2 : 0));
  out.plunge = table.boolean("plunge", false);
  out.slotting = static_cast<Slotting>(table.choice("slotting", kSlottingWords, 0));
  out.force_N = table.optional_number("force_N", kPositive);
  out.cycle = static_cast<HoleCycle>(table.choice("cycle", kCycleWords, 1));
  out.holes_mm = points_of(table, "holes_mm", 0, kPlaces);
  if (auto region = table.table("region")) out.region = read_region(*region);
  if (mode) {
    require_depths(table, out);
    check_slotting(table, out);
    check_boxes(table, out);
    check_tool(table, out, job);
    check_holes(table, out);
  }
  table.finish();
  return out;
}

}  // namespace

std::string_view word_of(CopyMode mode) { return kModeWords[static_cast<std::size_t>(mode)]; }

std::vector<CopyOperation> read_copy_operations(const std::string& path, const Job& job, Diagnostics& diagnostics) {
  const auto file = read_toml(path, "a job description with [[copy]]", diagnostics);
  TomlTable top = TomlTable::top(*file, diagnostics);
  std::vector<CopyOperation> out;
  if (!top.has("copy")) top.missing("[[copy]]", "a table for each operation");
  for (TomlTable& table : top.tables("copy")) out.push_back(read_operation(table, job));
  return out;
}

std::string to_toml(const CopyOperation& o) {
  std::string out = fmt::format("[[copy]]\ntool = {}\nmode = \"{}\"\n", o.tool, word_of(o.mode));
  const CopyOperation given{};
  for (const auto& k : kCopyKeys)
    if (o.*k.field != given.*k.field) out += toml_line(k.key, o.*k.field, k.unit);
  out += toml_line("sense", kSenseWords[static_cast<std::size_t>(o.sense)]);
  if (o.plunge) out += "plunge = true\n";
  if (o.slotting != given.slotting) out += toml_line("slotting", kSlottingWords[static_cast<std::size_t>(o.slotting)]);
  if (o.force_N) out += toml_line("force_N", *o.force_N, kAsIs);
  if (o.mode == CopyMode::drilling) out += toml_line("cycle", kCycleWords[static_cast<std::size_t>(o.cycle)]);
  const auto point = [](const Vec2& p) {
    return fmt::format("[{}, {}]", toml_number(p.x(), kAsIs), toml_number(p.y(), kAsIs));
  };
  const auto points = [&](const auto& list) {
    std::string text;
    for (const Vec2& p : list) text += (text.empty() ? "" : ", ") + point(p);
    return "[" + text + "]";
  };
  if (!o.holes_mm.empty()) out += "holes_mm = " + points(o.holes_mm) + "\n";
  std::string region;
  const auto add = [&](const std::string& text) { region += (region.empty() ? "" : ", ") + text; };
  if (o.region.box_mm) add("box_mm = " + points(*o.region.box_mm));
  if (!o.region.polygon_mm.empty()) add("polygon_mm = " + points(o.region.polygon_mm));
  const auto box = [](const CopyRegion::Box& b) {
    std::string text;
    for (const Vec3& p : b)
      for (const double v : p) text += (text.empty() ? "" : ", ") + toml_number(v, kAsIs);
    return "[" + text + "]";
  };
  std::string boxes;
  for (const CopyRegion::Box& b : o.region.boxes_mm) boxes += (boxes.empty() ? "" : ", ") + box(b);
  if (!boxes.empty()) add("boxes_mm = [" + boxes + "]");
  if (o.region.z_mm && boxes.empty())
    add(fmt::format("z_mm = [{}, {}]", toml_number((*o.region.z_mm)[0], kAsIs),
                    toml_number((*o.region.z_mm)[1], kAsIs)));
  if (!region.empty()) out += "region = { " + region + " }\n";
  return out;
}

}  // namespace camber::machine
