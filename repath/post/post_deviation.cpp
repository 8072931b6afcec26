#include "repath/path_deviation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include <Eigen/Geometry>

#include "kinematics/program_joints.h"
#include "repath/post/tip_motion.h"

namespace camber::repath {
namespace {

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// A block that also changes the tool length starts somewhere else by the length in the coordinates that it has.
bool same_length(const nc::Interpretation& moves, std::size_t i) {
  return i == 0 || moves.state_of(moves.moves[i]).tool_length_mm == moves.state_of(moves.moves[i - 1]).tool_length_mm;
}

}  // namespace

PostDeviation post_deviation(const nc::Interpretation& before, const nc::Interpretation& after,
                             const machine::Machine& machine, const Posted& posted, int per_piece) {
  const machine::Machine free = without_travel(machine);
  kinematics::ProgramJoints given(free, before), made(free, after);
  std::unordered_map<std::uint32_t, std::size_t> move_of_line;
  for (std::size_t i = 0; i < after.moves.size(); ++i) move_of_line[after.moves[i].block] = i;
  PostDeviation out;
  std::size_t at = 0, made_moves = 0;
  while (!given.done()) {
    const bool known = given.next().start_known;
    const nc::Move& move = before.moves[given.index()];
    for (; at < posted.pieces.size() && posted.pieces[at].move == given.index(); ++at) {
      const PostedPiece& piece = posted.pieces[at];
      const auto found = move_of_line.find(piece.line);
      if (found == move_of_line.end()) continue;  // it moves nothing
      while (made_moves <= found->second) {
        made.next();
        ++made_moves;
      }
      const bool starts = known && same_length(after, found->second);
      for (int i = starts ? 0 : per_piece; i <= per_piece; ++i) {
        const double v = static_cast<double>(i) / per_piece, u = piece.from + v * (piece.to - piece.from);
        const auto want = given.pose_at(u), have = made.pose_at(v);
        if (!want || !have) continue;
        const double tip = (want->tip_mm - have->tip_mm).norm(), axis = angle_between(want->axis, have->axis);
        double& worst = move.kind == nc::MoveKind::rapid ? out.rapid_tip_mm : out.tip_mm;
        worst = std::max(worst, tip);
        out.axis_rad = std::max(out.axis_rad, axis);
        ++out.samples;
        if (u < 1) continue;
        out.end_tip_mm = std::max(out.end_tip_mm, tip);
        out.end_axis_rad = std::max(out.end_axis_rad, axis);
      }
    }
  }
  return out;
}

}  // namespace camber::repath
