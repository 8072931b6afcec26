#include "report/summary.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "base/units.h"
#include "simulate/verdict.h"

namespace camber::report {
namespace {

using nlohmann::ordered_json;

ordered_json figures(const removal::ErrorFigures& f) {
  return {{"min", f.min}, {"max", f.max}, {"mean", f.mean}, {"rms", f.rms}, {"p95", f.p95}, {"area_mm2", f.area_mm2}};
}

std::string figures_row(const std::string& name, const removal::ErrorFigures& f) {
  return fmt::format("{:<12}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}", name, f.p95, f.rms, f.mean, f.min, f.max);
}
constexpr const char* kFiguresHead = "form error, um     p95      rms     mean      min      max";

/// Area-weighted figures of |total error| against the mesh.
removal::ErrorFigures total_error(const simulate::Prediction& p) {
  std::vector<double> um, area;
  for (std::size_t i = 0; i < p.total_error_mm.size(); ++i) {
    um.push_back(1000 * p.total_error_mm[i]);
    area.push_back(p.surface[i].area_mm2);
  }
  return removal::error_figures(um, area);
}

/// Percentiles of the signed error and its histogram, by area.
ordered_json spread(const removal::ErrorSpread& s) {
  ordered_json percentiles = ordered_json::object();
  for (std::size_t i = 0; i < s.kShares.size(); ++i)
    percentiles[fmt::format("p{:02.0f}", 100 * s.kShares[i])] = s.percentile[i];
  return {{"percentiles", percentiles},
          {"histogram", {{"from", s.bin_from}, {"width", s.bin_width}, {"area_mm2", s.bin_area_mm2}}}};
}

ordered_json form_error(const simulate::Prediction& p) {
  ordered_json j = figures(p.form_error_um);
  std::vector<double> um, area;
  for (const auto& point : p.surface) {
    um.push_back(1000 * point.error_mm);
    area.push_back(point.area_mm2);
  }
  j.update(spread(removal::error_spread(um, area)));
  return j;
}

double largest_force_N(const simulate::Prediction& p) {
  double largest = 0;
  for (const auto& l : p.cut.loads) largest = std::max(largest, l.lateral_max_N);
  return largest;
}

/// Figures of the spindle and the chips over all tooth passings.
struct SpindleFigures {
  double torque_max_Nm = 0, power_max_W = 0, power_mean_W = 0, chip_max_mm = 0, specific_energy_MPa = 0;
};

/// The mean power is over the time in the cut; the specific energy is all work over all chips.
SpindleFigures spindle_figures(const simulate::SimulatedProgram& program, const simulate::Prediction& p) {
  SpindleFigures out;
  double work_Nmm = 0, volume_mm3 = 0, time_s = 0;
  for (std::size_t k = 0; k < p.cut.loads.size(); ++k) {
    const auto& l = p.cut.loads[k];
    if (l.chip_mm3 <= 0 || l.torque_mean_Nmm <= 0) continue;
    const double rpm = program.moves.state_of(program.moves.moves[program.path.stamps[k].move]).spindle_speed_rpm;
    const double power_W = simulate::power_W(l.torque_mean_Nmm, rpm);
    out.torque_max_Nm = std::max(out.torque_max_Nm, l.torque_max_Nmm / 1000);
    out.power_max_W = std::max(out.power_max_W, power_W);
    out.chip_max_mm = std::max(out.chip_max_mm, l.chip_max_mm);
    work_Nmm += l.work_Nmm;
    volume_mm3 += l.chip_mm3;
    time_s += l.work_Nmm / 1000 / power_W;
  }
  if (time_s > 0) out.power_mean_W = work_Nmm / 1000 / time_s;
  if (volume_mm3 > 0) out.specific_energy_MPa = work_Nmm / volume_mm3;
  return out;
}

ordered_json holes(const simulate::HoleFigures& h) {
  return {{"drilled", h.count.drilled},
          {"tapped", h.count.tapped},
          {"drilled_mm3", h.drilled_mm3},
          {"tapped_mm3", h.tapped_mm3},
          {"thrust_N", {{"max", h.thrust_max_N}}},
          {"torque_Nm", {{"max", h.torque_max_Nmm / 1000}}},
          {"not_judged_mm2", h.surface_mm2}};
}

std::string holes_text(const simulate::HoleFigures& h) {
  std::string out;
  if (h.count.drilled > 0)
    fmt::format_to(std::back_inserter(out),
                   "{} holes drilled: {:.3f} mm3, thrust {:.1f} N without the chisel edge, torque {:.3f} Nm\n",
                   h.count.drilled, h.drilled_mm3, h.thrust_max_N, h.torque_max_Nmm / 1000);
  if (h.count.tapped > 0)
    fmt::format_to(std::back_inserter(out), "{} holes tapped: {:.3f} mm3, carved without chips or forces\n",
                   h.count.tapped, h.tapped_mm3);
  fmt::format_to(std::back_inserter(out), "surface that holes made, not in the form error: {:.1f} mm2\n",
                 h.surface_mm2);
  return out;
}

}  // namespace

namespace {

using Reason = deflection::NoEquilibrium;

/// What keeps the tool from an equilibrium, before the lines in which it does.
const char* condition(Reason reason) {
  switch (reason) {
    case Reason::pulled_in:
      return "the tool is pulled into its cut (the force grows faster with the chip than the tool is stiff) in";
    case Reason::pushed_out:
      return "the tool is pushed out of its cut by more than 0.5 mm in";
    case Reason::swings:
      break;
  }
  return "the tool swings between two deflections in";
}

const char* name(Reason reason) {
  return reason == Reason::pulled_in ? "pulled in" : reason == Reason::pushed_out ? "pushed out" : "swings";
}

std::string named(const std::vector<std::size_t>& lines) {
  constexpr std::size_t kNamed = 5;
  return fmt::format("line{} {}{}", lines.size() > 1 ? "s" : "",
                     fmt::join(std::span(lines).first(std::min(lines.size(), kNamed)), ", "),
                     lines.size() > kNamed ? fmt::format(" and {} more", lines.size() - kNamed) : "");
}

/// Each once, in order; of one reason or all.
std::vector<std::size_t> unsettled_lines(const simulate::SimulatedProgram& program, const simulate::Prediction& p,
                                         std::optional<Reason> reason = {}) {
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < p.cut.unsettled_moves.size(); ++i)
    if (!reason || p.cut.unsettled_reasons[i] == *reason)
      lines.push_back(program.moves.moves[p.cut.unsettled_moves[i]].block + 1);
  std::ranges::sort(lines);
  const auto again = std::ranges::unique(lines);
  lines.erase(again.begin(), again.end());
  return lines;
}

}  // namespace

