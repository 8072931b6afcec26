#include "adapt/feed_cells.h"

#include <algorithm>
#include <cmath>

#include "kinematics/feed_meaning.h"

namespace camber::adapt {
namespace {

constexpr double kSameFeed = 1e-9;  // relative
constexpr double kUpright = 1e-6;   // mm, of a move along the tool's axis
constexpr double kProbe = 0.7;      // of the programmed feed, an edit that is tried

bool cuts(const nc::Move& m) {
  return (m.kind == nc::MoveKind::linear || m.kind == nc::MoveKind::arc) && m.feed_mm_per_s > 0;
}

/// Along the axis of the tool.
bool plunges(const simulate::SimulatedProgram& program, std::uint32_t m) {
  const nc::Move& move = program.moves_in_part().moves[m];
  if (move.kind != nc::MoveKind::linear) return false;
  const Vec3 way = move.end_mm - move.start_mm, axis = program.pose_at(m, 1).axis;
  return (way - way.dot(axis) * axis).norm() < kUpright;
}

/// Edits of feed and of a split that the emitter refuses. A move in which rotary axes turn is not split.
std::vector<nc::EditNotMade> refused(const simulate::SimulatedProgram& program) {
  std::vector<nc::MoveEdit> probes;
  const std::vector<bool> turning = kinematics::turning_moves(program);
  for (std::uint32_t m = 0; m < program.moves_in_part().moves.size(); ++m) {
    const nc::Move& move = program.moves_in_part().moves[m];
    if (!cuts(move) || !program.selected[m] || plunges(program, m)) continue;
    const double feed = kProbe * program.moves_in_program().moves[m].feed_mm_per_s;
    nc::MoveEdit probe{.move = m, .via = {}, .end_mm = {}, .center_mm = {}, .feed_mm_per_s = feed};
    if (turning.empty() || !turning[m])
      probe.via = {
          {.point_mm = nc::point_at(program.moves_in_part(), move, 0.5), .center_mm = {}, .feed_mm_per_s = {}}};
    probes.push_back(std::move(probe));
  }
  return nc::emit_edits(program.text(), program.moves_in_program(),
                        kinematics::edits_of_text(program, std::move(probes)), {})
      .not_made;
}

}  // namespace

FeedCells::FeedCells(const simulate::SimulatedProgram& program, const machine::Machine& machine,
                     std::span<const double> length_mm)
    : tip_feed_mm_per_s_(kinematics::tip_feeds_mm_per_s(program, machine)), not_editable_(refused(program)) {
  const auto& moves = program.moves_in_part().moves;
  std::vector<bool> fixed(moves.size(), false);
  for (const nc::EditNotMade& n : not_editable_) fixed[n.move] = true;
  bool breaks = true;
  for (std::uint32_t m = 0; m < moves.size(); ++m) {
    first_of_move_.push_back(cells_.size());
    if (!cuts(moves[m])) {
      breaks = true;
      continue;
    }
    const bool hole = program.holes[m] != removal::HoleMove::none || moves[m].canned;
    const Kept kept = hole || plunges(program, m) ? Kept::plunge
                      : !program.selected[m]      ? Kept::unknown_load
                      : fixed[m]                  ? Kept::not_editable
                                                  : Kept::no;
    const std::size_t first = cells_.size();
    add(program, m, length_mm[m], kept);
    if (cells_.size() == first) continue;
    cells_[first].first = breaks;
    breaks = false;
  }
  first_of_move_.push_back(cells_.size());
  double along = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].first) {
      along = 0;
      if (!chains_.empty()) chains_.back().second = i;
      chains_.emplace_back(i, cells_.size());
    }
    cells_[i].along_mm = along += cells_[i].length_mm;
  }
}

void FeedCells::add(const simulate::SimulatedProgram& program, std::uint32_t m, double length_mm, Kept kept) {
  const nc::Move& move = program.moves_in_part().moves[m];
  const double length = nc::length_mm(program.moves_in_part(), move);
  if (length <= 0) return;
  const auto count =
      kept == Kept::no ? static_cast<std::size_t>(std::max(1.0, std::ceil(length / length_mm - 1e-9))) : std::size_t{1};
  const auto all = static_cast<double>(count);
  for (std::size_t i = 0; i < count; ++i)
    cells_.push_back({.move = m,
                      .from = static_cast<double>(i) / all,
                      .to = static_cast<double>(i + 1) / all,
                      .length_mm = length / all,
                      .feed_mm_per_s = tip_feed_mm_per_s_[m],
                      .kept = kept});
}

std::size_t FeedCells::find(std::uint32_t move, double fraction) const {
  const std::size_t first = first_of_move_[move], count = first_of_move_[move + 1] - first;
  if (count == 0) return kNone;
  const double at = std::floor(fraction * static_cast<double>(count));
  return first + std::min(count - 1, static_cast<std::size_t>(std::max(0.0, at)));
}

std::vector<nc::MoveEdit> FeedCells::edits(const simulate::SimulatedProgram& program,
                                           std::span<const double> feed) const {
  const nc::Interpretation& moves = program.moves_in_part();
  std::vector<nc::MoveEdit> out;
  for (std::size_t i = 0; i < cells_.size();) {
    const std::uint32_t m = cells_[i].move;
    const double as_programmed = program.moves_in_program().moves[m].feed_mm_per_s, of_tip = tip_feed_mm_per_s_[m],
                 in_text = of_tip > 0 ? as_programmed / of_tip : 1;
    std::size_t end = i;
    bool changed = false;
    nc::MoveEdit edit{.move = m, .via = {}, .end_mm = {}, .center_mm = {}, .feed_mm_per_s = {}};
    for (; end < cells_.size() && cells_[end].move == m; ++end) {
      changed = changed || std::abs(feed[end] - cells_[end].feed_mm_per_s) > kSameFeed * feed[end];
      if (end > i && std::abs(feed[end] - feed[end - 1]) > kSameFeed * feed[end])
        edit.via.push_back({.point_mm = nc::point_at(moves, moves.moves[m], cells_[end].from),
                            .center_mm = {},
                            .feed_mm_per_s = in_text * feed[end - 1]});
    }
    edit.feed_mm_per_s = in_text * feed[end - 1];
    if (changed && cells_[i].kept == Kept::no) out.push_back(std::move(edit));
    i = end;
  }
  return kinematics::edits_of_text(program, std::move(out));
}

}  // namespace camber::adapt
