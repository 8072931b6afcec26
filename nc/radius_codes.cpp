// G40, G41, G42: which radius holds, and when the path under it is computed.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "nc/block_interpreter.h"
#include "nc/cutter_radius.h"

namespace camber::nc {

/// D, which holds from then on, or in its block alone.
void BlockInterpreter::read_radius_number() {
  const bool modal = options_.dialect_or_default().d_is_modal;
  if (!modal) radius_number_ = -1;
  if (!words_.has('D')) return;
  const auto is_code = [&](std::initializer_list<int> tenths) {
    return std::ranges::any_of(words_.g(), [&](const Code& c) { return std::ranges::count(tenths, c.tenths) > 0; });
  };
  const bool starts = is_code({410, 420});
  if (is_code({411, 421}) || (!modal && !starts)) return;  // a diameter; a word that nothing uses
  const double d = words_.value('D');
  if (d != std::floor(d) || d < 0 || d > 1e6) {
    radius_number_ = -1;
    error(words_.offset_of('D'), "cutter-radius",
          fmt::format("D{} is not an offset number; a whole number of zero or more was expected", d));
    return;
  }
  const int before = std::exchange(radius_number_, static_cast<int>(d));
  if (!radius_.active || starts || before == radius_number_ || is_code({400})) return;
  const auto found = tool_offsets_.find(radius_number_);
  const auto radius_mm = found == tool_offsets_.end() ? std::nullopt : found->second.effective_radius_mm();
  if (radius_mm.value_or(0) != radius_.radius_mm)
    error(words_.offset_of('D'), "cutter-radius",
          fmt::format("D{} is another radius while G{} is active; G40 was expected before", d, radius_.g_tenths / 10));
}

void BlockInterpreter::read_radius_code(const Code& code) {
  if (code.tenths == 400) {
    end_radius();
    return;
  }
  const bool by_value = code.tenths % 10 != 0;
  if (by_value && !options_.dialect_or_default().g41_1_has_diameter) {
    error(code.word->offset, "not-read", fmt::format("{} (normal direction control) is not supported", code_text(code)),
          code_text(code));
    words_.use("D");
    return;
  }
  const auto radius_mm = radius_of(code);
  if (!radius_mm) return;
  const bool same_side = radius_.g_tenths / 10 == code.tenths / 10;
  if (radius_.active && (radius_.radius_mm != 0 || *radius_mm != 0)) {
    if (!same_side || radius_.radius_mm != *radius_mm)
      error(code.word->offset, "cutter-radius",
            fmt::format("{} while G{} is active; G40 was expected before", code_text(code), radius_.g_tenths / 10));
    return;
  }
  radius_ = {true, code.tenths, *radius_mm, out_.moves.size(), code.word->offset};
  state_.cutter_radius = *radius_mm != 0;
  if (*radius_mm == 0 || not_editable_told_) return;
  not_editable_told_ = true;
  report_.warning(
      code.word->offset, "not-editable",
      fmt::format(
          "the path under {} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
          code_text(code), std::abs(*radius_mm)));
}

/// The radius for D, or for the tool in the spindle where no D was given; zero, with a warning, where none is known.
std::optional<double> BlockInterpreter::radius_of(const Code& code) {
  if (code.tenths % 10 != 0) {
    if (!words_.has('D')) {
      error(code.word->offset, "cutter-radius", fmt::format("{} has no diameter; D was expected", code_text(code)));
      return std::nullopt;
    }
    return 0.5 * words_.value('D') * unit_mm();
  }
  if (words_.has('D') && radius_number_ < 0) return std::nullopt;  // no number: said in read_radius_number
  const int number = radius_number_ >= 0 ? radius_number_ : state_.tool;
  if (number == 0 && radius_number_ >= 0) return 0.0;
  const auto found = tool_offsets_.find(number);
  if (found != tool_offsets_.end())
    if (const auto radius_mm = found->second.effective_radius_mm()) return radius_mm;
  report_.warning(
      code.word->offset, "radius-unknown",
      fmt::format(
          "no radius is given for D{}; {} takes 0, as in a program of the cutter centre, where D has the wear only",
          number, code_text(code)),
      fmt::format("D{}", number));
  return 0.0;
}

/// Checks what a block must not do while the path is being computed.
void BlockInterpreter::check_radius_block() {
  if (radius_.radius_mm == 0) return;
  const char* what = nullptr;
  if (request_.machine_frame) what = "G53";
  if (request_.reference) what = request_.reference_word->value == 30 ? "G30" : "G28";
  if (request_.return_from_reference) what = "G29";
  if (cycle_.g != 0) what = "a drilling cycle";
  if (!what) return;
  error(words_.offset(), "cutter-radius",
        fmt::format("{} under G{}; G40 with a straight move off the contour was expected before", what,
                    radius_.g_tenths / 10));
  end_radius();
}

void BlockInterpreter::end_radius() {
  if (!radius_.active) return;
  const Radius radius = radius_;
  radius_ = {};
  state_.cutter_radius = false;
  state_changed_ = true;
  if (radius.radius_mm == 0 || radius.first_move >= out_.moves.size()) return;

  const PlaneAxes axes = axes_of(plane_);
  const Vec3 a = frame_.linear.col(axes.first), b = frame_.linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12) {
    report_.error(radius.offset, "cutter-radius",
                  fmt::format("G{} in a plane that G68 or G68.2 has rotated out of the machine axes is not supported",
                              radius.g_tenths / 10));
    return;
  }
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = (radius.g_tenths / 10 == 41) == (facing > 0);  // a mirror image turns the side over
  cutter.plane = plane_;
  cutter.corner_lines = options_.dialect_or_default().radius_corner_lines;
  cutter.entry_square_to_next = options_.dialect_or_default().radius_entry_square;
  cutter.moves_without_plane_motion = options_.dialect_or_default().radius_look_ahead;
  cutter.name = fmt::format("G{}", radius.g_tenths / 10);
  const CutterRadiusResult result = compensate_radius(out_, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    report_.error(program_ == main_ ? main_->offset_of(problem.block) : words_.offset(), "cutter-radius",
                  problem.message);
  beside_mm_ = result.end_mm - position_mm_;
  leaving_ = result.problems.empty() && beside_mm_ != Vec3::Zero();
}

/// The first move after G40 starts beside the contour.
void BlockInterpreter::leave_contour(Move& move) {
  move.start_mm += beside_mm_;
  move.editable = false;
  const PlaneAxes axes = axes_of(plane_);
  constexpr char kLetters[] = "XYZ";
  const bool in_plane = words_.has(kLetters[axes.first]) || words_.has(kLetters[axes.second]);
  if (move.kind == MoveKind::dwell || (options_.dialect_or_default().radius_exit_waits && !in_plane))
    move.end_mm += beside_mm_;
  else
    leaving_ = false;
}

}  // namespace camber::nc
