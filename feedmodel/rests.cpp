#include "feedmodel/rests.h"

namespace camber::feedmodel {

using nc::EventKind;

std::vector<std::uint32_t> rests_of(const nc::Interpretation& program, const machine::Cycle& cycle) {
  std::vector<std::uint32_t> rests;
  for (const nc::Event& event : program.events) {
    const bool quick = (event.kind == EventKind::tool_select && cycle.t_code_s == 0) ||
                       (event.kind == EventKind::spindle_speed && cycle.s_code_s == 0) ||
                       (event.kind == EventKind::m_code && cycle.m_code_s == 0);
    if (!quick && (rests.empty() || rests.back() != event.before_move)) rests.push_back(event.before_move);
  }
  return rests;
}

}  // namespace camber::feedmodel