namespace {

/// Why there are no figures; those that there would be are null.
void leave_out_figures(const simulate::SimulatedProgram& program, const simulate::Prediction& p, ordered_json& j) {
  j["force_N"]["max"] = nullptr;
  j["torque_Nm"]["max"] = nullptr;
  j["power_W"] = {{"max", nullptr}, {"mean", nullptr}};
  j["chip_thickness_mm"]["max"] = nullptr;
  j["specific_energy_MPa"] = nullptr;
  for (const char* group : {"form_error_um", "total_error_um"})
    if (j.contains(group))
      j[group] = {{"min", nullptr}, {"max", nullptr}, {"mean", nullptr}, {"rms", nullptr}, {"p95", nullptr}};
  j["beyond_model"] = {
      {"slender_tools", p.slender_tools},
      {"tooth_passings", p.cut.beyond},
      {"lines", simulate::lines_beyond_model(program, p)},
      {"deflection_um", {{"max", 1000 * p.cut.deflection_max_mm}, {"limit", 1000 * p.cut.deflection_limit_mm}}}};
}

}  // namespace

std::string predict_json(const simulate::SimulatedProgram& program, const simulate::Prediction& p, double compute_s) {
  ordered_json j;
  j["machine_time_s"] = program.feed.time_s;
  j["cutting_time_s"] = program.feed.cutting_time_s;
  j["compute_s"] = compute_s;
  j["stamps"] = program.path.stamps.size();
  j["force_N"] = {{"max", largest_force_N(p)}};
  const SpindleFigures s = spindle_figures(program, p);
  j["torque_Nm"] = {{"max", s.torque_max_Nm}};
  j["power_W"] = {{"max", s.power_max_W}, {"mean", s.power_mean_W}};
  j["chip_thickness_mm"] = {{"max", s.chip_max_mm}};
  j["specific_energy_MPa"] = s.specific_energy_MPa;
  j["removed_mm3"] = {{"path", p.cut.chip_mm3}, {"stock", p.cut.stock_mm3}};
  if (p.holes.any()) j["holes"] = holes(p.holes);
  j["form_error_um"] = form_error(p);
  if (!p.total_error_mm.empty()) j["total_error_um"] = figures(total_error(p));
  j["static"] = {{"rounds_max", p.cut.rounds_max},
                 {"unsettled_stretches", p.cut.unsettled},
                 {"unsettled_lines", unsettled_lines(program, p)}};
  for (const Reason reason : {Reason::pulled_in, Reason::pushed_out, Reason::swings})
    if (const auto lines = unsettled_lines(program, p, reason); !lines.empty())
      j["static"]["unsettled_reasons"].push_back({{"reason", name(reason)}, {"lines", lines}});
  if (simulate::beyond_model(p)) leave_out_figures(program, p, j);
  return j.dump(2) + "\n";
}

