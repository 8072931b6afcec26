#include "report/compensation_tables.h"

#include <fmt/format.h>

namespace camber::report {
namespace {

std::string um(double value) { return fmt::format("{:.2f}", value); }

TextTable split_table(const compensate::CompensationResult& c) {
  TextTable table{"Error decomposition", {"part of the error", "before, µm rms", "after, µm rms"}, {}, {}};
  const auto add = [&](const char* name, double compensate::ErrorSplit::*part) {
    const double before = c.split_before.*part, after = c.split_after.*part;
    if (before > 0 || after > 0) table.rows.push_back({name, um(before), um(after)});
  };
  using Split = compensate::ErrorSplit;
  add("a shift of the path takes away", &Split::correctable_um);
  add("given up so as not to cut into the part", &Split::guard_um);
  add("a shift over max_shift_mm would take away", &Split::limited_um);
  add("about the axis of a round tip", &Split::tip_um);
  add("differs along the cutter's profile (helix bow)", &Split::bow_um);
  add("on surfaces that face each other", &Split::opposed_um);
  add("changes faster than a smooth path can", &Split::short_range_um);
  add("made by moves that are not compensated", &Split::not_compensated_um);
  table.note = "Squares add up to the square of the whole error.";
  return table;
}

std::string place(const Vec3& p) { return fmt::format("X{:.3f} Y{:.3f} Z{:.3f}", p.x(), p.y(), p.z()); }

TextTable depth_table(const compensate::CompensationResult& c) {
  TextTable table{"Into the part", {"", "all but a thousandth, µm", "deepest point, µm", "where"}, {}, {}};
  const auto add = [&](const char* name, const compensate::Depth& d) {
    table.rows.push_back({name, um(d.held_um), um(d.deepest_um), d.deepest_um > 0 ? place(d.place_mm) : ""});
  };
  add("before", c.depth_before);
  add("after", c.depth_after);
  add("after, by moves that are not compensated", c.depth_others);
  add("after, if the tool did not bend at all", c.depth_without_bending);
  return table;
}

TextTable band_table(const compensate::Band& band) {
  TextTable table{"How sure", {"", "µm"}, {}, {}};
  for (const auto& group : band.groups) table.rows.push_back({"moves with " + group.name + ", rms", um(group.rms_um)});
  table.rows.push_back({"error to be expected, rms", um(band.rms_um)});
  table.rows.push_back({"95 % of the error with its uncertainty", um(band.p95_um)});
  table.note = fmt::format(
      "Safe share of the compensation: {:.0f} %. With so much of each shift, at 95 % confidence in each point, no more "
      "than 5 % of the area is cut deeper into the part than the depth limit.",
      100 * band.safe_fraction);
  return table;
}

}  // namespace

std::vector<TextTable> compensation_tables(const compensate::CompensationResult& c) {
  std::vector<TextTable> tables{split_table(c), depth_table(c)};
  if (c.band) tables.push_back(band_table(*c.band));
  return tables;
}

}  // namespace camber::report
