// The figures of a compensation, as JSON and for the terminal.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "base/json.h"
#include "base/units.h"
#include "report/figure_rows.h"
#include "report/figures_json.h"
#include "report/verdict_text.h"

namespace camber::report {
namespace {

Json split(const compensate::ErrorSplit& s) {
  return {{"correctable", s.correctable_um},
          {"correctable_p95", s.correctable_p95_um},
          {"correctable_max", s.correctable_max_um},
          {"guard", s.guard_um},
          {"bounded", s.bounded_um},
          {"limited", s.limited_um},
          {"not_correctable", s.not_correctable_um()},
          {"short_range", s.short_range_um},
          {"opposed", s.opposed_um},
          {"tip", s.tip_um},
          {"bow", s.bow_um},
          {"not_compensated", s.not_compensated_um}};
}

Json plain(const compensate::PlainFigures& p) {
  Json j = {{"error_um", figures_json(p.error_um)},
            {"deflection_um", figures_json(p.deflection_um)},
            {"contour_um", figures_json(p.contour_um)}};
  if (p.tool_um) j["tool_deflection_um"] = figures_json(*p.tool_um), j["part_deflection_um"] = figures_json(*p.part_um);
  if (p.total_um) j["total_error_um"] = figures_json(*p.total_um);
  j["in_band_share"] = p.in_band_fraction;
  return j;
}

Json causes(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const auto& cause : c.verdict.causes) {
    std::vector<std::size_t> given, emitted;
    for (const auto& line : cause.lines) given.push_back(line.given), emitted.push_back(line.emitted);
    out.push_back({{"rms_um", cause.rms_um},
                   {"lines", given},
                   {"emitted_lines", emitted},
                   {"remedies", cause.remedies},
                   {"sentence", compensate::sentence(cause)}});
  }
  return out;
}

Json limits(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const auto& limit : c.verdict.limits) {
    Json j = {{"key", limit.key},
              {"value", limit.value},
              {"given", limit.own},
              {"binds_no_more_at", limit.binds_no_more_at},
              {"count", limit.count},
              {"line", limit.line.given},
              {"emitted_line", limit.line.emitted},
              {"sentence", compensate::sentence(limit)}};
    if (const compensate::LimitEffect& effect = limit.effect; effect.known())
      j["effect"] = {{"p95_um", effect.with_um},
                     {"p95_without_um", effect.without_um},
                     {"first_line", effect.first_line},
                     {"last_line", effect.last_line}};
    out.push_back(std::move(j));
  }
  return out;
}

Json verdict(const VerdictText& v) {
  return {{"success", v.success}, {"headline", v.headline}, {"reasons", v.reasons}};
}

Json depth(const compensate::Depth& d) {
  Json j = {{"deepest_um", d.deepest_um},
            {"gouge_depth_p999_um", d.gouge_depth_p999_um},
            {"held_um", d.gouge_depth_p999_um},  // former name, for one more release
            {"at_mm", {d.place_mm.x(), d.place_mm.y(), d.place_mm.z()}},
            {"area_over_tolerance", d.over_fraction}};
  if (d.line.given > 0) j["line"] = d.line.given, j["emitted_line"] = d.line.emitted;
  return j;
}

/// Lists the levers that were not used, with the error that they are expected to leave and their time.
Json unused_levers(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const compensate::LeverOutlook& o : c.verdict.unused)
    out.push_back({{"lever", o.lever == machine::Lever::passes ? "passes" : "feed"},
                   {"p95_um", o.p95_um},
                   {"extra_time_s", o.extra_s}});
  return out;
}

/// Lists the levers that were used, with what they cost.
Json levers_used(const compensate::CompensationResult& c) {
  const compensate::Round& best = c.rounds[c.best];
  return {{"shift_max_um", 1000 * c.path.max_shift_mm},
          {"blocks_changed", c.emitted.blocks_changed},
          {"feed_changes", best.slowed},
          {"repeated_runs", best.repeated},
          {"extra_time_s", c.figures.feed_after.time_s - c.figures.feed_before.time_s}};
}

