#include "report/page_tables.h"

#include <fmt/format.h>

namespace camber::report {
namespace {

std::string um(double value) { return fmt::format("{:.2f}", value); }

TextTable split_table(const compensate::CompensationResult& c) {
  TextTable table{"Error decomposition", {"part of the error", "before, µm rms", "after, µm rms"}, {}, {}};
  const auto add = [&](const char* name, double compensate::ErrorSplit::*part) {
    const double before = c.figures.split_before.*part, after = c.figures.split_after.*part;
    if (before > 0 || after > 0) table.rows.push_back({name, um(before), um(after)});
  };
  using Split = compensate::ErrorSplit;
  add("correctable by a shift of the path", &Split::correctable_um);
  add("given up to keep the depth limit", &Split::guard_um);
  add("given up so that no place becomes worse than given", &Split::bounded_um);
  add("needs a shift over max_shift_mm", &Split::limited_um);
  add("near the axis of a round tip", &Split::tip_um);
  add("differs along the cutter profile (helix bow)", &Split::bow_um);
  add("on opposite surfaces", &Split::opposed_um);
  add("changes along the path faster than a smooth path can", &Split::short_range_um);
  add("due to moves that are not compensated", &Split::not_compensated_um);
  table.note = "The squares add up to the square of the total error.";
  return table;
}

TextTable limits_table(const std::vector<compensate::BindingLimit>& limits) {
  TextTable table{"Limits that bind",
                  {"", "value", "binds no more at", "points held", "line", "95th percentile, µm", "without it, µm"},
                  {},
                  {}};
  for (const compensate::BindingLimit& limit : limits) {
    const compensate::LimitEffect& effect = limit.effect;
    table.rows.push_back({limit.key, fmt::format("{:.3g}{}", limit.value, limit.own ? "" : " (default)"),
                          fmt::format("{:.3g}", limit.binds_no_more_at), std::to_string(limit.count),
                          limit.line.given > 0 ? std::to_string(limit.line.given) : "",
                          effect.known() ? um(effect.with_um) : "", effect.known() ? um(effect.without_um) : ""});
  }
  table.note =
      "The last two columns: predicted for the stretch of the path that the limit holds back most; of a depth limit "
      "for "
      "the whole program.";
  return table;
}

std::string place(const Vec3& p) { return fmt::format("X{:.3f} Y{:.3f} Z{:.3f}", p.x(), p.y(), p.z()); }

TextTable depth_table(const compensate::CompensationResult& c) {
  TextTable table{"Gouge depth", {"", "all but a thousandth, µm", "deepest point, µm", "where"}, {}, {}};
  const auto add = [&](const char* name, const compensate::Depth& d) {
    table.rows.push_back(
        {name, um(d.gouge_depth_p999_um), um(d.deepest_um), d.deepest_um > 0 ? place(d.place_mm) : ""});
  };
  add("before", c.safety.before);
  add("after", c.safety.after);
  add("after, of moves that are not compensated", c.safety.others);
  add("after, with a rigid tool", c.safety.without_bending);
  return table;
}

TextTable band_table(const compensate::Band& band) {
  TextTable table{"How sure", {"", "µm"}, {}, {}};
  for (const auto& group : band.groups) table.rows.push_back({"moves with " + group.name + ", rms", um(group.rms_um)});
  table.rows.push_back({"expected error, rms", um(band.rms_um)});
  table.rows.push_back({"95 % of the error with its uncertainty", um(band.p95_um)});
  table.note = fmt::format(
      "Safe share of the compensation: {:.0f} %. With this fraction of each shift at most 5 % of the area is cut below "
      "the depth limit, at 95 % confidence in each point.",
      100 * band.safe_fraction);
  return table;
}

}  // namespace

std::vector<TextTable> compensation_tables(const compensate::CompensationResult& c) {
  std::vector<TextTable> tables{split_table(c), depth_table(c)};
  if (!c.verdict.limits.empty()) tables.push_back(limits_table(c.verdict.limits));
  if (c.uncertainty.band) tables.push_back(band_table(*c.uncertainty.band));
  return tables;
}

}  // namespace camber::report
