// G40, G41, G42 with OFFN.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "nc/cutter_radius.h"
#include "nc/siemens/block_runner.h"

namespace camber::nc::siemens {

void BlockRunner::read_radius_code(const CodeWord& code) {
  std::optional<double> radius_mm;
  if (edge_ == 0) {
    radius_mm = 0;
  } else if (const auto found = tool_offsets_.find(state_.tool); found != tool_offsets_.end()) {
    radius_mm = found->second.effective_radius_mm();
  }
  if (!radius_mm) {
    report_.warning(code.offset, "radius-unknown",
                    fmt::format("no radius is given for tool {}; G{} takes 0, as in a program of the cutter centre",
                                state_.tool, code.number),
                    fmt::format("T{}", state_.tool));
    radius_mm = 0;
  }
  *radius_mm += offset_normal_mm_;
  if (radius_.active && (radius_.radius_mm != 0 || *radius_mm != 0)) {
    if (radius_.g != code.number || radius_.radius_mm != *radius_mm)
      error(code.offset, "cutter-radius",
            fmt::format("G{} while G{} is active; G40 was expected before", code.number, radius_.g));
    return;
  }
  radius_ = {true, code.number, *radius_mm, out_.moves.size(), code.offset};
  state_.cutter_radius = *radius_mm != 0;
  change_state();
  if (*radius_mm == 0 || not_editable_told_) return;
  not_editable_told_ = true;
  report_.warning(
      code.offset, "not-editable",
      fmt::format(
          "the path under G{} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
          code.number, std::abs(*radius_mm)));
}

void BlockRunner::end_radius() {
  if (!radius_.active) return;
  const Radius radius = radius_;
  radius_ = {};
  state_.cutter_radius = false;
  change_state();
  if (radius.radius_mm == 0 || radius.first_move >= out_.moves.size()) return;
  const PlaneAxes axes = axes_of(plane_);
  const Vec3 a = frame_.linear.col(axes.first), b = frame_.linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12) {
    report_.error(radius.offset, "cutter-radius",
                  fmt::format("G{} in a plane that ROT or CYCLE800 has turned out of the machine axes is not supported",
                              radius.g));
    return;
  }
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = (radius.g == 41) == (facing > 0);
  cutter.plane = plane_;
  cutter.corner_lines = false;         // G450
  cutter.entry_square_to_next = true;  // NORM
  cutter.moves_without_plane_motion = 3;
  cutter.name = fmt::format("G{}", radius.g);
  const CutterRadiusResult result = compensate_radius(out_, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    report_.error(program_ == main_ ? main_->offset_of(problem.block) : words_.offset(), "cutter-radius",
                  problem.message);
  beside_mm_ = result.end_mm - position_mm_;
  leaving_ = result.problems.empty() && beside_mm_ != Vec3::Zero();
}

/// The first move in the plane after G40 starts beside the contour and ends on it.
void BlockRunner::leave_contour(Move& move) {
  move.start_mm += beside_mm_;
  move.editable = false;
  const PlaneAxes axes = axes_of(plane_);
  constexpr char kLetters[] = "XYZ";
  const bool in_plane = words_.has(kLetters[axes.first]) || words_.has(kLetters[axes.second]);
  if (move.kind == MoveKind::dwell || !in_plane)
    move.end_mm += beside_mm_;
  else
    leaving_ = false;
}

}  // namespace camber::nc::siemens
