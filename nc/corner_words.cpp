// Words with a comma at the end of a block: ,R rounds and ,C chamfers its corner with the next one, ,A gives its angle.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/block_interpreter.h"
#include "nc/corner_cut.h"

namespace camber::nc {

void BlockInterpreter::corner_error(std::size_t offset, std::string message) {
  error(offset, "corner-word", std::move(message));
}

/// ,A: the end on a line of that angle, where the block names one coordinate of the plane.
Vec3 BlockInterpreter::target_at_angle(const Vec3& start, Vec3 end) {
  const auto& words = words_.corner_words();
  const auto word = std::ranges::find(words, 'a', &Word::letter);
  if (word == words.end() || motion_ != Motion::linear || frame_.polar) return end;
  const PlaneAxes axes = axes_of(plane_);
  constexpr char kAxisLetters[] = "XYZ";
  const bool first = words_.has(kAxisLetters[axes.first]), second = words_.has(kAxisLetters[axes.second]);
  if (first == second) {
    corner_error((*word)->offset,
                 fmt::format(",A in a block with {} of {} and {}; one of them was expected", first ? "both" : "none",
                             kAxisLetters[axes.first], kAxisLetters[axes.second]));
    return end;
  }
  const double angle = rad_from_deg((*word)->value * whole_number_scale_of(**word));
  const double across = first ? std::cos(angle) : std::sin(angle), along = first ? std::sin(angle) : std::cos(angle);
  const int given = first ? axes.first : axes.second, open = first ? axes.second : axes.first;
  if (std::abs(across) < 1e-6) {
    corner_error((*word)->offset,
                 fmt::format("a line at {} degrees does not lead to another {}", (*word)->value, kAxisLetters[given]));
    return end;
  }
  end[open] = start[open] + (end[given] - start[given]) * along / across;
  editable_ = false;
  return end;
}

/// Takes what the words of the block ask for, once it has moved.
void BlockInterpreter::read_corner_words(std::size_t moves_before) {
  for (const Word* word : words_.corner_words()) {
    const std::string text = program_->source.text().substr(word->offset, word->length);
    if (!options_.dialect_or_default().corner_words) {
      corner_error(word->offset, fmt::format("{} is no word of a {} program; a letter and a number were expected", text,
                                             options_.dialect_or_default().title));
      continue;
    }
    const bool moved = out_.moves.size() > moves_before && !out_.moves.back().canned &&
                       (out_.moves.back().kind == MoveKind::linear || out_.moves.back().kind == MoveKind::arc);
    if (!moved) {
      if (!request_.trouble)
        corner_error(word->offset, fmt::format("{} in a block without a cut; G1, G2 or G3 was expected", text));
      continue;
    }
    if (word->letter == 'a') continue;
    if (corner_.waits) {
      corner_error(word->offset, fmt::format("{} and {} in one block; one of them was expected", corner_.text, text));
      continue;
    }
    if (word->value < 0) {
      corner_error(word->offset, fmt::format("{} is negative; zero or more was expected", text));
      continue;
    }
    corner_ = {true,
               word->letter == 'c',
               word->value * unit_mm() * whole_number_scale_of(*word),
               out_.moves.size() - 1,
               word->offset,
               text};
  }
}

/// The corner that waits lies before the first move that the block has made.
void BlockInterpreter::finish_corner(std::size_t moves_before) {
  if (!corner_.waits) return;
  std::size_t next = moves_before;
  while (next < out_.moves.size() && out_.moves[next].kind == MoveKind::dwell) ++next;
  if (next == out_.moves.size()) return;
  const Corner corner = std::exchange(corner_, {});
  if (corner.move >= moves_before) return;
  put_corner(corner, corner.move, next);
}

/// Cuts both moves short and puts a line or an arc between them.
void BlockInterpreter::put_corner(const Corner& corner, std::size_t before, std::size_t after) {
  const auto fail = [&](std::string message) { corner_error(corner.offset, std::move(message)); };
  Move &a = out_.moves[before], &b = out_.moves[after];
  a.editable = b.editable = false;
  if ((b.kind != MoveKind::linear && b.kind != MoveKind::arc) || b.canned || b.reference || leaving_ ||
      !std::ranges::all_of(out_.rotary, [&](const RotaryTarget& t) { return t.move < before; }))
    return fail(fmt::format(
        "{} is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was expected", corner.text));
  if (state_.feed_mode == FeedMode::inverse_time)
    return fail(fmt::format("{} in inverse time (G93) is not supported", corner.text));
  if (!(out_.frame_of(b) == out_.frame_of(a)) || out_.state_of(a).plane_g != out_.state_of(b).plane_g)
    return fail(fmt::format("{} before a block in another plane or frame; the same was expected", corner.text));
  const CornerCutResult cut = cut_corner(
      out_, {before, after, plane_, fmt::format("G{}", state_.plane_g), corner.chamfer, corner.size_mm, corner.text});
  if (!cut.error.empty()) return fail(cut.error);
  if (!cut.between) return;
  out_.moves.insert(out_.moves.begin() + static_cast<std::ptrdiff_t>(after), *cut.between);
  for (auto e = out_.events.rbegin(); e != out_.events.rend() && e->before_move >= after; ++e) ++e->before_move;
  if (radius_.active && radius_.first_move >= after) ++radius_.first_move;
}

}  // namespace camber::nc
