#include "checks/machine_collisions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/units.h"
#include "checks/tool_outline.h"
#include "feedmodel/rapid.h"
#include "kinematics/joint_map.h"
#include "kinematics/program_joints.h"
#include "nc/known_places.h"

namespace camber::checks {
namespace {

using kinematics::Joints;

/// Distance of the places on arcs, and on rapids with every axis on its own. An arc of 10 mm leaves its chord by 3 um.
constexpr double kCurveStep_mm = 0.5;
/// Turn between the places of a rotary axis. A metre from the axis the chord leaves the arc by 2.4 um.
constexpr double kTurnStep_deg = 0.25;

struct ToolHeight {
  const machine::Job& job;
  std::map<int, double> known{};

  double operator()(int tool) {
    const auto at = known.find(tool);
    if (at != known.end()) return at->second;
    double top = 0;
    for (const OutlineRing& ring : tool_outline(job.tools.at(tool), kCurveStep_mm, 1e6))
      top = std::max(top, ring.height_mm);
    return known[tool] = top;
  }
};

std::vector<Vec3> tips_of(const machine::Machine& machine, const nc::Interpretation& moves, const nc::Move& m) {
  if (m.kind == nc::MoveKind::rapid) return feedmodel::positioning_places(machine, m.start_mm, m.end_mm, kCurveStep_mm);
  if (m.kind != nc::MoveKind::arc) return {m.start_mm, m.end_mm};
  std::vector<Vec3> out;
  const int n = std::max(1, static_cast<int>(std::ceil(nc::length_mm(moves, m) / kCurveStep_mm)));
  for (int i = 0; i <= n; ++i) out.push_back(nc::point_at(moves, m, static_cast<double>(i) / n));
  return out;
}

/// X, Y and Z alone; the tool's tip is what the program names.
void pass_upright(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                  const Vec3& origin_mm, const MachineMoveSink& sink) {
  const machine::Kinematics& k = job.machine.kinematics;
  nc::KnownPlaces places(text, moves);
  ToolHeight height{job};
  int last_tool = 0;
  bool at_known = false;
  for (std::uint32_t i = 0; i < moves.moves.size(); ++i) {
    const nc::Move& m = moves.moves[i];
    const nc::ModalState& state = moves.state_of(m);
    const nc::KnownPlaces::Ends known = places.next(m);
    if (m.kind == nc::MoveKind::dwell) continue;
    const bool followed = at_known && last_tool == state.tool && known.start;
    at_known = known.end && job.tools.contains(state.tool);
    last_tool = state.tool;
    if (!at_known) continue;
    const double given = state.tool_length_mm.value_or(0), length = given > 0 ? given : height(state.tool);
    const Vec3 gauge_from_tip = length * k.tool_axis.normalized() - k.gauge_point_mm - origin_mm;
    std::vector<Joints> joints;
    for (const Vec3& tip : known.start ? tips_of(job.machine, moves, m) : std::vector<Vec3>{m.end_mm})
      joints.push_back({tip + gauge_from_tip, Vec3::Zero()});
    sink({i, state.tool, length, followed}, joints);
  }
}

std::vector<Joints> joints_of(const kinematics::ProgramJoints& program, const kinematics::MoveJoints& move,
                              const nc::Interpretation& moves, const nc::Move& m) {
  if (!move.start_known) return {program.at(1)};
  const double turn_deg = deg_from_rad((move.end_rad - move.start_rad).lpNorm<Eigen::Infinity>());
  double pieces = std::ceil(turn_deg / kTurnStep_deg);
  if (m.kind == nc::MoveKind::arc) pieces = std::max(pieces, std::ceil(nc::length_mm(moves, m) / kCurveStep_mm));
  const int n = std::max(1, static_cast<int>(pieces));
  std::vector<Joints> out;
  for (int i = 0; i <= n; ++i) out.push_back(program.at(static_cast<double>(i) / n));
  return out;
}

void pass_turning(const machine::Job& job, const nc::Interpretation& moves, const MachineMoveSink& sink) {
  int last_tool = 0;
  bool at_known = false;
  for (kinematics::ProgramJoints program(job.machine, moves); !program.done();) {
    const kinematics::MoveJoints now = program.next();
    const nc::Move& m = moves.moves[program.index()];
    const nc::ModalState& state = moves.state_of(m);
    if (m.kind == nc::MoveKind::dwell && !now.turns()) continue;
    const bool followed = at_known && last_tool == state.tool && now.start_known;
    at_known = now.linear_known && state.tool_length_mm && job.tools.contains(state.tool);
    last_tool = state.tool;
    if (at_known)
      sink({static_cast<std::uint32_t>(program.index()), state.tool, *state.tool_length_mm, followed},
           joints_of(program, now, moves, m));
  }
}

}  // namespace

kinematics::Chain chain_of(const machine::Machine& machine) {
  if (machine.kinematics.given()) return kinematics::Chain(machine);
  machine::Machine three_axes = machine;
  three_axes.kinematics.chain = "xyz";
  return kinematics::Chain(three_axes);
}

void for_each_machine_move(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                           const Vec3& origin_mm, const MachineMoveSink& sink) {
  if (kinematics::has_rotary_motion(moves, job.machine))
    pass_turning(job, moves, sink);
  else
    pass_upright(job, text, moves, origin_mm, sink);
}

}  // namespace camber::checks
