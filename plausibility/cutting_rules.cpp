#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "base/units.h"
#include "checks/setup_checks.h"
#include "checks/travel.h"
#include "deflection/beam.h"
#include "machine/cutter_parameters.h"
#include "machine/force_law.h"
#include "plausibility/rules.h"

namespace camber::plausibility {
namespace {

struct Bounds {
  double least = 0, greatest = 0;
};

/// Feeds per tooth of milling cutters, from finishing with a worn machine to roughing aluminium.
Bounds usual_feed_per_tooth_mm(double diameter_mm) {
  constexpr double kSmall_mm = 6;
  const double greatest = 0.06 * std::min(diameter_mm, kSmall_mm) + 0.01 * std::max(0.0, diameter_mm - kSmall_mm);
  return {std::min(0.001 * diameter_mm, 0.02), greatest};
}

constexpr double kSoft_MPa = 1200;      // aluminium, plastics; steel and iron above
constexpr double kSteelTool_MPa = 3e5;  // modulus of elasticity between high-speed steel and carbide

/// Cutting speeds by the material's specific cutting force and what the tool is made of.
Bounds usual_speed_m_per_min(double specific_force_MPa, double youngs_modulus_MPa) {
  const bool soft = specific_force_MPa < kSoft_MPa, steel_tool = youngs_modulus_MPa < kSteelTool_MPa;
  Bounds out = soft ? Bounds{30, 2500} : Bounds{20, 600};
  if (steel_tool) out = soft ? Bounds{15, 600} : Bounds{6, 120};
  return out;
}

std::string cutting_text(const ToolWork& work) {
  return fmt::format("T{} with {} flute{} at S{:g} and F{:g}", work.number, work.tool->flutes,
                     work.tool->flutes == 1 ? "" : "s", std::round(work.spindle_rpm.median()),
                     std::round(work.feed_mm_per_min.median()));
}

}  // namespace

void look_at_chips(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kMeaningless = 3;  // times beyond the bounds
  for (const ToolWork& work : e.tools) {
    if (work.feed_per_tooth_mm.empty()) continue;
    const double chip = work.feed_per_tooth_mm.median();
    const Bounds usual = usual_feed_per_tooth_mm(work.tool->diameter_mm);
    if (chip >= usual.least && chip <= usual.greatest) continue;
    const bool grave = chip > kMeaningless * usual.greatest || chip < usual.least / kMeaningless;
    diagnostics.add(e.at_move(
        grave ? e.error_of(work.number, {"flutes", "diameter_mm"}, false) : Severity::warning, work.first_move,
        fmt::format("{} feeds {:.2g} mm per tooth, {:.2g} of its diameter of {:g} mm; {:.2g} to {:.2g} mm was expected "
                    "(S, F, flutes, diameter_mm?)",
                    cutting_text(work), chip, chip / work.tool->diameter_mm, work.tool->diameter_mm, usual.least,
                    usual.greatest),
        "chip-load"));
  }
}

void look_at_speed(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kNearMax = 0.4;  // of the spindle's top speed: small cutters turn no faster
  for (const ToolWork& work : e.tools) {
    if (work.cutting_speed_m_per_min.empty() || e.specific_force_MPa <= 0) continue;
    const double speed = work.cutting_speed_m_per_min.median();
    const Bounds usual = usual_speed_m_per_min(e.specific_force_MPa, work.tool->youngs_modulus_MPa);
    const bool slow = speed < usual.least && work.spindle_rpm.median() < kNearMax * e.job.machine.spindle.max_rpm;
    if (!slow && speed <= usual.greatest) continue;
    diagnostics.add(e.at_move(
        Severity::warning, work.first_move,
        fmt::format("{} cuts at {:.2g} m/min with {:g} mm; {:g} to {:g} m/min was expected of {} in a material of "
                    "{:.0f} MPa (S, diameter_mm, [material]?)",
                    cutting_text(work), speed, work.tool->diameter_mm, usual.least, usual.greatest,
                    work.tool->youngs_modulus_MPa < kSteelTool_MPa ? "high-speed steel" : "carbide",
                    e.specific_force_MPa),
        "cutting-speed"));
  }
}

namespace {

constexpr double kDeepOften = 0.15;  // of a tool's way in material

bool mills_with(const Evidence& e, std::uint32_t move, const ToolWork& work) {
  const nc::Interpretation& moves = e.program.moves_in_part();
  return e.program.selected[move] && e.survey->moves[move].cutting_mm > 0 &&
         moves.state_of(moves.moves[move]).tool == work.number;
}

/// A chamfer cutter that meets material above its cone, where most such cutters have no edge.
void look_at_cone(const Evidence& e, const ToolWork& work, Diagnostics& diagnostics) {
  if (work.tool->type != machine::ToolType::chamfer) return;
  const double cone_mm = machine::parameters_of(*work.tool).height_mm;
  double above_mm = 0, highest = 0;
  std::uint32_t where = 0;
  for (std::uint32_t i = 0; i < e.survey->moves.size(); ++i) {
    const checks::MoveCut& cut = e.survey->moves[i];
    if (!mills_with(e, i, work) || cut.above_tip_mm <= cone_mm + e.survey->cell_mm) continue;
    above_mm += cut.cutting_mm;
    if (cut.above_tip_mm > highest) highest = cut.above_tip_mm, where = i;
  }
  if (above_mm <= kDeepOften * work.cut.cutting_mm) return;
  diagnostics.add(e.at_move(
      Severity::warning, where,
      fmt::format("T{} is \"chamfer\" in the job and meets material up to {:.1f} mm above its tip, but its cone is "
                  "{:.1f} mm high; a stock whose edges are cut and only lack their chamfer was expected (is the stock "
                  "too high, or the tool another one?)",
                  work.number, highest, cone_mm),
      "cut-depth"));
}

}  // namespace

void look_at_depth(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kSlot = 0.7;                   // of the diameter, and wider
  constexpr double kDeepSlot = 3, kDeepSide = 8;  // diameters
  if (!e.survey) return;
  for (const ToolWork& work : e.tools) {
    const double d = work.tool->diameter_mm;
    double deep_mm = 0, deepest = 0;
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < e.survey->moves.size(); ++i) {
      const checks::MoveCut& cut = e.survey->moves[i];
      if (!mills_with(e, i, work)) continue;
      const double width = cut.area_mm2 / cut.cutting_mm;
      if (cut.deepest_mm < (width > kSlot * d ? kDeepSlot : kDeepSide) * d) continue;
      if (deep_mm == 0) first = i;
      deep_mm += cut.cutting_mm;
      deepest = std::max(deepest, cut.deepest_mm);
    }
    if (deep_mm <= kDeepOften * work.cut.cutting_mm) {
      look_at_cone(e, work, diagnostics);
      continue;
    }
    diagnostics.add(e.at_move(
        Severity::warning, first,
        fmt::format("T{} cuts {:.1f} mm deep at once, {:.1f} times its diameter; at most {:g} times in a slot was "
                    "expected (is the stock too high, or the tool another one?)",
                    work.number, deepest, deepest / d, kDeepSlot),
        "cut-depth"));
  }
}

