#pragma once
// Small interpreted programs for tests of what stands on nc: moves are added one by one.
#include "base/units.h"
#include "nc/move.h"

namespace camber::tests {

class TestProgram {
 public:
  TestProgram() { program.states.push_back({}); }

  TestProgram& line(double x, double y, double z, double feed_mm_per_min) {
    add({x, y, z}, nc::MoveKind::linear).feed_mm_per_s = mm_per_s_from_mm_per_min(feed_mm_per_min);
    return *this;
  }
  TestProgram& rapid(double x, double y, double z) {
    add({x, y, z}, nc::MoveKind::rapid);
    return *this;
  }
  TestProgram& arc_xy(double x, double y, double center_x, double center_y, double sweep_rad, double feed_mm_per_min) {
    nc::Move& move = add({x, y, at_.z()}, nc::MoveKind::arc);
    move.feed_mm_per_s = mm_per_s_from_mm_per_min(feed_mm_per_min);
    move.arc = static_cast<std::uint32_t>(program.arcs.size());
    program.arcs.push_back({{center_x, center_y, at_.z()}, Vec3::UnitZ(), sweep_rad});
    return *this;
  }
  TestProgram& dwell(double seconds) {
    add(at_, nc::MoveKind::dwell).dwell_s = seconds;
    return *this;
  }
  /// Holds for the moves to come.
  nc::ModalState& new_state() {
    const nc::ModalState last = program.states.back();
    program.states.push_back(last);
    return program.states.back();
  }

  nc::Interpretation program;

 private:
  nc::Move& add(const Vec3& end, nc::MoveKind kind) {
    nc::Move move;
    move.start_mm = at_;
    move.end_mm = at_ = end;
    move.kind = kind;
    move.block = static_cast<std::uint32_t>(program.moves.size());
    move.state = static_cast<std::uint32_t>(program.states.size() - 1);
    program.moves.push_back(move);
    return program.moves.back();
  }
  Vec3 at_ = Vec3::Zero();
};

}  // namespace camber::tests