Json rounds(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const auto& r : c.rounds) {
    Json row = figures_json(r.error_um);
    row["split_um"] = split(r.split);
    row["largest_shift_um"] = 1000 * r.largest_shift_mm;
    row["limited_points"] = r.limited_points;
    row["gain"] = r.gain;
    row["step_share"] = r.step_fraction;
    row["overcorrected_area"] = r.overcorrected_fraction;
    row["deepest_um"] = r.deepest_um;
    row["guard"] = r.guard;
    row["combined"] = r.combined;
    row["machine_time_s"] = r.machine_time_s;
    row["feed_changes"] = r.slowed;
    row["repeated_runs"] = r.repeated;
    row["static_rounds"] = r.static_rounds;
    row["unsettled_stretches"] = r.unsettled;
    out.push_back(std::move(row));
  }
  return out;
}

Json time_points(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const auto& p : c.time_points) {
    const compensate::Round& r = c.rounds[p.round];
    out.push_back({{"allowed_percent", p.allowed_percent},
                   {"machine_time_s", r.machine_time_s},
                   {"p95_um", r.error_um.p95},
                   {"rms_um", r.error_um.rms},
                   {"feed_changes", r.slowed},
                   {"repeated_runs", r.repeated},
                   {"round", p.round}});
  }
  return out;
}

Json passes_json(const compensate::CompensationResult& c) {
  Json runs = Json::array(), cuts = Json::array();
  for (const auto& run : c.passes.runs) {
    runs.push_back({run.first_line, run.last_line});
    cuts.push_back(run.cuts);
  }
  return {{"runs", runs}, {"cuts", cuts}, {"allowance_um", 1000 * c.passes.allowance_mm}};
}

Json recheck(const compensate::Recheck& r) {
  return {{"voxel_mm", r.voxel_mm},
          {"before_um", figures_json(r.before_um)},
          {"after_um", figures_json(r.after_um)},
          {"split_before_um", split(r.split_before)},
          {"split_after_um", split(r.split_after)},
          {"deepest_um", r.deepest_um}};
}

Json band(const compensate::Band& b) {
  Json groups = Json::array();
  for (const auto& g : b.groups) groups.push_back({{"name", g.name}, {"rms_um", g.rms_um}});
  return {{"groups", groups},   {"sigma_rms_um", b.sigma_rms_um}, {"rms_um", b.rms_um},
          {"p95_um", b.p95_um}, {"deepest_um", b.deepest_um},     {"safe_share", b.safe_fraction}};
}

Json measured(const compensate::MeasuredFit& m) {
  return {{"deflection_scale", m.scale}, {"std_error", m.std_error},         {"points", m.points},
          {"left_out", m.left_out},      {"rms_before_um", m.rms_before_um}, {"rms_after_um", m.rms_after_um},
          {"predictions", m.predictions}};
}

Json operations(const compensate::CompensationResult& c) {
  Json out = Json::array();
  for (const auto& o : c.scope.finishing.operations)
    out.push_back({{"tool", o.tool},
                   {"lines", {o.first_line, o.last_line}},
                   {"surface_share", o.surface_fraction},
                   {"moves", o.moves},
                   {"compensated_moves", o.compensated_moves}});
  return out;
}

}  // namespace

