#include "repath/post/post_motions.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/units.h"
#include "kinematics/feed_meaning.h"
#include "kinematics/program_joints.h"
#include "nc/emit/text_rules.h"
#include "nc/language.h"

namespace camber::repath {
namespace {

bool moves_linear_axes(const nc::Move& m) {
  return m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::rapid || m.kind == nc::MoveKind::arc;
}

class Collector {
 public:
  Collector(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
            PostTarget target, Diagnostics& diagnostics)
      : program_(program),
        moves_(moves),
        machine_(machine),
        target_(target),
        diagnostics_(diagnostics),
        free_machine_(without_travel(machine)),
        rules_(nc::language_of(program).text_rules(program)) {}

  PostMotions run() {
    choose();
    PostMotions out;
    out.of_move.assign(moves_.moves.size(), PostMotions::kKept);
    kinematics::ProgramJoints joints(free_machine_, moves_);
    Barrier barrier = Barrier::none;
    bool kept = true;
    while (!joints.done()) {
      const kinematics::MoveJoints now = joints.next();
      const std::size_t i = joints.index();
      const nc::Move& move = moves_.moves[i];
      if (move.reference && !now.linear_known && moves_.state_of(move).tool_length_mm)
        wanted_[i] = false;  // to a place that nobody knows
      if (wanted_[i]) {
        if (!may_be_rewritten(i)) continue;
        const auto motion = motion_of(joints, now, i);
        if (!motion) continue;
        kept = kept || (target_ == PostTarget::tcp && !same_tool(out.motions.back().move, i));
        out.of_move[i] = out.motions.size();
        out.motions.push_back(*motion);
        out.before.push_back(barrier);
        out.first_of_run.push_back(kept);
        barrier = Barrier::none;
        kept = false;
      } else if (move.kind != nc::MoveKind::dwell) {
        barrier = std::max(barrier, turned_by_words_[i] ? Barrier::programmed : Barrier::pose);
        kept = true;
      }
    }
    out.before.push_back(barrier);
    return out;
  }

 private:
  void say(const nc::Move& m, const char* check, std::string message) {
    diagnostics_.add(
        program_.source.diagnostic(Severity::error, program_.blocks[m.block].offset, std::move(message), check));
  }

  /// Moves to rewrite, and those whose rotary axes words turn.
  void choose() {
    const std::size_t n = moves_.moves.size();
    std::vector<bool> to_machine(n, false);
    wanted_.assign(n, false);
    turned_by_words_.assign(n, false);
    for (const nc::RotaryTarget& t : moves_.rotary) turned_by_words_[t.move] = true;
    for (const nc::MachineTarget& t : moves_.machine_targets) to_machine[t.move] = true;
    for (std::size_t i = 0; i < n; ++i) {
      const nc::Move& m = moves_.moves[i];
      const nc::ModalState& state = moves_.state_of(m);
      const bool tip_control = state.tip_control != nc::TipControl::off;
      const bool plain = moves_linear_axes(m) && !to_machine[i] && !rules_->goes_to_machine_place(m.block);
      if (target_ == PostTarget::joints)
        wanted_[i] = plain && tip_control;
      else
        wanted_[i] = plain && !tip_control && state.work_frame == nc::WorkFrame::machine && !m.canned && !m.creeps;
    }
    if (target_ == PostTarget::tcp) drop_upright_ends();
  }

  bool same_tool(std::size_t a, std::size_t b) const {
    const nc::ModalState &x = moves_.state_of(moves_.moves[a]), &y = moves_.state_of(moves_.moves[b]);
    return x.tool == y.tool && x.tool_length_mm == y.tool_length_mm;
  }