namespace {

ordered_json split(const compensate::ErrorSplit& s) {
  return {{"correctable", s.correctable_um},
          {"correctable_p95", s.correctable_p95_um},
          {"correctable_max", s.correctable_max_um},
          {"guard", s.guard_um},
          {"limited", s.limited_um},
          {"not_correctable", s.not_correctable_um()},
          {"short_range", s.short_range_um},
          {"opposed", s.opposed_um},
          {"tip", s.tip_um},
          {"bow", s.bow_um},
          {"not_compensated", s.not_compensated_um}};
}

ordered_json depth(const compensate::Depth& d) {
  return {{"deepest_um", d.deepest_um},
          {"held_um", d.held_um},
          {"at_mm", {d.place_mm.x(), d.place_mm.y(), d.place_mm.z()}},
          {"area_over_tolerance", d.over_fraction}};
}

ordered_json rounds(const compensate::CompensationResult& c) {
  ordered_json out = ordered_json::array();
  for (const auto& r : c.rounds) {
    ordered_json row = figures(r.error_um);
    row["split_um"] = split(r.split);
    row["largest_shift_um"] = 1000 * r.largest_shift_mm;
    row["limited_points"] = r.limited_points;
    row["gain"] = r.gain;
    row["step_share"] = r.step_fraction;
    row["overcorrected_area"] = r.overcorrected_fraction;
    row["deepest_um"] = r.deepest_um;
    row["guard"] = r.guard;
    row["static_rounds"] = r.static_rounds;
    row["unsettled_stretches"] = r.unsettled;
    out.push_back(std::move(row));
  }
  return out;
}

ordered_json recheck(const compensate::Recheck& r) {
  return {{"voxel_mm", r.voxel_mm},
          {"before_um", figures(r.before_um)},
          {"after_um", figures(r.after_um)},
          {"split_before_um", split(r.split_before)},
          {"split_after_um", split(r.split_after)},
          {"deepest_um", r.deepest_um}};
}

ordered_json band(const compensate::Band& b) {
  ordered_json groups = ordered_json::array();
  for (const auto& g : b.groups) groups.push_back({{"name", g.name}, {"rms_um", g.rms_um}});
  return {{"groups", groups},   {"sigma_rms_um", b.sigma_rms_um}, {"rms_um", b.rms_um},
          {"p95_um", b.p95_um}, {"deepest_um", b.deepest_um},     {"safe_share", b.safe_fraction}};
}

ordered_json measured(const compensate::MeasuredFit& m) {
  return {{"deflection_scale", m.scale}, {"std_error", m.std_error},         {"points", m.points},
          {"left_out", m.left_out},      {"rms_before_um", m.rms_before_um}, {"rms_after_um", m.rms_after_um},
          {"predictions", m.predictions}};
}

ordered_json operations(const compensate::CompensationResult& c) {
  ordered_json out = ordered_json::array();
  for (const auto& o : c.finishing.operations)
    out.push_back({{"tool", o.tool},
                   {"lines", {o.first_line, o.last_line}},
                   {"surface_share", o.surface_fraction},
                   {"moves", o.moves},
                   {"compensated_moves", o.compensated_moves}});
  return out;
}

}  // namespace