std::string compensate_json(const compensate::CompensationResult& c, const machine::CompensationSettings& asked,
                            double compute_s) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  j["before_um"] = figures_json(c.figures.before_um);
  j["after_um"] = figures_json(c.figures.after_um);
  const bool machine = c.scope.reference == machine::Reference::machine;
  j["reference"] = machine ? "machine" : "commanded";
  j["judged"] = machine ? "deflection_um" : "error_um";
  j["before"] = plain(c.figures.plain_before);
  j["after"] = plain(c.figures.plain_after);
  j["within_tolerance"] = c.verdict.within_tolerance;
  j["better_than_given"] = c.verdict.better;
  j["achievable_um"] = {{"given_p95", c.figures.outlook.given_p95_um}, {"p95", c.figures.outlook.achievable_p95_um}};
  j["levers_used"] = levers_used(c);
  j["worse_than_given"] = {{"points", c.figures.worse.points},
                           {"area_share", c.figures.worse.area_fraction},
                           {"max_um", c.figures.worse.max_um}};
  j["depth_limit_um"] = c.safety.depth_limit_um;
  j["depth_limit_given"] = c.safety.own_depth_limit;
  j["unseen_mm2"] = c.figures.unseen_mm2;
  j["border_mm2"] = c.figures.border_mm2;
  j["not_judged_mm2"] = c.figures.not_judged_mm2;
  j["stage_between"] = c.figures.between;
  j["causes"] = causes(c);
  j["unused_levers"] = unused_levers(c);
  j["binding_limits"] = limits(c);
  j["verdict"] = verdict(verdict_text(c, asked));
  j["split_before_um"] = split(c.figures.split_before);
  j["split_after_um"] = split(c.figures.split_after);
  j["rounds"] = rounds(c);
  j["time_points"] = time_points(c);
  j["passes"] = passes_json(c);
  if (c.pass_before)
    j["pass_before"] = {{"given_um", 1000 * c.pass_before->given_mm}, {"left_um", 1000 * c.pass_before->left_mm}};
  j["best_round"] = c.best;
  j["stop"] = compensate::to_string(c.verdict.stop);
  j["into_part"] = {{"within_tolerance", c.safety.within_part},
                    {"before", depth(c.safety.before)},
                    {"after", depth(c.safety.after)},
                    {"not_compensated", depth(c.safety.others)},
                    {"without_bending", depth(c.safety.without_bending)}};
  j["path"] = {
      {"angle_growth_deg", deg_from_rad(c.path.quality.angle_growth_rad)},
      {"angle_growth_line", c.path.quality.angle_line},
      {"shortest_split_mm", c.path.quality.shortest_mm},
      {"too_short_splits", c.path.quality.too_short},
      {"row_turn_deg", deg_from_rad(c.path.row_turn_rad)},
      {"row_step_p95_um", 1000 * c.path.row_steps.p95_mm},
      {"row_step_max_um", 1000 * c.path.row_steps.max_mm},
      {"surface_step_um",
       {{"before",
         {{"p95", 1000 * c.path.surface_steps.before_p95_mm}, {"max", 1000 * c.path.surface_steps.before_max_mm}}},
        {"after",
         {{"p95", 1000 * c.path.surface_steps.after_p95_mm}, {"max", 1000 * c.path.surface_steps.after_max_mm}}},
        {"growth_deg", deg_from_rad(c.path.surface_steps.growth_rad)}}}};
  j["operations"] = operations(c);
  if (!c.uncertainty.rechecks.empty()) {
    j["check"] = recheck(c.uncertainty.rechecks.front());
    for (const auto& r : c.uncertainty.rechecks) j["checks"].push_back(recheck(r));
  }
  if (c.uncertainty.band) j["uncertainty"] = band(*c.uncertainty.band);
  if (c.uncertainty.measured) j["measured"] = measured(*c.uncertainty.measured);
  j["blocks"] = {
      {"before", c.emitted.blocks_before}, {"after", c.emitted.blocks_after}, {"changed", c.emitted.blocks_changed}};
  j["max_shift_um"] = 1000 * c.path.max_shift_mm;
  j["machine_time_s"] = {{"before", c.figures.feed_before.time_s}, {"after", c.figures.feed_after.time_s}};
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

std::string verify_json(const compensate::Verification& v, const machine::CompensationSettings& asked,
                        double compute_s) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  const bool machine = v.reference == machine::Reference::machine;
  j["reference"] = machine ? "machine" : "commanded";
  j["judged"] = machine ? "deflection_um" : "error_um";
  j["emitted"] = plain(v.plain);
  j["judged_um"] = figures_json(compensate::judged_of(v.plain, v.reference));
  j["recorded_um"] = {
      {"rms", v.recorded_um.rms}, {"p95", v.recorded_um.p95}, {"min", v.recorded_um.min}, {"max", v.recorded_um.max}};
  j["within_tolerance"] = v.within_tolerance;
  j["depth_limit_um"] = v.depth_limit_um;
  j["into_part"] = depth(v.depth);
  j["unseen_mm2"] = v.unseen_mm2;
  j["border_mm2"] = v.border_mm2;
  j["not_judged_mm2"] = v.not_judged_mm2;
  j["stage_between"] = v.between;
  j["verdict"] = verdict(verdict_text(v, asked));
  j["machine_time_s"] = v.machine_time_s;
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