  /// Keeps, of consecutive candidates with one tool, those from the first to the last with turned axes.
  void drop_upright_ends() {
    std::vector<bool> turned(moves_.moves.size(), false);
    kinematics::ProgramJoints joints(free_machine_, moves_);
    while (!joints.done()) {
      const kinematics::MoveJoints& now = joints.next();
      turned[joints.index()] = !now.start_rad.isZero(0) || !now.end_rad.isZero(0);
    }
    for (std::size_t i = 0; i < wanted_.size();) {
      if (!wanted_[i]) {
        ++i;
        continue;
      }
      std::size_t end = i, first = wanted_.size(), last = 0;
      for (std::size_t k = i; k < wanted_.size(); ++k) {
        if (moves_.moves[k].kind == nc::MoveKind::dwell) continue;
        if (!wanted_[k] || !same_tool(i, k)) break;
        end = k;
        if (!turned[k]) continue;
        first = std::min(first, k);
        last = k;
      }
      for (std::size_t k = i; k <= end; ++k)
        if (k < first || k > last) wanted_[k] = false;
      i = end + 1;
    }
  }

  bool may_be_rewritten(std::size_t i) {
    const nc::Move& m = moves_.moves[i];
    const bool alone = (i == 0 || moves_.moves[i - 1].block != m.block) &&
                       (i + 1 == moves_.moves.size() || moves_.moves[i + 1].block != m.block);
    if (m.editable && alone) return true;
    if (!said_editable_)
      say(m, "not-editable",
          "this move is made by a loop, a subprogram that is called more than once, an expression or a cycle, so that "
          "its coordinates cannot be rewritten; a block with numbers of its own was expected");
    said_editable_ = true;
    return false;
  }

  std::optional<TipMotion> motion_of(const kinematics::ProgramJoints& joints, const kinematics::MoveJoints& now,
                                     std::size_t i) {
    const nc::Move& m = moves_.moves[i];
    const nc::ModalState& state = moves_.state_of(m);
    if (!state.tool_length_mm || !now.linear_known) {
      if (!said_unknown_)
        say(m, state.tool_length_mm ? "tool-direction" : "tool-length",
            state.tool_length_mm ? "the joints of this move are not known; a place and a direction within reach of the "
                                   "axes were expected"
                                 : "the tool length of this move is not known; --tool-length or G10 L1 was expected");
      said_unknown_ = true;
      return std::nullopt;
    }
    const Vec3& origin = *moves_.machine_origin_mm;
    const kinematics::Chain& chain = joints.chain();
    TipMotion out;
    out.move = static_cast<std::uint32_t>(i);
    out.follows_tip = target_ == PostTarget::joints;
    out.start_rad = now.start_rad;
    out.end_rad = now.end_rad;
    out.tool_length_mm = *state.tool_length_mm;
    out.rapid = m.kind == nc::MoveKind::rapid;
    out.arc = m.arc != nc::Move::kNoArc;
    out.start_known = now.start_known;
    out.end_linear_mm = joints.at(1).linear_mm;
    out.start_linear_mm = now.start_known ? joints.at(0).linear_mm : out.end_linear_mm;
    if (out.follows_tip && !out.arc) {
      out.end_tip_mm = *joints.end_mm() - origin;
      out.start_tip_mm = now.start_known ? Vec3(*joints.start_mm() - origin) : out.end_tip_mm;
    } else {
      out.end_tip_mm = chain.pose(joints.at(1), out.tool_length_mm).tip_mm;
      out.start_tip_mm = chain.pose({out.start_linear_mm, out.start_rad}, out.tool_length_mm).tip_mm;
    }
    if (!out.rapid) out.time_s = time_of(m, now);
    return out;
  }

  double time_of(const nc::Move& m, const kinematics::MoveJoints& now) const {
    return kinematics::programmed_time_s(moves_, m, now.end_rad - now.start_rad, now.g93_time_s, machine_.control)
        .value_or(0);
  }

  const nc::Program& program_;
  const nc::Interpretation& moves_;
  const machine::Machine& machine_;
  PostTarget target_;
  Diagnostics& diagnostics_;
  machine::Machine free_machine_;
  std::unique_ptr<nc::TextRules> rules_;
  std::vector<bool> wanted_, turned_by_words_;
  bool said_editable_ = false, said_unknown_ = false;
};

}  // namespace

PostMotions post_motions(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                         PostTarget target, Diagnostics& diagnostics) {
  return Collector(program, moves, machine, target, diagnostics).run();
}

}  // namespace camber::repath