void look_at_power(const Evidence& e, Diagnostics& diagnostics) {
  constexpr double kMost_W = 60e3, kBroken = 0.5;  // of a milling spindle; of the diameter
  for (const ToolWork& work : e.tools) {
    if (work.power_W.empty() || work.cutting_speed_m_per_min.empty()) continue;
    const double power = work.power_W.at(0.95), speed = work.cutting_speed_m_per_min.median() / 60;  // m/s
    const double force = power / speed;
    const double depth = std::min(work.depth_mm.at(0.95), work.tool->overhang_mm) / 2;
    const double bend = force * deflection::beam_of(*work.tool).compliance_mm_per_N(0, depth);
    const double motor = std::min(kMost_W, 3 * e.job.machine.spindle.power_W);
    if (power > motor)
      diagnostics.add(e.at_move(e.error_of(work.number, {"type", "diameter_mm"}, true), work.deepest_move,
                                fmt::format("T{} needs {:.3g} kW for its chips; no more than {:.3g} kW was expected "
                                            "(depth of the cut, [material], F?)",
                                            work.number, power / 1000, motor / 1000),
                                "cut-power"));
    else if (bend > kBroken * work.tool->diameter_mm && checks::slenderness(*work.tool) <= checks::kMaxSlenderness)
      diagnostics.add(e.at_move(
          e.error_of(work.number, {"type", "diameter_mm", "overhang_mm"}, true), work.deepest_move,
          fmt::format(
              "T{} would bend by {:.2g} mm under the mean force of its chips, {:.3g} N, and break; a cut that a "
              "cutter of {:g} mm with overhang_mm = {:g} stands was expected",
              work.number, bend, force, work.tool->diameter_mm, work.tool->overhang_mm),
          "cut-power"));
    else if (work.plunge_W > motor)
      diagnostics.add(
          e.at_move(Severity::warning, work.plunge_move,
                    fmt::format("T{} goes straight down into the stock, which needs {:.3g} kW for its chips; a place "
                                "beside the stock, or that is cut already, was expected (is the stock too large?)",
                                work.number, work.plunge_W / 1000),
                    "cut-power"));
  }
}

