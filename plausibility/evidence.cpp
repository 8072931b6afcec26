#include "plausibility/evidence.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/units.h"
#include "checks/setup_checks.h"
#include "machine/assumptions.h"
#include "machine/force_law.h"
#include "simulate/pieces.h"

namespace camber::plausibility {
namespace {

bool uses_inches(const nc::Interpretation& moves) { return std::ranges::any_of(moves.states, &nc::ModalState::inch); }

double specific_force(const machine::Material& material) {
  constexpr double kChip_mm = 0.1;
  return machine::with_law(material.law,
                           [&](auto law) { return decltype(law)::specific_MPa(material, kChip_mm).tangential; });
}

/// Rise of a line over its way across; none of arcs, whose helices are ramps into the material.
double slope(const nc::Move& m) {
  const Vec3 way = m.end_mm - m.start_mm;
  return m.kind == nc::MoveKind::linear ? way.z() / std::max(1e-9, way.head<2>().norm()) : 0;
}

void add_motion(const nc::Interpretation& moves, const nc::Move& m, ToolWork& work) {
  const double kLeast = std::tan(rad_from_deg(2)), kMost = std::tan(rad_from_deg(80));
  const double length = nc::length_mm(moves, m), rise = slope(m);
  work.milling_mm += length;
  if (std::abs(m.end_mm.z() - m.start_mm.z()) < 1e-6) work.level_mm += length;
  if (std::abs(rise) > kLeast && std::abs(rise) < kMost) {
    work.sloping_mm += length;
    if (rise > 0) work.rising_mm += length;
  }
  // Straight down the bottom cuts, with other feeds.
  if (std::abs(rise) >= kMost && m.kind == nc::MoveKind::linear) return;
  const nc::ModalState& s = moves.state_of(m);
  const double feed = mm_per_min_from_mm_per_s(m.feed_mm_per_s);
  if (s.spindle_speed_rpm <= 0 || feed <= 0) return;
  work.feed_mm_per_min.add(feed, length);
  work.spindle_rpm.add(s.spindle_speed_rpm, length);
  work.feed_per_tooth_mm.add(feed / s.spindle_speed_rpm / work.tool->flutes, length);
  work.cutting_speed_m_per_min.add(kPi * work.tool->diameter_mm * s.spindle_speed_rpm / 1000, length);
}

bool goes_straight_down(const nc::Move& m) {
  return m.kind == nc::MoveKind::linear && m.end_mm.z() < m.start_mm.z() &&
         (m.end_mm - m.start_mm).head<2>().norm() < 1e-6;
}

void add_cut(const checks::MoveCut& m, double power_W, std::uint32_t move, ToolWork& work) {
  if (m.deepest_mm > work.cut.deepest_mm) {
    work.cut.deepest_mm = m.deepest_mm;
    work.cut.deepest_place = m.deepest_place;
    work.deepest_move = move;
  }
  work.cut.length_mm += m.length_mm;
  work.cut.cutting_mm += m.cutting_mm;
  work.cut.beside_mm += m.beside_mm;
  work.cut.approach_mm += m.approach_mm;
  work.cut.volume_mm3 += m.volume_mm3;
  work.cut.area_mm2 += m.area_mm2;
  work.depth_mm.add(m.deepest_mm, m.cutting_mm);
  work.power_W.add(power_W, m.cutting_mm);
}

std::vector<ToolWork> tool_works(const Evidence& e) {
  const nc::Interpretation& moves = e.program.moves_in_part();
  std::vector<ToolWork> out;
  for (const int number : checks::cutting_tools(moves, e.program.selected, e.program.holes)) {
    const auto tool = e.job.tools.find(number);
    if (tool == e.job.tools.end()) continue;
    ToolWork& work = out.emplace_back();
    work.number = number;
    work.tool = &tool->second;
    const auto said = std::ranges::find(e.said, number, &machine::ToolProposal::number);
    if (said != e.said.end()) work.said = &*said;
    bool first = true;
    for (std::uint32_t i = 0; i < moves.moves.size(); ++i) {
      const nc::Move& m = moves.moves[i];
      const bool hole = removal::makes_hole(e.program.holes[i]);
      if ((!e.program.selected[i] && !hole) || moves.state_of(m).tool != number) continue;
      if (first) work.first_move = i, first = false;
      if (hole) {
        ++work.holes;
        continue;
      }
      work.mills = true;
      add_motion(moves, m, work);
      if (!e.survey) continue;
      const checks::MoveCut& cut = e.survey->moves[i];
      const double seconds = m.feed_mm_per_s > 0 ? cut.cutting_mm / m.feed_mm_per_s : 0;
      const double power = seconds > 0 ? e.specific_force_MPa * cut.volume_mm3 / seconds / 1000 : 0;  // N mm/s to W
      add_cut(cut, power, i, work);
      if (goes_straight_down(m) && power > work.plunge_W) work.plunge_W = power, work.plunge_move = i;
    }
  }
  return out;
}

}  // namespace

double Spread::at(double fraction) const {
  if (values_.empty()) return 0;
  if (!sorted_) std::ranges::sort(values_), sorted_ = true;
  double so_far = 0;
  for (const auto& [value, weight] : values_)
    if ((so_far += weight) >= fraction * weight_) return value;
  return values_.back().first;
}

Evidence::Evidence(const machine::Job& of_job, const simulate::SimulatedProgram& of_program)
    : job(of_job),
      program(of_program),
      said(machine::tools_in_comments(of_program.text().source, uses_inches(of_program.moves_in_part()))),
      stock(checks::stock_box(of_job)),
      specific_force_MPa(specific_force(of_job.material)),
      assumed(machine::assumed_keys(of_job.path)) {
  if (stock) {
    Diagnostics of_places;
    checks::check_places(program.text().source.name(), simulate::places_of(job, program, *stock), of_places);
    elsewhere = !of_places.all().empty();
    const double cell = checks::quick_cell_mm(job, program, *stock, job.simulation.voxel_mm);
    survey = checks::survey_heights(job, program, {.cell_mm = cell, .tolerance_mm = cell});
  }
  tools = tool_works(*this);
}

namespace {

const simulate::SimulatedProgram& no_program() {
  static const simulate::SimulatedProgram none;
  return none;
}

}  // namespace

Evidence::Evidence(const machine::Job& of_job)
    : job(of_job),
      program(no_program()),
      stock(checks::stock_box(of_job)),
      specific_force_MPa(specific_force(of_job.material)),
      assumed(machine::assumed_keys(of_job.path)) {
  for (const auto& [number, tool] : job.tools) {
    ToolWork& work = tools.emplace_back();
    work.number = number;
    work.tool = &tool;
    work.mills = tool.type != machine::ToolType::drill;
  }
}

Severity Evidence::error_of(int tool, std::initializer_list<std::string_view> keys, bool of_stock) const {
  const std::string table = fmt::format("tool.{}", tool);
  const bool doubtful =
      (of_stock && machine::is_assumed(assumed, "stock", "box_mm")) ||
      std::ranges::any_of(keys, [&](std::string_view key) { return machine::is_assumed(assumed, table, key); });
  return doubtful ? Severity::warning : Severity::error;
}

Diagnostic Evidence::at_job(Severity severity, std::string message, std::string check) const {
  return {severity, {job.path, 0, 0}, std::move(message), std::move(check), {}};
}

Diagnostic Evidence::at_move(Severity severity, std::uint32_t move, std::string message, std::string check) const {
  return program.text().source.diagnostic(severity,
                                          program.text().blocks[program.moves_in_part().moves[move].block].offset,
                                          std::move(message), std::move(check));
}

}  // namespace camber::plausibility