namespace {

constexpr const char* kSplitHead = "error decomposition, um rms          before    after";

std::string split_text(const compensate::ErrorSplit& before, const compensate::ErrorSplit& after) {
  std::string out = fmt::format("{}\n", kSplitHead);
  const auto row = [&](const char* name, double b, double a) {
    if (b >= 0.005 || a >= 0.005) fmt::format_to(std::back_inserter(out), "{:<34}{:>9.2f}{:>9.2f}\n", name, b, a);
  };
  row("  a shift can correct", before.correctable_um, after.correctable_um);
  row("  given up to keep the depth limit", before.guard_um, after.guard_um);
  row("  given up to make no place worse", before.bounded_um, after.bounded_um);
  row("  limited by max_shift_mm", before.limited_um, after.limited_um);
  row("  no shift can correct", before.not_correctable_um(), after.not_correctable_um());
  row("    along the cutter: helix bow", before.bow_um, after.bow_um);
  row("    opposite surfaces", before.opposed_um, after.opposed_um);
  row("    near the axis of a round tip", before.tip_um, after.tip_um);
  row("    too short along the path", before.short_range_um, after.short_range_um);
  row("  moves that are not compensated", before.not_compensated_um, after.not_compensated_um);
  return out;
}

std::string rounds_text(const compensate::CompensationResult& c) {
  std::string out = fmt::format("{}\n", kFiguresHead);
  for (std::size_t i = 0; i < c.rounds.size(); ++i) {
    const auto& r = c.rounds[i];
    std::string note = i == c.best ? "  <" : "";
    if (r.guard) note += "  guard";
    if (r.combined) note += "  combined";
    if (r.step_fraction < 1) note += fmt::format("  step x {:.2g}", r.step_fraction);
    if (r.overcorrected_fraction >= 0.01) note += fmt::format("  {:.0f} % over", 100 * r.overcorrected_fraction);
    fmt::format_to(std::back_inserter(out), "{}{}\n",
                   figures_row(i == 0 ? "as given" : fmt::format("round {}", i), r.error_um), note);
  }
  return out;
}

/// "cut 3 times, the cuts before the last leaving 20 um: lines 8 to 8 of the given program"; empty where no run is cut
/// `cuts` times.
std::string passes_text(const compensate::CompensationResult& c, int cuts) {
  constexpr std::size_t kShown = 8;
  std::string out;
  std::size_t count = 0;
  for (const compensate::RepeatedRun& run : c.passes.runs) {
    if (run.cuts != cuts) continue;
    if (++count > kShown) continue;
    fmt::format_to(std::back_inserter(out), "{} {} to {}", count > 1 ? "," : "", run.first_line, run.last_line);
  }
  if (count == 0) return {};
  if (count > kShown) fmt::format_to(std::back_inserter(out), " and {} more runs", count - kShown);
  const double left_um = 1000 * c.passes.allowance_mm;
  const std::string head =
      cuts == 2 ? fmt::format("cut twice, the first cut leaving {:.0f} um: lines", left_um)
                : fmt::format("cut {} times, the cuts before the last leaving {:.0f} um: lines", cuts, left_um);
  return head + out + " of the given program\n";
}

/// Lines that are cut more than once; empty where none are.
std::string passes_text(const compensate::CompensationResult& c) {
  std::set<int> counts;
  for (const compensate::RepeatedRun& run : c.passes.runs) counts.insert(run.cuts);
  std::string out;
  for (const int cuts : counts) out += passes_text(c, cuts);
  return out;
}

/// "levers used: shift to 43.2 um (120 blocks), 14 feed changes; +2.1 s (+1.9 %)".
std::string levers_text(const compensate::CompensationResult& c) {
  const compensate::Round& best = c.rounds[c.best];
  std::string out =
      fmt::format("levers used: shift to {:.1f} um ({} blocks)", 1000 * c.path.max_shift_mm, c.emitted.blocks_changed);
  if (best.slowed > 0) out += fmt::format(", {} feed changes", best.slowed);
  if (best.repeated > 0 && best.repeated == c.passes.runs.size())
    out += fmt::format(", {} runs cut twice", best.repeated);
  else if (best.repeated > 0)
    out += fmt::format(", {} cuts more of {} runs", best.repeated, c.passes.runs.size());
  if (c.pass_before)
    out += fmt::format(", the passes before leave {:.0f} instead of {:.0f} um", 1000 * c.pass_before->left_mm,
                       1000 * c.pass_before->given_mm);
  const double extra_s = c.figures.feed_after.time_s - c.figures.feed_before.time_s;
  const double percent = c.figures.feed_before.time_s > 0 ? 100 * extra_s / c.figures.feed_before.time_s : 0;
  out += fmt::format("; {:+.1f} s ({:+.1f} %)\n", extra_s, percent);
  return c.scope.feed_unusable ? out + "lower feeds were not tried: no feed of these moves can be changed\n" : out;
}

/// Empty where no place is worse.
std::string worse_text(const compensate::WorsePlaces& worse) {
  if (worse.points == 0) return {};
  return fmt::format("worse than given and over the tolerance: {} points ({:.2g} % of the area), by up to {:.1f} um\n",
                     worse.points, 100 * worse.area_fraction, worse.max_um);
}

/// Machine time against error; empty where no lever takes time.
std::string time_points_text(const compensate::CompensationResult& c) {
  if (c.time_points.empty()) return {};
  std::string out = "extra time allowed    machine time, s        p95, um   rms, um   changes of feed   cut twice\n";
  for (const auto& p : c.time_points) {
    const compensate::Round& r = c.rounds[p.round];
    const double extra =
        c.figures.feed_before.time_s > 0 ? 100 * (r.machine_time_s / c.figures.feed_before.time_s - 1) : 0;
    fmt::format_to(std::back_inserter(out), "{:>16.4g} %  {:>10.1f} ({:+6.1f} %) {:>9.2f} {:>9.2f} {:>17} {:>11}{}\n",
                   p.allowed_percent, r.machine_time_s, extra, r.error_um.p95, r.error_um.rms, r.slowed, r.repeated,
                   p.round == c.best ? "  <" : "");
  }
  return out;
}

std::string safety_text(const compensate::CompensationResult& c) {
  std::string out =
      fmt::format("gouge depth: {:.2f} um before, {:.2f} um after (single points {:.2f} um);\n  limit {:.4g} um{}",
                  c.safety.before.gouge_depth_p999_um, c.safety.after.gouge_depth_p999_um, c.safety.after.deepest_um,
                  c.safety.depth_limit_um, c.safety.own_depth_limit ? "" : " (default)");
  if (c.safety.others.deepest_um > 0) out += fmt::format("\n  by other moves: {:.2f} um", c.safety.others.deepest_um);
  return out + fmt::format("\nwith a rigid tool: {:.2f} um\n", c.safety.without_bending.deepest_um);
}

std::string path_text(const compensate::CompensationResult& c) {
  std::string out = fmt::format("angles between blocks grow by {:.2f} degrees at most",
                                deg_from_rad(c.path.quality.angle_growth_rad));
  if (c.path.row_steps.pairs > 0) out += fmt::format("; row to row {:.1f} um (95 %)", 1000 * c.path.row_steps.p95_mm);
  if (c.path.row_turn_rad > 0)
    out +=
        fmt::format("\nfrom row to row the shifts turn by {:.2f} degrees at most", deg_from_rad(c.path.row_turn_rad));
  if (c.path.surface_steps.pairs > 0)
    out += fmt::format("\nthe surface steps from row to row by {:.2f} um, before by {:.2f} um (95 %)",
                       1000 * c.path.surface_steps.after_p95_mm, 1000 * c.path.surface_steps.before_p95_mm);
  if (c.path.quality.shortest_mm > 0)
    out += fmt::format("\nshortest block of a split: {:.3f} mm", c.path.quality.shortest_mm);
  return out + "\n";
}

std::string checks_text(const compensate::CompensationResult& c) {
  std::string out;
  const auto add = [&](fmt::string_view format, auto... a) {
    fmt::vformat_to(std::back_inserter(out), format, fmt::make_format_args(a...));
  };
  if (c.uncertainty.measured)
    add("measured: the deflection is {:.3f} +- {:.3f} times the predicted one ({} points)\n",
        c.uncertainty.measured->scale, c.uncertainty.measured->std_error, c.uncertainty.measured->points);
  for (const auto& r : c.uncertainty.rechecks)
    add("on voxels of {:g} mm: rms {:.2f} um before, {:.2f} after;\n"
        "  correctable by a shift: {:.2f} before, {:.2f} after\n",
        r.voxel_mm, r.before_um.rms, r.after_um.rms, r.split_before.correctable_um, r.split_after.correctable_um);
  if (!c.uncertainty.band) return out;
  add("with the model uncertainty: rms {:.2f} um, 95 % within {:.2f} um\n", c.uncertainty.band->rms_um,
      c.uncertainty.band->p95_um);
  for (const auto& g : c.uncertainty.band->groups)
    add("  {:<12}{:>8.2f} um rms for one standard error\n", g.name, g.rms_um);
  add("safe share of the compensation: {:.0f} %\n"
      "  with this fraction of each shift at most 5 % of the area is cut below the depth\n"
      "  limit, at 95 % confidence in each point\n",
      100 * c.uncertainty.band->safe_fraction);
  return out;
}

/// "compensated", "compensated in 3 of 4 moves", "simulated only".
std::string compensated_of(const compensate::Operation& o) {
  if (o.compensated_moves == 0) return "simulated only";
  if (o.compensated_moves == o.moves) return "compensated";
  return fmt::format("compensated in {} of {} moves", o.compensated_moves, o.moves);
}

const char* reason(compensate::Stop stop) {
  switch (stop) {
    case compensate::Stop::tolerance:
      return "the emitted program is within the tolerance";
    case compensate::Stop::depth_limit:
      return "the depth limit keeps the error over the tolerance";
    case compensate::Stop::stalled:
      return "a shift can lower the error no further";
    case compensate::Stop::rounds:
      break;
  }
  return "the largest number of rounds was reached";
}

}  // namespace