void look_at_material(const Evidence& e, Diagnostics& diagnostics) {
  const machine::Material& m = e.job.material;
  const auto say = [&](std::string message, Severity severity) {
    diagnostics.add(e.at_job(severity, std::move(message), "material-values"));
  };
  if (!m.preset.empty()) return;
  constexpr Bounds kForce_MPa{5, 12000}, kEdge_N_per_mm{0.05, 300};
  constexpr double kEdgeOverForce_mm = 0.06, kSideways = 1.5;
  const std::string_view key = machine::description(m.law).coefficients.front().key;
  const double force = e.specific_force_MPa;
  if (force <= 0) return;
  if (force < kForce_MPa.least || force > kForce_MPa.greatest)
    say(fmt::format(
            "[material] {}: the specific cutting force of chips of 0.1 mm is {:.3g} MPa; {:g} (wax) to {:g} MPa "
            "was expected (GPa, psi, kgf/mm2?)",
            key, force, kForce_MPa.least, kForce_MPa.greatest),
        Severity::error);
  const double edge = std::max(m.kte_N_per_mm, m.kre_N_per_mm);
  if (edge > 0 && (edge < kEdge_N_per_mm.least || edge > kEdge_N_per_mm.greatest))
    say(fmt::format("[material] kte_N_per_mm = {:g}, kre_N_per_mm = {:g}; {:g} to {:g} N/mm was expected (N/m, kN/m?)",
                    m.kte_N_per_mm, m.kre_N_per_mm, kEdge_N_per_mm.least, kEdge_N_per_mm.greatest),
        edge > kEdge_N_per_mm.greatest ? Severity::error : Severity::warning);
  else if (m.kte_N_per_mm > kEdgeOverForce_mm * force)
    say(fmt::format("[material] kte_N_per_mm = {:g} is {:.2g} mm times the specific cutting force, {:.4g} MPa; up to "
                    "{:g} mm was expected (are both in N and mm?)",
                    m.kte_N_per_mm, m.kte_N_per_mm / force, force, kEdgeOverForce_mm),
        Severity::warning);
  const auto components = machine::with_law(m.law, [&](auto law) { return decltype(law)::specific_MPa(m, 0.1); });
  const double sideways = std::max(std::abs(components.radial), std::abs(components.axial));
  if (sideways > kSideways * force)
    say(fmt::format(
            "[material]: the radial or axial force, {:.4g} MPa, is {:.2g} times the tangential one, {:.4g} MPa; "
            "up to {:g} times was expected (are all in MPa?)",
            sideways, sideways / force, force, kSideways),
        Severity::warning);
}

void look_at_travel(const Evidence& e, Diagnostics& diagnostics) {
  checks::check_travel(e.job, e.program, diagnostics);
}

}  // namespace camber::plausibility
