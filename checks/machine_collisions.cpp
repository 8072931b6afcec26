#include "checks/machine_collisions.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "base/stage.h"
#include "checks/machine_solids.h"
#include "kinematics/joint_map.h"

namespace camber::checks {
namespace {

using Eigen::Isometry3d;
using kinematics::Joints;

constexpr double kStep_mm = 0.1;

/// A box that holds a solid: no point of the solid moves farther than a corner of it.
struct Extent {
  Vec3 min_mm, max_mm;

  double displacement_mm(const Isometry3d& from, const Isometry3d& to) const {
    const Mat3 change = to.linear() - from.linear();
    const Vec3 way = to.translation() - from.translation();
    double most = 0;
    for (int c = 0; c < 8; ++c) {
      const Vec3 p((c & 1 ? max_mm : min_mm).x(), (c & 2 ? max_mm : min_mm).y(), (c & 4 ? max_mm : min_mm).z());
      most = std::max(most, (way + change * p).squaredNorm());
    }
    return std::sqrt(most);
  }
};

struct ToolSolids {
  std::vector<TurnedSolid> pieces;
  Extent extent;
};

ToolSolids tool_solids(const machine::Tool& tool) {
  ToolSolids out{solids_of(tool), {}};
  double radius = 0, bottom = 0, top = 0;
  for (const TurnedSolid& piece : out.pieces) {
    radius = std::max(radius, piece.radius_mm());
    bottom = std::min(bottom, piece.bottom_mm());
    top = std::max(top, piece.top_mm());
  }
  out.extent = {{-radius, -radius, bottom}, {radius, radius, top}};
  return out;
}

/// Two solids of the machine, and how far the search for their contact has come.
struct Pair {
  std::size_t body = 0;
  std::optional<std::size_t> mover{};  ///< another body; none: the tool
  double clear_mm = 0;                 ///< the one has this way to go against the other before they can touch
  bool inside = false;                 ///< they overlap
};

/// A place of the machine.
struct Place {
  Joints joints;
  std::vector<Isometry3d> placements;
};

class Search {
 public:
  Search(const machine::Job& job, const nc::Interpretation& moves, const Vec3& origin_mm)
      : job_(job),
        chain_(chain_of(job.machine)),
        origin_mm_(origin_mm),
        stage_("checking for collisions with the machine", moves.moves.size()) {
    for (const machine::Body& body : job.machine.bodies) solids_.emplace_back(body);
    const auto& bodies = job.machine.bodies;
    const std::size_t spindle = chain_.placements({}).size() - 1;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i].axes < spindle) pairs_.push_back({i});
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (std::size_t j = 0; j < bodies.size(); ++j)
        if (bodies[j].axes >= bodies[i].axes + 2) pairs_.push_back({i, j});
  }

  void pass(const MachineMove& move, std::span<const Joints> places) {
    stage_.advance();
    move_ = move;
    tool_ = &tools_.try_emplace(move.tool, tool_solids(job_.tools.at(move.tool))).first->second;
    tool_at_zero_ = chain_.tool_at_zero(move.tool_length_mm);
    const bool goes_on = move.goes_on && at_ && same(at_->joints, places.front());
    if (!goes_on) jump(places.front());
    for (const Joints& joints : places.subspan(1)) go(joints);
  }

  std::vector<MachineCollision> take() { return std::move(found_); }

 private:
  static bool same(const Joints& a, const Joints& b) {
    constexpr double kRounding = 1e-6;
    return (a.linear_mm - b.linear_mm).norm() < kRounding && (a.rotary_rad - b.rotary_rad).norm() < kRounding;
  }

  Place place_of(const Joints& joints) const { return {joints, chain_.placements(joints)}; }

  Extent extent_of(const Pair& pair) const {
    return pair.mover ? Extent{solids_[*pair.mover].min_mm(), solids_[*pair.mover].max_mm()} : tool_->extent;
  }

  /// From the mover's frame to the body's, both of them as they are with all axes at 0.
  Isometry3d motion(const Pair& pair, const Place& place) const {
    const auto& bodies = job_.machine.bodies;
    const Isometry3d body = place.placements[bodies[pair.body].axes];
    return body.inverse() *
           (pair.mover ? place.placements[bodies[*pair.mover].axes] : place.placements.back() * tool_at_zero_);
  }

  /// The axes are here, and nobody knows from where.
  void jump(const Joints& joints) {
    at_ = place_of(joints);
    for (Pair& pair : pairs_) {
      pair.inside = false;
      look(pair, *at_);
      if (!pair.inside && holds(pair, motion(pair, *at_))) meet(pair, *at_, 0);
    }
  }

  /// A mesh has no inside for look(): the one may be in the other from the start.
  bool holds(const Pair& pair, const Isometry3d& body_from_mover) const {
    const BodySolid& body = solids_[pair.body];
    if (!pair.mover) return body.mesh_holds(body_from_mover * Vec3(0, 0, tool_->pieces.front().top_mm()));
    const BodySolid& mover = solids_[*pair.mover];
    return body.mesh_holds(body_from_mover * mover.hull(0).front()) ||
           mover.mesh_holds(body_from_mover.inverse() * body.hull(0).front());
  }

  void go(const Joints& joints) {
    Place to = place_of(joints);
    for (Pair& pair : pairs_) go(pair, *at_, to);
    at_ = std::move(to);
  }

