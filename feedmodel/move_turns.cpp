#include "feedmodel/move_turns.h"

#include <algorithm>

namespace camber::feedmodel {

MoveTurns::MoveTurns(const nc::Interpretation& program, const machine::Machine& machine)
    : program_(program), machine_(machine), joints_(machine, program), map_(machine, program) {}

const kinematics::MoveJoints& MoveTurns::at(std::size_t move) {
  while (!joints_.done() && (joints_.index() + 1 == 0 || joints_.index() < move)) now_ = joints_.next();
  return now_;
}

std::size_t MoveTurns::next_turning(std::size_t move, std::size_t end) const {
  const auto first = std::ranges::lower_bound(program_.rotary, move, {},
                                              [](const nc::RotaryTarget& t) { return std::size_t{t.move}; });
  return first == program_.rotary.end() ? end : std::min<std::size_t>(end, first->move);
}

Turn MoveTurns::base() const {
  const nc::Move& move = program_.moves[joints_.index()];
  const nc::ModalState& state = program_.state_of(move);
  Turn turn;
  turn.start_rad = now_.start_rad;
  turn.tip_control = state.tip_control != nc::TipControl::off;
  turn.tool_length_mm = state.tool_length_mm.value_or(0);
  turn.feed = kinematics::feed_meaning(program_, move, now_.end_rad - now_.start_rad, machine_.control);
  return turn;
}

std::shared_ptr<const Turn> MoveTurns::turn_along(double length) const {
  Turn turn = base();
  if (length > 0) turn.rate = (now_.end_rad - now_.start_rad) / length;
  return std::make_shared<const Turn>(turn);
}

std::shared_ptr<const Turn> MoveTurns::rest(bool at_end) const {
  Turn turn = base();
  if (at_end) turn.start_rad = now_.end_rad;
  return std::make_shared<const Turn>(turn);
}

}  // namespace camber::feedmodel
