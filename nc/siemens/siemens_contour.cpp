// G40, G41, G42 with OFFN; RND, RNDM, CHF, CHR: the corner with the next move.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "nc/corner_cut.h"
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

// --- corners

void BlockRunner::read_corner(std::size_t moves_before) {
  struct Kind {
    Extra extra;
    const char* name;
    bool chamfer;
  };
  constexpr Kind kKinds[] = {{Extra::rnd, "RND", false}, {Extra::chf, "CHF", true}, {Extra::chr, "CHR", true}};
  const bool cut = out_.moves.size() > moves_before && !out_.moves.back().canned &&
                   (out_.moves.back().kind == MoveKind::linear || out_.moves.back().kind == MoveKind::arc);
  for (const Kind& kind : kKinds) {
    const Slot& slot = words_.of(kind.extra);
    if (!slot.given) continue;
    const std::string text = fmt::format("{}={:g}", kind.name, slot.value);
    if (!cut) {
      if (!request_.trouble)
        error(slot.offset, "corner-word", fmt::format("{} in a block without a cut; G1, G2 or G3 was expected", text));
      continue;
    }
    if (slot.value < 0) {
      error(slot.offset, "corner-word", fmt::format("{} is negative; zero or more was expected", text));
      continue;
    }
    if (corner_.waits && !corner_.modal) {
      error(slot.offset, "corner-word",
            fmt::format("{} and {} in one block; one of them was expected", corner_.text, text));
      continue;
    }
    corner_ = {true, kind.chamfer, false, slot.value * unit_mm(), out_.moves.size() - 1, slot.offset, text};
  }
  if (modal_rounding_mm_ > 0 && cut && !corner_.waits)
    corner_ = {true,
               false,
               true,
               modal_rounding_mm_,
               out_.moves.size() - 1,
               words_.offset(),
               fmt::format("RNDM={:g}", modal_rounding_mm_ / unit_mm())};
  const auto feed = request_.corner_feed ? request_.corner_feed : modal_corner_feed_;
  if (!corner_.waits || !feed || *feed <= 0) return;
  const bool per_turn = state_.feed_mode == FeedMode::per_revolution;
  corner_.feed_mm_per_s = internal_feed(*feed) * (per_turn ? state_.spindle_speed_rpm / 60 : 1);
}

void BlockRunner::finish_corner(std::size_t moves_before) {
  if (!corner_.waits) return;
  std::size_t next = moves_before;
  while (next < out_.moves.size() && out_.moves[next].kind == MoveKind::dwell) ++next;
  if (next == out_.moves.size()) return;
  const Corner corner = std::exchange(corner_, {});
  if (corner.move >= moves_before) return;
  put_corner(corner, corner.move, next);
}

void BlockRunner::put_corner(const Corner& corner, std::size_t before, std::size_t after) {
  const auto fail = [&](std::string message) { error(corner.offset, "corner-word", std::move(message)); };
  Move &a = out_.moves[before], &b = out_.moves[after];
  const bool cuts = (b.kind == MoveKind::linear || b.kind == MoveKind::arc) && !b.canned && !b.reference;
  const bool same_plane = out_.frame_of(b) == out_.frame_of(a) && out_.state_of(a).plane_g == out_.state_of(b).plane_g;
  const Frame& frame = out_.frame_of(a);
  const int normal = axes_of(plane_).normal;
  const auto leaves = [&](const Move& m) {
    return std::abs((frame.to_program(m.end_mm) - frame.to_program(m.start_mm))[normal]) > 1e-9;
  };
  const auto still = [&](const Move& m) { return (m.end_mm - m.start_mm).norm() < 1e-9 && m.arc == Move::kNoArc; };
  if (corner.modal && (!cuts || !same_plane || leaves(a) || leaves(b) || still(a) || still(b)))
    return;  // RNDM rounds where it can
  a.editable = b.editable = false;
  relied_ends_.add(std::span(out_.moves).first(before));
  if (!cuts || leaving_ || !std::ranges::all_of(out_.rotary, [&](const RotaryTarget& t) { return t.move < before; }))
    return fail(fmt::format(
        "{} is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was expected", corner.text));
  if (state_.feed_mode == FeedMode::inverse_time)
    return fail(fmt::format("{} in inverse time (G93) is not supported", corner.text));
  if (!same_plane)
    return fail(fmt::format("{} before a block in another plane or frame; the same was expected", corner.text));
  double size_mm = corner.size_mm;
  if (corner.chamfer && corner.text.starts_with("CHF")) {
    // The length of the chamfer of two lines that enclose an angle: 2 * distance * sin(half the angle).
    const Vec3 in = direction_at(out_, a, 1), out = direction_at(out_, b, 0);
    const double half = 0.5 * (kPi - std::acos(std::clamp(in.dot(out), -1.0, 1.0)));
    if (std::sin(half) > 1e-9) size_mm = size_mm / (2 * std::sin(half));
  }
  CornerCutResult cut = cut_corner(
      out_, {before, after, plane_, fmt::format("G{}", state_.plane_g), corner.chamfer, size_mm, corner.text, true});
  if (!cut.error.empty()) return fail(cut.error);
  if (cut.shrunk)
    report_.warning(corner.offset, "corner-word",
                    fmt::format("{} is made smaller, since a block beside it is too short", corner.text), "smaller");
  if (!cut.between) return;
  // Without FRC the feed of the block that leads away.
  cut.between->feed_mm_per_s = corner.feed_mm_per_s.value_or(b.feed_mm_per_s);
  out_.moves.insert(out_.moves.begin() + static_cast<std::ptrdiff_t>(after), *cut.between);
  for (auto e = out_.events.rbegin(); e != out_.events.rend() && e->before_move >= after; ++e) ++e->before_move;
  if (radius_.active && radius_.first_move >= after) ++radius_.first_move;
}

}  // namespace camber::nc::siemens
