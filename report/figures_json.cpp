#include "report/figures_json.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/units.h"
#include "report/chatter_page.h"
#include "report/figure_rows.h"
#include "simulate/validity.h"
#include "simulate/verdict.h"

namespace camber::report {
namespace {

/// Area-weighted figures of |total error| against the mesh.
removal::ErrorFigures total_error(const simulate::Prediction& p) {
  std::vector<double> um, area;
  for (std::size_t i = 0; i < p.total_error_mm.size(); ++i) {
    if (!p.surface[i].valid) continue;
    um.push_back(1000 * p.total_error_mm[i]);
    area.push_back(p.surface[i].area_mm2);
  }
  return removal::error_figures(um, area);
}

/// Percentiles of the signed error and its histogram, by area.
Json spread(const removal::ErrorSpread& s) {
  Json percentiles = Json::object();
  for (std::size_t i = 0; i < s.kFractions.size(); ++i)
    percentiles[fmt::format("p{:02.0f}", 100 * s.kFractions[i])] = s.percentile[i];
  return {{"percentiles", percentiles},
          {"histogram", {{"from", s.bin_from}, {"width", s.bin_width}, {"area_mm2", s.bin_area_mm2}}}};
}

Json form_error(const simulate::Prediction& p) {
  Json j = figures_json(p.form_error_um);
  std::vector<double> um, area;
  for (const auto& point : p.surface) {
    if (!point.valid) continue;
    um.push_back(1000 * point.error_mm);
    area.push_back(point.area_mm2);
  }
  j.update(spread(removal::error_spread(um, area)));
  return j;
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
    if (l.chip_mm3 <= 0 || l.torque_mean_Nmm <= 0 || !p.validity.valid(k)) continue;
    const double rpm =
        program.moves_in_part().state_of(program.moves_in_part().moves[program.path.stamps[k].move]).spindle_speed_rpm;
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

Json holes(const simulate::HoleFigures& h) {
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
  fmt::format_to(std::back_inserter(out), "hole surfaces, not in the form error: {:.1f} mm2\n", h.surface_mm2);
  return out;
}

}  // namespace

double chips_mm3(const simulate::Prediction& p) {
  if (p.validity.all()) return p.cut.chip_mm3;
  double sum = 0;
  for (std::size_t k = 0; k < p.cut.loads.size(); ++k)
    if (p.validity.valid(k)) sum += p.cut.loads[k].chip_mm3;
  return sum;
}

double largest_force_N(const simulate::Prediction& p) {
  double largest = 0;
  for (std::size_t k = 0; k < p.cut.loads.size(); ++k)
    if (p.validity.valid(k)) largest = std::max(largest, p.cut.loads[k].lateral_max_N);
  return largest;
}

namespace {

using Reason = deflection::NoEquilibrium;

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
      lines.push_back(program.moves_in_part().moves[p.cut.unsettled_moves[i]].block + 1);
  std::ranges::sort(lines);
  const auto again = std::ranges::unique(lines);
  lines.erase(again.begin(), again.end());
  return lines;
}

void add_workpiece(const simulate::Prediction::DeflectionFigures& d, Json& j) {
  j["tool_deflection_um"] = figures_json(d.tool_um);
  j["part_deflection_um"] = figures_json(d.part_um);
  j["workpiece"] = {{"cell_mm", d.survey->cell_mm},
                    {"cells", d.survey->cells},
                    {"places", d.survey->solved},
                    {"compliance_max_um_per_N", d.survey->compliance_max_um_per_N},
                    {"compute_s", d.survey->seconds}};
}

std::string workpiece_text(const simulate::PartSurvey& s) {
  return fmt::format("workpiece: up to {:.3f} um/N under the tool; {} places, {} cells of {:.2f} mm, {:.1f} s\n",
                     s.compliance_max_um_per_N, s.solved, s.cells, s.cell_mm, s.seconds);
}

/// Rows of what the deflection is made of, each after a line end.
std::string deflection_parts_text(const simulate::Prediction& p) {
  if (!p.deflection_parts_um) return {};
  return "\n" + figures_row("  tool", p.deflection_parts_um->tool_um) + "\n" +
         figures_row("  workpiece", p.deflection_parts_um->part_um);
}

/// Adds what the model does not cover, and makes figures null of which it covers less than half.
void add_beyond_model(const simulate::SimulatedProgram& program, const simulate::Prediction& p, Json& j) {
  const simulate::Validity& v = p.validity;
  if (v.all()) return;
  if (simulate::forces_beyond_model(p)) {
    j["removed_mm3"]["path"] = nullptr;
    j["force_N"]["max"] = nullptr;
    j["torque_Nm"]["max"] = nullptr;
    j["power_W"] = {{"max", nullptr}, {"mean", nullptr}};
    j["chip_thickness_mm"]["max"] = nullptr;
    j["specific_energy_MPa"] = nullptr;
  }
  if (simulate::beyond_model(p))
    for (const char* group : {"form_error_um", "deflection_um", "total_error_um"})
      if (j.contains(group))
        j[group] = {{"min", nullptr}, {"max", nullptr}, {"mean", nullptr}, {"rms", nullptr}, {"p95", nullptr}};
  std::vector<std::uint32_t> stamps = p.cut.beyond_stamps;
  stamps.insert(stamps.end(), p.cut.unsettled_stamps.begin(), p.cut.unsettled_stamps.end());
  stamps.insert(stamps.end(), p.chatter.invalid_stamps.begin(), p.chatter.invalid_stamps.end());
  j["beyond_model"] = {{"share", v.surface_fraction()},
                       {"share_of_passings", v.passing_fraction()},
                       {"area_mm2", v.invalid_mm2},
                       {"tooth_passings", p.cut.beyond_stamps.size()},
                       {"lines", simulate::lines_of(program, stamps)}};
  if (!p.cut.beyond_stamps.empty())
    j["beyond_model"]["deflection_um"] = {{"max", 1000 * p.cut.deflection_max_mm},
                                          {"limit", 1000 * p.cut.deflection_limit_mm}};
}

/// Returns the machine time of the tooth passings of the chosen operations, without rapids.
double simulated_time_s(std::span<const removal::Stamp> stamps) {
  double time_s = 0;
  for (std::size_t k = 1; k < stamps.size(); ++k)
    if (!stamps[k].first) time_s += stamps[k].t_s - stamps[k - 1].t_s;
  return time_s;
}

Json chatter_json(const simulate::ChatterMargins& margins) {
  Json out = {{"operations", Json::array()}};
  double worst = 0;
  for (const simulate::ChatterOperation& o : margins.operations) {
    worst = std::max(worst, o.margin);
    out["operations"].push_back(
        {{"tool", o.tool},
         {"speed_rpm", o.speed_rpm},
         {"modes", o.measured ? "given" : "beam"},
         {"margin", o.margin},
         {"line", o.line},
         {"chatter_Hz", o.chatter_hz},
         {"depth_mm", o.depth_mm},
         {"critical_depth_mm", o.stable_depth_mm},
         {"arc_deg", deg_from_rad(o.arc_rad)},
         {"probability", o.probability},
         {"margin_range", {o.margin_low, o.margin_high}},
         {"stable_speed_rpm", o.stable_speed_rpm > 0 ? Json(o.stable_speed_rpm) : Json(nullptr)},
         {"lines", o.lines}});
  }
  out["margin"] = worst;
  return out;
}

Json traced_json(const simulate::TracedRun& t) {
  return {{"file", t.trace},
          {"matched_by", t.by_line ? "line" : "place"},
          {"samples", t.samples.size()},
          {"period_s", t.period_s},
          {"off_path_um", {{"p95", 1000 * t.off_path_p95_mm}, {"max", 1000 * t.off_path_max_mm}}},
          {"model",
           {{"machine_time_s", t.model.feed.time_s},
            {"force_N", {{"max", largest_force_N(t.predicted)}}},
            {"form_error_um", figures_json(t.predicted.form_error_um)},
            {"deflection_um", figures_json(t.predicted.deflection_um)},
            {"contour_um", figures_json(t.predicted.contour_um)}}},
          {"difference_um", figures_json(t.difference_um)}};
}

std::string traced_text(const simulate::TracedRun& t) {
  return fmt::format("{}\n{}\nthe feed model takes {:.1f} s; {} samples of the trace matched by {}\n",
                     figures_row("feed model", t.predicted.form_error_um), figures_row("difference", t.difference_um),
                     t.model.feed.time_s, t.samples.size(), t.by_line ? "line" : "place");
}

}  // namespace

std::string predict_json(const simulate::SimulatedProgram& program, const simulate::Prediction& p, double compute_s,
                         const simulate::TracedRun* traced, const std::vector<std::string>& doubts) {
  Json j;
  j["schema_version"] = kSchemaVersion;
  j["machine_time_s"] = program.feed.time_s;
  j["cutting_time_s"] = program.feed.cutting_time_s;
  j["simulated_time_s"] = simulated_time_s(program.path.stamps);
  j["compute_s"] = compute_s;
  j["stamps"] = program.path.stamps.size();
  j["force_N"] = {{"max", largest_force_N(p)}};
  const SpindleFigures s = spindle_figures(program, p);
  j["torque_Nm"] = {{"max", s.torque_max_Nm}};
  j["power_W"] = {{"max", s.power_max_W}, {"mean", s.power_mean_W}};
  j["chip_thickness_mm"] = {{"max", s.chip_max_mm}};
  j["specific_energy_MPa"] = s.specific_energy_MPa;
  j["removed_mm3"] = {{"path", chips_mm3(p)}, {"stock", p.cut.stock_mm3}};
  if (p.cut.rapid_mm3 > 0) j["removed_mm3"]["rapid"] = p.cut.rapid_mm3;
  if (p.holes.any()) j["holes"] = holes(p.holes);
  j["form_error_um"] = form_error(p);
  j["deflection_um"] = figures_json(p.deflection_um);
  if (p.deflection_parts_um) add_workpiece(*p.deflection_parts_um, j);
  j["contour_um"] = figures_json(p.contour_um);
  if (p.contour_parts_um)
    j["contour_parts_um"] = {{"lag", figures_json(p.contour_parts_um->lag_um)},
                             {"path_tolerance", figures_json(p.contour_parts_um->path_tolerance_um)},
                             {"corner_law", figures_json(p.contour_parts_um->corner_law_um)}};
  j["unseen_mm2"] = p.unseen_mm2;
  j["border_mm2"] = p.border_mm2;
  j["not_judged_mm2"] = p.not_judged_mm2;
  j["stage_between"] = p.between;
  if (!p.total_error_mm.empty()) j["total_error_um"] = figures_json(total_error(p));
  j["static"] = {
      {"rounds_max", p.cut.rounds_max},
      {"passings_read", p.cut.read},
      {"extrapolation_error_um", {{"rms", p.cut.extrapolation.rms_um()}, {"max", p.cut.extrapolation.max_um}}},
      {"unsettled_stretches", p.cut.unsettled},
      {"unsettled_lines", unsettled_lines(program, p)}};
  for (const Reason reason : {Reason::pulled_in, Reason::pushed_out, Reason::swings})
    if (const auto lines = unsettled_lines(program, p, reason); !lines.empty())
      j["static"]["unsettled_reasons"].push_back({{"reason", name(reason)}, {"lines", lines}});
  if (traced) j["trace"] = traced_json(*traced);
  j["chatter"] = chatter_json(p.chatter);
  j["doubts"] = doubts;
  add_beyond_model(program, p, j);
  return j.dump(2) + "\n";
}

std::string predict_text(const simulate::SimulatedProgram& program, const simulate::Prediction& p, double compute_s,
                         const simulate::TracedRun* traced) {
  std::string out = fmt::format("machine time {:.1f} s, cutting {:.1f} s; computed in {:.1f} s\n", program.feed.time_s,
                                program.feed.cutting_time_s, compute_s);
  const SpindleFigures s = spindle_figures(program, p);
  const double milled_mm3 = p.cut.milled_mm3();
  const double balance = milled_mm3 > 0 ? 100 * (p.cut.chip_mm3 / milled_mm3 - 1) : 0;
  if (p.validity.all())
    fmt::format_to(std::back_inserter(out), "removed {:.3f} mm3 by the chips, {:.3f} mm3 by the stock ({:+.2f} %{})\n",
                   p.cut.chip_mm3, p.cut.stock_mm3, balance,
                   p.cut.rapid_mm3 > 0
                       ? fmt::format(" without {:.3f} mm3 of the allowance that rapids end in", p.cut.rapid_mm3)
                       : "");
  else
    fmt::format_to(std::back_inserter(out), "removed {:.3f} mm3 by the stock\n", p.cut.stock_mm3);
  const bool no_forces = simulate::forces_beyond_model(p), no_errors = simulate::beyond_model(p);
  const std::string chatter = chatter_text(p.chatter);
  if (no_forces && no_errors) return out + chatter + "force, deflection and form error: beyond the model's range\n";
  if (no_forces) {
    out += "forces: beyond the model's range\n";
  } else {
    fmt::format_to(std::back_inserter(out),
                   "maximum lateral force {:.1f} N, torque {:.3f} Nm, chip thickness {:.4f} mm\n", largest_force_N(p),
                   s.torque_max_Nm, s.chip_max_mm);
    fmt::format_to(std::back_inserter(out), "power {:.1f} W maximum, {:.1f} W mean in the cut; {:.0f} J/cm3\n",
                   s.power_max_W, s.power_mean_W, s.specific_energy_MPa);
  }
  out += chatter;
  if (p.holes.any()) out += holes_text(p.holes);
  if (no_errors) return out + "deflection and form error: beyond the model's range\n";
  fmt::format_to(std::back_inserter(out), "{}\n{}\n{}\n{}\n", kFiguresHead, figures_row("error", p.form_error_um),
                 figures_row(" deflection", p.deflection_um) + deflection_parts_text(p),
                 figures_row(" contour", p.contour_um));
  if (p.contour_parts_um)
    fmt::format_to(std::back_inserter(out), "{}\n{}\n{}\n", figures_row("  lag", p.contour_parts_um->lag_um),
                   figures_row("  tolerance", p.contour_parts_um->path_tolerance_um),
                   figures_row("  corners", p.contour_parts_um->corner_law_um));
  if (!p.total_error_mm.empty())
    fmt::format_to(std::back_inserter(out), "{}\n", figures_row("against part", total_error(p)));
  if (p.validity.invalid_mm2 > 0)
    fmt::format_to(std::back_inserter(out), "beyond the model, in no figure: {:.1f} of {:.1f} mm2\n",
                   p.validity.invalid_mm2, p.validity.surface_mm2);
  if (traced) out += traced_text(*traced);
  if (p.deflection_parts_um) out += workpiece_text(*p.deflection_parts_um->survey);
  return out + region_text({p.border_mm2, p.not_judged_mm2, p.between});
}

std::string region_text(const RegionFigures& region) {
  std::string out;
  if (region.border_mm2 > 0)
    fmt::format_to(std::back_inserter(out), "not judged, other operations cut deeper there: {:.1f} mm2\n",
                   region.border_mm2);
  if (region.not_judged_mm2 > 0)
    fmt::format_to(std::back_inserter(out), "not judged, outside [part] judged: {:.1f} mm2\n", region.not_judged_mm2);
  if (region.between) out += "other operations cut deeper everywhere: an intermediate stage, everything is judged\n";
  return out;
}

std::string unsettled_sentence(const simulate::SimulatedProgram& program, const simulate::Prediction& p) {
  if (p.cut.unsettled == 0) return {};
  std::string why;
  for (const auto reason : {Reason::pulled_in, Reason::pushed_out, Reason::swings}) {
    const std::vector<std::size_t> lines = unsettled_lines(program, p, reason);
    if (!lines.empty())
      why += fmt::format("{}{} in {}", why.empty() ? "" : "; ", simulate::no_equilibrium_text(reason), named(lines));
  }
  return fmt::format(
      "the static deflection did not converge in {} stretch{} of the path: {}; figures from there on are uncertain",
      p.cut.unsettled, p.cut.unsettled > 1 ? "es" : "", why);
}

namespace {

std::string sentence_unless(bool settled) {
  return settled ? "" : "the static deflection of some stretches did not converge; their figures are uncertain";
}

}  // namespace

std::string unsettled_sentence(const compensate::CompensationResult& c) { return sentence_unless(c.verdict.settled); }
std::string unsettled_sentence(const compensate::Verification& v) { return sentence_unless(v.settled); }

}  // namespace camber::report