std::string compensate_text(const compensate::CompensationResult& c, double compute_s) {
  std::string out = levers_text(c) + rounds_text(c) + time_points_text(c) + passes_text(c);
  fmt::format_to(std::back_inserter(out), "stopped: {}\n", reason(c.verdict.stop));
  out += worse_text(c.figures.worse) + plain_figures_text(c) +
         split_text(c.figures.split_before, c.figures.split_after) + safety_text(c) + path_text(c) + checks_text(c);
  const auto& operations = c.scope.finishing.operations;
  for (const auto& o : operations)
    if (operations.size() > 1 || o.compensated_moves < o.moves)
      fmt::format_to(std::back_inserter(out), "T{}, lines {} to {}: {}, {:.0f} % of the surface\n", o.tool,
                     o.first_line, o.last_line, compensated_of(o), 100 * o.surface_fraction);
  fmt::format_to(std::back_inserter(out),
                 "largest shift {:.1f} um; {} of {} blocks changed, {} blocks after\n"
                 "machine time {:.1f} s before, {:.1f} s after; computed in {:.1f} s\n",
                 1000 * c.path.max_shift_mm, c.emitted.blocks_changed, c.emitted.blocks_before, c.emitted.blocks_after,
                 c.figures.feed_before.time_s, c.figures.feed_after.time_s, compute_s);
  for (const auto& limit : c.verdict.limits) out += compensate::sentence(limit) + "\n";
  return out;
}

}  // namespace camber::report
