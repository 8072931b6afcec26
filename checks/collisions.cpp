#include "checks/collisions.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "checks/collision_search.h"
#include "motion/operations.h"
#include "nc/known_places.h"
#include "removal/tool_path.h"

namespace camber::checks {
namespace {

/// Tells the rapids of cycles that stay in their hole, where the tool has been just before; there G76 also leaves the
/// hole's axis, which its tool, as a turning outline, could not.
class HoleWatch {
 public:
  bool in_hole(const nc::Move& m) {
    if (m.cycle == 0) return false;
    if (m.cycle == 87) return true;  // beside the axis all the way
    if (m.kind == nc::MoveKind::linear && m.end_mm.z() < m.start_mm.z() && (m.block != block_ || !reaches(m))) {
      block_ = m.block;
      entry_z_mm_ = m.start_mm.z();
      place_ = m.start_mm.head<2>();
    }
    constexpr double kRounding_mm = 1e-6;
    if (m.block != block_ || (m.cycle != 76 && m.start_mm.head<2>() != place_)) return false;
    return std::min(m.start_mm.z(), m.end_mm.z()) < entry_z_mm_ - kRounding_mm;
  }

 private:
  /// Another peck of the hole.
  bool reaches(const nc::Move& m) const { return m.start_mm.head<2>() == place_; }
  std::uint32_t block_ = std::numeric_limits<std::uint32_t>::max();
  double entry_z_mm_ = 0;
  Vec2 place_ = Vec2::Zero();
};

/// Something that cuts was not simulated, so stock may stand that the real machine has removed.
bool motion_left_out(const motion::SimulatedProgram& program) {
  for (std::size_t i = 0; i < program.moves_in_part().moves.size(); ++i) {
    const nc::Move& m = program.moves_in_part().moves[i];
    const bool cuts = m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc;
    const removal::HoleMove hole = program.holes[i];
    const bool carved = removal::makes_hole(hole) || hole == removal::HoleMove::way_out;
    if (cuts && !m.reference && !program.selected[i] && !carved) return true;
  }
  return false;
}

const char* name(Collision::Part part) {
  if (part == Collision::Part::cutter) return "cutter";
  return part == Collision::Part::shank ? "shank" : "holder";
}

const char* check_name(const Collision& c) {
  if (c.rapid) return "collision-rapid";
  return c.part == Collision::Part::shank ? "collision-shank" : "collision-holder";
}

/// "rapid through material: the cutter of T1 in stock at X1.00 Y2.00 Z3.00, 4.00 s into the program".
std::string deed(const Collision& c) {
  return fmt::format("{}the {} of T{} in stock at X{:.2f} Y{:.2f} Z{:.2f}, {:.2f} s into the program",
                     c.rapid ? "rapid through material: " : "", name(c.part), c.tool, c.place_mm.x(), c.place_mm.y(),
                     c.place_mm.z(), c.t_s);
}

void report(const motion::SimulatedProgram& program, const Collision& c, Severity severity, const std::string& message,
            Diagnostics& diagnostics) {
  const std::size_t offset = program.text().blocks[program.moves_in_part().moves[c.move].block].offset;
  diagnostics.add(program.text().source.diagnostic(severity, offset, message, check_name(c)));
}

void report_inside(const motion::SimulatedProgram& program, const std::vector<Collision>& found, Severity severity,
                   Diagnostics& diagnostics) {
  constexpr std::size_t kMax = 10;
  for (std::size_t i = 0; i < std::min(found.size(), kMax); ++i) {
    const Collision& c = found[i];
    const std::string more = i + 1 == kMax && found.size() > kMax ? fmt::format(" ({} more)", found.size() - kMax) : "";
    report(program, c, severity,
           fmt::format("{}{}; {} was expected", deed(c), more,
                       c.rapid ? "a rapid clear of the stock" : "a longer overhang or less depth"),
           diagnostics);
  }
}

/// One line: what these moves meet may be gone before they run, since other moves are left out too.
void report_outside(const motion::SimulatedProgram& program, const std::vector<Collision>& found, Severity severity,
                    Diagnostics& diagnostics) {
  if (found.empty()) return;
  const Collision& c = found.front();
  report(
      program, c, severity,
      fmt::format("{} collision{} in moves outside the job's operations, the first one in line {}: {}; moves that the "
                  "job leaves out may have cleared the way",
                  found.size(), found.size() == 1 ? "" : "s", program.moves_in_part().moves[c.move].block + 1, deed(c)),
      diagnostics);
}

}  // namespace

std::vector<RapidCheck> rapids_of(const motion::SimulatedProgram& program) {
  std::vector<RapidCheck> out;
  HoleWatch watch;
  nc::KnownPlaces places(program.text(), program.moves_in_part());
  const auto& stamps = program.path.stamps;
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < program.moves_in_part().moves.size(); ++i) {
    const nc::Move& m = program.moves_in_part().moves[i];
    while (next < stamps.size() && stamps[next].move < i) ++next;
    const nc::KnownPlaces::Ends known = places.next(m);
    if (m.reference || watch.in_hole(m) || m.kind != nc::MoveKind::rapid || !known.end) continue;
    const double t = next < stamps.size() ? stamps[next].t_s : stamps.empty() ? 0 : stamps.back().t_s;
    const auto timed = std::ranges::lower_bound(program.path.rapids, i, {}, &removal::RapidStart::move);
    const bool found = timed != program.path.rapids.end() && timed->move == i;
    out.push_back({i, found ? timed->t_s : t, next, known.start});
  }
  return out;
}

void add_collision(const motion::SimulatedProgram& program, const Collision& c, std::vector<Collision>& found) {
  const auto block = program.moves_in_part().moves[c.move].block;
  if (!found.empty() && program.moves_in_part().moves[found.back().move].block == block && found.back().part == c.part)
    return;
  found.push_back(c);
}

std::vector<Collision> find_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                                       const removal::Stock& blank) {
  const bool upright = removal::all_upright(program.path.stamps) && !program.turns();
  return upright ? find_upright_collisions(job, program, blank) : find_tilted_collisions(job, program, blank);
}

std::optional<Severity> collision_severity(const machine::Job& job, const motion::SimulatedProgram& program) {
  const auto kind = job.simulation.collisions.value_or(motion_left_out(program) ? machine::Collisions::warning
                                                                                : machine::Collisions::error);
  if (kind == machine::Collisions::off) return std::nullopt;
  return kind == machine::Collisions::error ? Severity::error : Severity::warning;
}

void report_collisions(const machine::Job& job, const motion::SimulatedProgram& program,
                       const std::vector<Collision>& found, Diagnostics& diagnostics) {
  const std::optional<Severity> severity = collision_severity(job, program);
  if (!severity) return;
  const machine::Operations operations = motion::as_lines(job.operations, program.text(), program.moves_in_part());
  std::vector<Collision> inside, outside;
  for (const Collision& c : found)
    (removal::in_operations(program.moves_in_part(), program.moves_in_part().moves[c.move], operations) ? inside
                                                                                                        : outside)
        .push_back(c);
  report_inside(program, inside, *severity, diagnostics);
  report_outside(program, outside, *severity, diagnostics);
}

void check_collisions(const machine::Job& job, const motion::SimulatedProgram& program, const removal::Stock& blank,
                      Diagnostics& diagnostics) {
  if (collision_severity(job, program))
    report_collisions(job, program, find_collisions(job, program, blank), diagnostics);
}

}  // namespace camber::checks
