#include "nc/radius_codes.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "nc/cutter_radius.h"

namespace camber::nc {

/// D, which holds from then on, or in its block alone.
void RadiusCodes::read_radius_number() {
  const bool modal = at_.dialect().d_is_modal;
  if (!modal) radius_number_ = -1;
  if (!at_.words.has('D')) return;
  const auto is_code = [&](std::initializer_list<int> tenths) {
    return std::ranges::any_of(at_.words.g(), [&](const Code& c) { return std::ranges::count(tenths, c.tenths) > 0; });
  };
  const bool starts = is_code({410, 420});
  if (is_code({411, 421}) || (!modal && !starts)) return;  // a diameter; a word that nothing uses
  const double d = at_.words.value('D');
  if (d != std::floor(d) || d < 0 || d > 1e6) {
    radius_number_ = -1;
    at_.error(at_.words.offset_of('D'), "cutter-radius",
              fmt::format("D{} is not an offset number; a whole number of zero or more was expected", d));
    return;
  }
  const int before = std::exchange(radius_number_, static_cast<int>(d));
  if (!radius_.active || starts || before == radius_number_ || is_code({400})) return;
  const ToolOffset* found = frames_.tool_offset(radius_number_);
  const auto radius_mm = !found ? std::nullopt : found->effective_radius_mm();
  if (radius_mm.value_or(0) != radius_.radius_mm)
    at_.error(
        at_.words.offset_of('D'), "cutter-radius",
        fmt::format("D{} is another radius while G{} is active; G40 was expected before", d, radius_.g_tenths / 10));
}

void RadiusCodes::read_radius_code(const Code& code) {
  if (code.tenths == 400) {
    end_radius();
    return;
  }
  const bool by_value = code.tenths % 10 != 0;
  if (by_value && !at_.dialect().g41_1_has_diameter) {
    at_.error(code.word->offset, "not-read",
              fmt::format("{} (normal direction control) is not supported", at_.code_text(code)), at_.code_text(code));
    at_.words.use("D");
    return;
  }
  const auto radius_mm = radius_of(code);
  if (!radius_mm) return;
  const bool same_side = radius_.g_tenths / 10 == code.tenths / 10;
  if (radius_.active && (radius_.radius_mm != 0 || *radius_mm != 0)) {
    if (!same_side || radius_.radius_mm != *radius_mm)
      at_.error(
          code.word->offset, "cutter-radius",
          fmt::format("{} while G{} is active; G40 was expected before", at_.code_text(code), radius_.g_tenths / 10));
    return;
  }
  radius_ = {true, code.tenths, *radius_mm, at_.out.moves.size(), code.word->offset};
  modal_.set_cutter_radius(code.tenths / 10, *radius_mm != 0);
  if (*radius_mm == 0 || at_.not_editable_told) return;
  at_.not_editable_told = true;
  at_.report.warning(
      code.word->offset, "not-editable",
      fmt::format(
          "the path under {} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
          at_.code_text(code), std::abs(*radius_mm)));
}

/// The radius for D, or for the tool in the spindle where no D was given; zero, with a warning, where none is known.
std::optional<double> RadiusCodes::radius_of(const Code& code) {
  if (code.tenths % 10 != 0) {
    if (!at_.words.has('D')) {
      at_.error(code.word->offset, "cutter-radius",
                fmt::format("{} has no diameter; D was expected", at_.code_text(code)));
      return std::nullopt;
    }
    return 0.5 * at_.words.value('D') * modal_.unit_mm();
  }
  if (at_.words.has('D') && radius_number_ < 0) return std::nullopt;  // no number: said in read_radius_number
  const int number = radius_number_ >= 0 ? radius_number_ : modal_.state().tool;
  if (number == 0 && radius_number_ >= 0) return 0.0;
  const ToolOffset* found = frames_.tool_offset(number);
  if (found)
    if (const auto radius_mm = found->effective_radius_mm()) return radius_mm;
  at_.report.warning(
      code.word->offset, "radius-unknown",
      fmt::format(
          "no radius is given for D{}; {} takes 0, as in a program of the cutter centre, where D has the wear only",
          number, at_.code_text(code)),
      fmt::format("D{}", number));
  return 0.0;
}

/// Checks what a block must not do while the path is being computed.
void RadiusCodes::check_radius_block() {
  if (radius_.radius_mm == 0) return;
  const char* what = nullptr;
  if (at_.request.machine_frame) what = "G53";
  if (at_.request.reference) what = at_.request.reference_word->value == 30 ? "G30" : "G28";
  if (at_.request.return_from_reference) what = "G29";
  if (modal_.cycle_g() != 0) what = "a drilling cycle";
  if (!what) return;
  at_.error(at_.words.offset(), "cutter-radius",
            fmt::format("{} under G{}; G40 with a straight move off the contour was expected before", what,
                        radius_.g_tenths / 10));
  end_radius();
}

void RadiusCodes::end_radius() {
  if (!radius_.active) return;
  const Radius radius = radius_;
  radius_ = {};
  modal_.set_cutter_radius(0, false);
  if (radius.radius_mm == 0 || radius.first_move >= at_.out.moves.size()) return;

  const PlaneAxes axes = axes_of(modal_.plane());
  const Vec3 a = frames_.frame().linear.col(axes.first), b = frames_.frame().linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12) {
    at_.report.error(
        radius.offset, "cutter-radius",
        fmt::format("G{} in a plane that G68 or G68.2 has rotated out of the machine axes is not supported",
                    radius.g_tenths / 10));
    return;
  }
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = (radius.g_tenths / 10 == 41) == (facing > 0);  // a mirror image turns the side over
  cutter.plane = modal_.plane();
  cutter.corner_lines = at_.dialect().radius_corner_lines;
  cutter.entry_square_to_next = at_.dialect().radius_entry_square;
  cutter.moves_without_plane_motion = at_.dialect().radius_look_ahead;
  cutter.name = fmt::format("G{}", radius.g_tenths / 10);
  const CutterRadiusResult result = compensate_radius(at_.out, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    at_.report.error(at_.program == &at_.main ? at_.main.offset_of(problem.block) : at_.words.offset(), "cutter-radius",
                     problem.message);
  beside_mm_ = result.end_mm - place_.position_mm;
  leaving_ = result.problems.empty() && beside_mm_ != Vec3::Zero();
}

/// The first move after G40 starts beside the contour.
void RadiusCodes::leave_contour(Move& move) {
  move.start_mm += beside_mm_;
  move.editable = false;
  const PlaneAxes axes = axes_of(modal_.plane());
  constexpr char kLetters[] = "XYZ";
  const bool in_plane = at_.words.has(kLetters[axes.first]) || at_.words.has(kLetters[axes.second]);
  if (move.kind == MoveKind::dwell || (at_.dialect().radius_exit_waits && !in_plane))
    move.end_mm += beside_mm_;
  else
    leaving_ = false;
}

void RadiusCodes::finish() {
  if (!radius_.active) return;
  const Radius radius = radius_;
  end_radius();
  const std::string message = fmt::format(
      "G{} is never cancelled; G40 with a straight move off the contour was expected "
      "before the end",
      radius.g_tenths / 10);
  if (radius.radius_mm != 0 && !at_.report.has_errors())
    at_.report.error(radius.offset, "cutter-radius", message);
  else if (radius.radius_mm == 0)
    at_.report.warning(radius.offset, "cutter-radius", message);
}

void RadiusCodes::move_inserted(std::size_t at) {
  if (radius_.active && radius_.first_move >= at) ++radius_.first_move;
}

void RadiusCodes::refuse_arc(const char* g) {
  if (!leaving_) return;
  at_.error(at_.words.offset(), "cutter-radius",
            fmt::format("the move off the contour after G40 is an arc ({}); a straight move (G0, G1) was expected", g));
  leaving_ = false;
}

}  // namespace camber::nc