std::string compensate_json(const compensate::CompensationResult& c, double compute_s) {
  ordered_json j;
  j["before_um"] = figures(c.before_um);
  j["after_um"] = figures(c.after_um);
  j["split_before_um"] = split(c.split_before);
  j["split_after_um"] = split(c.split_after);
  j["rounds"] = rounds(c);
  j["best_round"] = c.best;
  j["stop"] = compensate::to_string(c.stop);
  j["into_part"] = {{"within_tolerance", c.within_part},
                    {"before", depth(c.depth_before)},
                    {"after", depth(c.depth_after)},
                    {"not_compensated", depth(c.depth_others)},
                    {"without_bending", depth(c.depth_without_bending)}};
  j["path"] = {
      {"angle_growth_deg", deg_from_rad(c.quality.angle_growth_rad)},
      {"angle_growth_line", c.quality.angle_line},
      {"shortest_split_mm", c.quality.shortest_mm},
      {"too_short_splits", c.quality.too_short},
      {"row_turn_deg", deg_from_rad(c.row_turn_rad)},
      {"row_step_p95_um", 1000 * c.row_steps.p95_mm},
      {"row_step_max_um", 1000 * c.row_steps.max_mm},
      {"surface_step_um",
       {{"before", {{"p95", 1000 * c.surface_steps.before_p95_mm}, {"max", 1000 * c.surface_steps.before_max_mm}}},
        {"after", {{"p95", 1000 * c.surface_steps.after_p95_mm}, {"max", 1000 * c.surface_steps.after_max_mm}}},
        {"growth_deg", deg_from_rad(c.surface_steps.growth_rad)}}}};
  j["operations"] = operations(c);
  if (!c.rechecks.empty()) {
    j["check"] = recheck(c.rechecks.front());
    for (const auto& r : c.rechecks) j["checks"].push_back(recheck(r));
  }
  if (c.band) j["uncertainty"] = band(*c.band);
  if (c.measured) j["measured"] = measured(*c.measured);
  j["blocks"] = {{"before", c.blocks_before}, {"after", c.blocks_after}, {"changed", c.blocks_changed}};
  j["max_shift_um"] = 1000 * c.max_shift_mm;
  j["machine_time_s"] = {{"before", c.feed_before.time_s}, {"after", c.feed_after.time_s}};
  j["compute_s"] = compute_s;
  return j.dump(2) + "\n";
}

std::string predict_text(const simulate::SimulatedProgram& program, const simulate::Prediction& p, double compute_s) {
  std::string out = fmt::format("machine time {:.1f} s, of it cutting {:.1f} s; computed in {:.1f} s\n",
                                program.feed.time_s, program.feed.cutting_time_s, compute_s);
  const SpindleFigures s = spindle_figures(program, p);
  const double balance = p.cut.stock_mm3 > 0 ? 100 * (p.cut.chip_mm3 / p.cut.stock_mm3 - 1) : 0;
  fmt::format_to(std::back_inserter(out), "removed {:.3f} mm3 by the chips, {:.3f} mm3 by the stock ({:+.2f} %)\n",
                 p.cut.chip_mm3, p.cut.stock_mm3, balance);
  if (simulate::beyond_model(p)) return out + "force, deflection and form error: beyond the model's range\n";
  fmt::format_to(std::back_inserter(out), "greatest lateral force {:.1f} N, torque {:.3f} Nm, chip {:.4f} mm\n",
                 largest_force_N(p), s.torque_max_Nm, s.chip_max_mm);
  fmt::format_to(std::back_inserter(out), "power {:.1f} W at most, {:.1f} W in the cut; {:.0f} J/cm3\n", s.power_max_W,
                 s.power_mean_W, s.specific_energy_MPa);
  if (p.holes.any()) out += holes_text(p.holes);
  fmt::format_to(std::back_inserter(out), "{}\n{}\n", kFiguresHead, figures_row("error", p.form_error_um));
  if (!p.total_error_mm.empty())
    fmt::format_to(std::back_inserter(out), "{}\n", figures_row("against part", total_error(p)));
  return out;
}

