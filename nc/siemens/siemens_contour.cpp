// G40, G41, G42 with OFFN; RND, RNDM, CHF, CHR.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/corner_cut.h"
#include "nc/cutter_radius.h"
#include "nc/siemens/siemens_motion.h"

namespace camber::nc::siemens {

void RadiusWords::begin(const CodeWord& code) {
  std::optional<double> radius_mm;
  if (tools_.edge() == 0) {
    radius_mm = 0;
  } else if (const ToolOffset* tool = tools_.offset(modes_.state().tool)) {
    radius_mm = tool->effective_radius_mm();
  }
  if (!radius_mm) {
    at_.report.warning(code.offset, "radius-unknown",
                       fmt::format("no radius is given for tool {}; G{} takes 0, as in a program of the cutter centre",
                                   modes_.state().tool, code.number),
                       fmt::format("T{}", modes_.state().tool));
    radius_mm = 0;
  }
  *radius_mm += offset_normal_mm_;
  if (at_.radius.active && (at_.radius.radius_mm != 0 || *radius_mm != 0)) {
    if (at_.radius.g != code.number || at_.radius.radius_mm != *radius_mm)
      at_.error(code.offset, "cutter-radius",
                fmt::format("G{} while G{} is active; G40 was expected before", code.number, at_.radius.g));
    return;
  }
  at_.radius = {true, code.number, *radius_mm, at_.out.moves.size(), code.offset};
  modes_.change().cutter_radius = *radius_mm != 0;
  if (*radius_mm == 0 || not_editable_told_) return;
  not_editable_told_ = true;
  at_.report.warning(
      code.offset, "not-editable",
      fmt::format(
          "the path under G{} is computed here, cutter radius {:.4f} mm; compensation leaves these moves unchanged",
          code.number, std::abs(*radius_mm)));
}

void RadiusWords::end() {
  if (!at_.radius.active) return;
  const ActiveRadius radius = std::exchange(at_.radius, {});
  modes_.change().cutter_radius = false;
  if (radius.radius_mm == 0 || radius.first_move >= at_.out.moves.size()) return;
  const PlaneAxes axes = at_.axes();
  const Vec3 a = frames_.frame().linear.col(axes.first), b = frames_.frame().linear.col(axes.second);
  const double facing = a[axes.first] * b[axes.second] - a[axes.second] * b[axes.first];
  if (std::abs(a[axes.normal]) > 1e-12 || std::abs(b[axes.normal]) > 1e-12) {
    at_.report.error(
        radius.offset, "cutter-radius",
        fmt::format("G{} in a plane that ROT or CYCLE800 has turned out of the machine axes is not supported",
                    radius.g));
    return;
  }
  CutterRadius cutter;
  cutter.radius_mm = radius.radius_mm;
  cutter.left = (radius.g == 41) == (facing > 0);
  cutter.plane = at_.plane;
  cutter.corner_lines = false;         // G450
  cutter.entry_square_to_next = true;  // NORM
  cutter.moves_without_plane_motion = 3;
  cutter.name = fmt::format("G{}", radius.g);
  const CutterRadiusResult result = compensate_radius(at_.out, radius.first_move, cutter);
  for (const CutterRadiusProblem& problem : result.problems)
    at_.report.error(at_.program == &at_.main ? at_.main.offset_of(problem.block) : at_.words.offset(), "cutter-radius",
                     problem.message);
  mover_.leave_from(result.problems.empty() ? Vec3(result.end_mm - mover_.position_mm()) : Vec3(Vec3::Zero()));
}

void RadiusWords::finish() {
  if (!at_.radius.active) return;
  const ActiveRadius radius = at_.radius;
  end();
  const std::string message = fmt::format(
      "G{} is never cancelled; G40 with a straight move off the contour was expected before the end", radius.g);
  if (radius.radius_mm != 0 && !at_.report.has_errors())
    at_.report.error(radius.offset, "cutter-radius", message);
  else if (radius.radius_mm == 0)
    at_.report.warning(radius.offset, "cutter-radius", message);
}

// --- corners

void Corners::read(std::size_t moves_before) {
  struct Kind {
    Extra extra;
    const char* name;
    bool chamfer;
  };
  constexpr Kind kKinds[] = {{Extra::rnd, "RND", false}, {Extra::chf, "CHF", true}, {Extra::chr, "CHR", true}};
  const bool cut = at_.out.moves.size() > moves_before && !at_.out.moves.back().canned &&
                   (at_.out.moves.back().kind == MoveKind::linear || at_.out.moves.back().kind == MoveKind::arc);
  for (const Kind& kind : kKinds) {
    const Slot& slot = at_.words.of(kind.extra);
    if (!slot.given) continue;
    const std::string text = fmt::format("{}={:g}", kind.name, slot.value);
    if (!cut) {
      if (!at_.request.trouble)
        at_.error(slot.offset, "corner-word",
                  fmt::format("{} in a block without a cut; G1, G2 or G3 was expected", text));
      continue;
    }
    if (slot.value < 0) {
      at_.error(slot.offset, "corner-word", fmt::format("{} is negative; zero or more was expected", text));
      continue;
    }
    if (corner_.waits && !corner_.modal) {
      at_.error(slot.offset, "corner-word",
                fmt::format("{} and {} in one block; one of them was expected", corner_.text, text));
      continue;
    }
    corner_ = {true, kind.chamfer, false, slot.value * modes_.unit_mm(), at_.out.moves.size() - 1, slot.offset, text};
  }
  if (modal_rounding_mm_ > 0 && cut && !corner_.waits)
    corner_ = {true,
               false,
               true,
               modal_rounding_mm_,
               at_.out.moves.size() - 1,
               at_.words.offset(),
               fmt::format("RNDM={:g}", modal_rounding_mm_ / modes_.unit_mm())};
  const auto feed = at_.request.corner_feed ? at_.request.corner_feed : modal_feed_;
  if (!corner_.waits || !feed || *feed <= 0) return;
  const bool per_turn = modes_.state().feed_mode == FeedMode::per_revolution;
  corner_.feed_mm_per_s = modes_.internal_feed(*feed) * (per_turn ? modes_.state().spindle_speed_rpm / 60 : 1);
}

void Corners::make(std::size_t moves_before) {
  if (!corner_.waits) return;
  std::size_t next = moves_before;
  while (next < at_.out.moves.size() && at_.out.moves[next].kind == MoveKind::dwell) ++next;
  if (next == at_.out.moves.size()) return;
  const Corner corner = std::exchange(corner_, {});
  if (corner.move >= moves_before) return;
  put(corner, corner.move, next);
}

void Corners::put(const Corner& corner, std::size_t before, std::size_t after) {
  const auto fail = [&](std::string message) { at_.error(corner.offset, "corner-word", std::move(message)); };
  Move &a = at_.out.moves[before], &b = at_.out.moves[after];
  const bool cuts = (b.kind == MoveKind::linear || b.kind == MoveKind::arc) && !b.canned && !b.reference;
  const bool same_plane =
      at_.out.frame_of(b) == at_.out.frame_of(a) && at_.out.state_of(a).plane_g == at_.out.state_of(b).plane_g;
  const Frame& frame = at_.out.frame_of(a);
  const int normal = at_.axes().normal;
  const auto leaves = [&](const Move& m) {
    return std::abs((frame.to_program(m.end_mm) - frame.to_program(m.start_mm))[normal]) > 1e-9;
  };
  const auto still = [&](const Move& m) { return (m.end_mm - m.start_mm).norm() < 1e-9 && m.arc == Move::kNoArc; };
  if (corner.modal && (!cuts || !same_plane || leaves(a) || leaves(b) || still(a) || still(b)))
    return;  // RNDM rounds where it can
  a.editable = b.editable = false;
  at_.relied_ends.add(std::span(at_.out.moves).first(before));
  if (!cuts || mover_.leaving() ||
      !std::ranges::all_of(at_.out.rotary, [&](const RotaryTarget& t) { return t.move < before; }))
    return fail(fmt::format(
        "{} is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was expected", corner.text));
  if (modes_.state().feed_mode == FeedMode::inverse_time)
    return fail(fmt::format("{} in inverse time (G93) is not supported", corner.text));
  if (!same_plane)
    return fail(fmt::format("{} before a block in another plane or frame; the same was expected", corner.text));
  double size_mm = corner.size_mm;
  if (corner.chamfer && corner.text.starts_with("CHF")) {
    // The length of the chamfer of two lines that enclose an angle: 2 * distance * sin(half the angle).
    const Vec3 in = direction_at(at_.out, a, 1), out = direction_at(at_.out, b, 0);
    const double half = 0.5 * (kPi - std::acos(std::clamp(in.dot(out), -1.0, 1.0)));
    if (std::sin(half) > 1e-9) size_mm = size_mm / (2 * std::sin(half));
  }
  CornerCutResult cut = cut_corner(at_.out, {before, after, at_.plane, fmt::format("G{}", modes_.state().plane_g),
                                             corner.chamfer, size_mm, corner.text, true});
  if (!cut.error.empty()) return fail(cut.error);
  if (cut.shrunk)
    at_.report.warning(corner.offset, "corner-word",
                       fmt::format("{} is made smaller, since a block beside it is too short", corner.text), "smaller");
  if (!cut.between) return;
  // Without FRC the feed of the block that leads away.
  cut.between->feed_mm_per_s = corner.feed_mm_per_s.value_or(b.feed_mm_per_s);
  at_.out.moves.insert(at_.out.moves.begin() + static_cast<std::ptrdiff_t>(after), *cut.between);
  for (auto e = at_.out.events.rbegin(); e != at_.out.events.rend() && e->before_move >= after; ++e) ++e->before_move;
  if (at_.radius.active && at_.radius.first_move >= after) ++at_.radius.first_move;
}

void Corners::finish() {
  if (corner_.waits && !corner_.modal && !at_.report.has_errors())
    at_.report.error(corner_.offset, "corner-word",
                     fmt::format("{} is not followed by a further move; G1, G2 or G3 was expected", corner_.text));
}

}  // namespace camber::nc::siemens