  void go(Pair& pair, const Place& from, const Place& to) {
    // Of turns by fractions of a degree the chord is as long as the arc, to 1e-6.
    const double way = 1.00001 * extent_of(pair).displacement_mm(motion(pair, from), motion(pair, to));
    if (way < pair.clear_mm) {
      pair.clear_mm -= way;
      return;
    }
    double u = 0;
    for (double step = std::max(pair.clear_mm, kStep_mm); u < 1; step = std::max(pair.clear_mm, kStep_mm)) {
      const double next = way > 0 ? u + step / way : 1;
      if (next > 1 && pair.clear_mm > (1 - u) * way) {
        pair.clear_mm -= (1 - u) * way;
        return;
      }
      u = std::min(next, 1.0);
      look(pair, u < 1 ? between(from.joints, to.joints, u) : to);
    }
  }

  Place between(const Joints& a, const Joints& b, double u) const {
    return place_of({a.linear_mm + u * (b.linear_mm - a.linear_mm), a.rotary_rad + u * (b.rotary_rad - a.rotary_rad)});
  }

  void look(Pair& pair, const Place& place) {
    const Isometry3d body_from_mover = motion(pair, place);
    const BodySolid& body = solids_[pair.body];
    const SolidDistance found = pair.mover ? SolidDistance{distance_mm(body, body_from_mover, solids_[*pair.mover])}
                                           : distance(tool_->pieces, body_from_mover, body);
    pair.clear_mm = found.at_least_mm;
    if (found.at_least_mm > 0)
      pair.inside = false;
    else
      meet(pair, place, found.piece);
  }

  void meet(Pair& pair, const Place& place, std::size_t piece) {
    pair.clear_mm = 0;
    if (pair.inside) return;
    pair.inside = true;
    found_.push_back({move_.move, pair.body, pair.mover, tool_->pieces[piece].part(), move_.tool,
                      chain_.pose(place.joints, move_.tool_length_mm).tip_mm + origin_mm_});
  }

  const machine::Job& job_;
  kinematics::Chain chain_;
  Vec3 origin_mm_;
  Stage stage_;
  std::vector<BodySolid> solids_;
  std::vector<Pair> pairs_;
  std::map<int, ToolSolids> tools_;
  const ToolSolids* tool_ = nullptr;
  Isometry3d tool_at_zero_;
  MachineMove move_;
  std::optional<Place> at_;
  std::vector<MachineCollision> found_;
};

const char* name(OutlineRing::Part part) {
  if (part == OutlineRing::Part::cutter) return "cutter";
  return part == OutlineRing::Part::shank ? "shank" : "holder";
}

/// `the holder of T1 meets the body "vice" where the tip is at X1.00 Y2.00 Z3.00`.
std::string deed(const machine::Machine& machine, const MachineCollision& c) {
  const std::string what = c.other_body ? fmt::format("the body \"{}\"", machine.bodies[*c.other_body].name)
                                        : fmt::format("the {} of T{}", name(c.part), c.tool);
  return fmt::format("{} meets the body \"{}\" where the tip of T{} is at X{:.2f} Y{:.2f} Z{:.2f}", what,
                     machine.bodies[c.body].name, c.tool, c.tip_mm.x(), c.tip_mm.y(), c.tip_mm.z());
}

}  // namespace

std::optional<Vec3> origin_of_machine(const machine::Job& job, const nc::Interpretation& moves) {
  if (moves.machine_origin_mm) return moves.machine_origin_mm;
  const auto& offset = job.compensation.work_offset_mm;
  if (!offset || kinematics::has_rotary_motion(moves, job.machine)) return std::nullopt;
  return Vec3(-*offset);
}

std::vector<MachineCollision> find_machine_collisions(const machine::Job& job, const nc::Program& text,
                                                      const nc::Interpretation& moves) {
  if (job.machine.bodies.empty()) return {};
  const Vec3 origin_mm = origin_of_machine(job, moves).value();
  Search search(job, moves, origin_mm);
  for_each_machine_move(job, text, moves, origin_mm,
                        [&](const MachineMove& move, std::span<const Joints> places) { search.pass(move, places); });
  return search.take();
}

void check_machine_collisions(const machine::Job& job, const nc::Program& text, const nc::Interpretation& moves,
                              Diagnostics& diagnostics) {
  const auto kind = job.simulation.collisions.value_or(machine::Collisions::error);
  if (kind == machine::Collisions::off || job.machine.bodies.empty()) return;
  const auto severity = kind == machine::Collisions::error ? Severity::error : Severity::warning;
  if (!origin_of_machine(job, moves)) {
    diagnostics.add({severity,
                     {text.source.name(), 0, 0},
                     "where the bodies of the machine ([[body]]) are depends on the work offset, which is not known; "
                     "its value, G10 L2 in the program or without rotary axes [compensation] work_offset_mm in the "
                     "job, was expected",
                     "work-offset",
                     {}});
    return;
  }
  constexpr std::size_t kMax = 10;
  const auto found = find_machine_collisions(job, text, moves);
  for (std::size_t i = 0; i < std::min(found.size(), kMax); ++i) {
    const std::string more = i + 1 == kMax && found.size() > kMax ? fmt::format(" ({} more)", found.size() - kMax) : "";
    diagnostics.add(text.source.diagnostic(
        severity, text.blocks[moves.moves[found[i].move].block].offset,
        fmt::format("{}{}; a path or a set-up that clears it was expected", deed(job.machine, found[i]), more),
        "collision-table"));
  }
}

}  // namespace camber::checks