namespace {

constexpr const char* kSplitHead = "form error apart, um rms             before    after";

std::string split_text(const compensate::ErrorSplit& before, const compensate::ErrorSplit& after) {
  std::string out = fmt::format("{}\n", kSplitHead);
  const auto row = [&](const char* name, double b, double a) {
    if (b >= 0.005 || a >= 0.005) fmt::format_to(std::back_inserter(out), "{:<34}{:>9.2f}{:>9.2f}\n", name, b, a);
  };
  row("  a shift can correct", before.correctable_um, after.correctable_um);
  row("  left so as not to cut too deep", before.guard_um, after.guard_um);
  row("  held back by max_shift_mm", before.limited_um, after.limited_um);
  row("  no shift can correct", before.not_correctable_um(), after.not_correctable_um());
  row("    along the cutter: helix bow", before.bow_um, after.bow_um);
  row("    surfaces that face each other", before.opposed_um, after.opposed_um);
  row("    about a round tip's axis", before.tip_um, after.tip_um);
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
    if (r.step_fraction < 1) note += fmt::format("  step x {:.2g}", r.step_fraction);
    if (r.overcorrected_fraction >= 0.01) note += fmt::format("  {:.0f} % over", 100 * r.overcorrected_fraction);
    fmt::format_to(std::back_inserter(out), "{}{}\n",
                   figures_row(i == 0 ? "as given" : fmt::format("round {}", i), r.error_um), note);
  }
  return out;
}

std::string safety_text(const compensate::CompensationResult& c) {
  std::string out = fmt::format("into the part: {:.2f} um before, {:.2f} um after (single points {:.2f} um)",
                                c.depth_before.held_um, c.depth_after.held_um, c.depth_after.deepest_um);
  if (c.depth_others.deepest_um > 0) out += fmt::format("\n  by other moves: {:.2f} um", c.depth_others.deepest_um);
  return out + fmt::format("\nif the tool did not bend at all: {:.2f} um into the part\n",
                           c.depth_without_bending.deepest_um);
}

std::string path_text(const compensate::CompensationResult& c) {
  std::string out =
      fmt::format("angles between blocks grow by {:.2f} degrees at most", deg_from_rad(c.quality.angle_growth_rad));
  if (c.row_steps.pairs > 0) out += fmt::format("; row to row {:.1f} um (95 %)", 1000 * c.row_steps.p95_mm);
  if (c.row_turn_rad > 0)
    out += fmt::format("\nfrom row to row the shifts turn by {:.2f} degrees at most", deg_from_rad(c.row_turn_rad));
  if (c.surface_steps.pairs > 0)
    out += fmt::format("\nthe surface steps from row to row by {:.2f} um, before by {:.2f} um (95 %)",
                       1000 * c.surface_steps.after_p95_mm, 1000 * c.surface_steps.before_p95_mm);
  if (c.quality.shortest_mm > 0) out += fmt::format("\nshortest block of a split: {:.3f} mm", c.quality.shortest_mm);
  return out + "\n";
}

std::string checks_text(const compensate::CompensationResult& c) {
  std::string out;
  const auto add = [&](fmt::string_view format, auto... a) {
    fmt::vformat_to(std::back_inserter(out), format, fmt::make_format_args(a...));
  };
  if (c.measured)
    add("measured: the deflection is {:.3f} +- {:.3f} of the model's ({} points)\n", c.measured->scale,
        c.measured->std_error, c.measured->points);
  for (const auto& r : c.rechecks)
    add("on voxels of {:g} mm: rms {:.2f} um before, {:.2f} after; of what a shift can\ncorrect {:.2f} before, {:.2f} "
        "after\n",
        r.voxel_mm, r.before_um.rms, r.after_um.rms, r.split_before.correctable_um, r.split_after.correctable_um);
  if (!c.band) return out;
  add("with the model's uncertainty: rms {:.2f} um, 95 % within {:.2f} um\n", c.band->rms_um, c.band->p95_um);
  for (const auto& g : c.band->groups) add("  {:<12}{:>8.2f} um rms for one standard error\n", g.name, g.rms_um);
  add("safe share of the compensation: {:.0f} %\n", 100 * c.band->safe_fraction);
  return out;
}

/// "compensated", "compensated in 3 of 4 moves", "simulated only".
std::string compensated_of(const compensate::Operation& o) {
  if (o.compensated_moves == 0) return "simulated only";
  if (o.compensated_moves == o.moves) return "compensated";
  return fmt::format("compensated in {} of {} moves", o.compensated_moves, o.moves);
}

}  // namespace

std::string compensate_text(const compensate::CompensationResult& c, double compute_s) {
  std::string out = rounds_text(c);
  const char* why = c.stop == compensate::Stop::tolerance
                        ? "the 95th percentile of what a shift can correct is within the tolerance"
                    : c.stop == compensate::Stop::stalled ? "the error no longer falls"
                                                          : "the largest number of rounds was reached";
  fmt::format_to(std::back_inserter(out), "stopped: {}\n", why);
  out += split_text(c.split_before, c.split_after) + safety_text(c) + path_text(c) + checks_text(c);
  const auto& operations = c.finishing.operations;
  for (const auto& o : operations)
    if (operations.size() > 1 || o.compensated_moves < o.moves)
      fmt::format_to(std::back_inserter(out), "T{}, lines {} to {}: {}, {:.0f} % of the surface\n", o.tool,
                     o.first_line, o.last_line, compensated_of(o), 100 * o.surface_fraction);
  fmt::format_to(std::back_inserter(out),
                 "largest shift {:.1f} um; {} of {} blocks changed, {} blocks after\n"
                 "machine time {:.1f} s before, {:.1f} s after; computed in {:.1f} s\n",
                 1000 * c.max_shift_mm, c.blocks_changed, c.blocks_before, c.blocks_after, c.feed_before.time_s,
                 c.feed_after.time_s, compute_s);
  const std::size_t limited = c.rounds[c.best].limited_points;
  if (limited > 0) fmt::format_to(std::back_inserter(out), "{} points of the path reached max_shift_mm\n", limited);
  return out;
}

std::string unsettled_sentence(const simulate::SimulatedProgram& program, const simulate::Prediction& p) {
  if (p.cut.unsettled == 0) return {};
  std::string why;
  for (const auto reason : {Reason::pulled_in, Reason::pushed_out, Reason::swings}) {
    const std::vector<std::size_t> lines = unsettled_lines(program, p, reason);
    if (!lines.empty()) why += fmt::format("{}{} {}", why.empty() ? "" : "; ", condition(reason), named(lines));
  }
  return fmt::format(
      "the static deflection did not converge in {} stretch{} of the path: {}; figures from there on are uncertain",
      p.cut.unsettled, p.cut.unsettled > 1 ? "es" : "", why);
}

std::string unsettled_sentence(const compensate::CompensationResult& c) {
  if (c.settled) return {};
  return "the static deflection of some stretches did not settle; their figures are uncertain";
}

std::string left_over_sentence(const compensate::ErrorSplit& left, const machine::CompensationSettings& asked) {
  std::string out = fmt::format("of what a shift can correct {:.2f} um (95th percentile) are left; tolerance_um = {:g}",
                                left.correctable_p95_um, asked.tolerance_um);
  // What keeps it from the tolerance is often the part, not the path.
  if (left.guard_um > left.correctable_um)
    out += fmt::format(", most of it left so as to cut no more than {:g} um into the part", asked.overcut_um());
  return out;
}

}  // namespace camber::report
