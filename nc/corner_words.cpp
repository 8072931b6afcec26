#include "nc/corner_words.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "nc/corner_cut.h"

namespace camber::nc {

void CornerWords::corner_error(std::size_t offset, std::string message) {
  at_.error(offset, "corner-word", std::move(message));
}

/// Takes what the words of the block ask for, once it has moved.
void CornerWords::read_corner_words(std::size_t moves_before) {
  for (const Word* word : at_.words.corner_words()) {
    const std::string text = at_.program->source.text().substr(word->offset, word->length);
    if (!at_.dialect().corner_words) {
      corner_error(word->offset, fmt::format("{} is no word of a {} program; a letter and a number were expected", text,
                                             at_.dialect().title));
      continue;
    }
    const bool moved = at_.out.moves.size() > moves_before && !at_.out.moves.back().canned &&
                       (at_.out.moves.back().kind == MoveKind::linear || at_.out.moves.back().kind == MoveKind::arc);
    if (!moved) {
      if (!at_.request.trouble)
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
               word->value * modal_.unit_mm() * whole_numbers_.scale_of(*word),
               at_.out.moves.size() - 1,
               word->offset,
               text};
  }
}

/// The corner that waits lies before the first move that the block has made.
void CornerWords::finish_corner(std::size_t moves_before) {
  if (!corner_.waits) return;
  std::size_t next = moves_before;
  while (next < at_.out.moves.size() && at_.out.moves[next].kind == MoveKind::dwell) ++next;
  if (next == at_.out.moves.size()) return;
  const Corner corner = std::exchange(corner_, {});
  if (corner.move >= moves_before) return;
  put_corner(corner, corner.move, next);
}

/// Cuts both moves short and puts a line or an arc between them.
void CornerWords::put_corner(const Corner& corner, std::size_t before, std::size_t after) {
  const auto fail = [&](std::string message) { corner_error(corner.offset, std::move(message)); };
  Move &a = at_.out.moves[before], &b = at_.out.moves[after];
  a.editable = b.editable = false;
  at_.relied_ends.add(std::span(at_.out.moves).first(before));
  if ((b.kind != MoveKind::linear && b.kind != MoveKind::arc) || b.canned || b.reference || radius_.leaving() ||
      !std::ranges::all_of(at_.out.rotary, [&](const RotaryTarget& t) { return t.move < before; }))
    return fail(fmt::format(
        "{} is not followed by a line or an arc of its kind; G1, G2 or G3 in the plane was expected", corner.text));
  if (modal_.state().feed_mode == FeedMode::inverse_time)
    return fail(fmt::format("{} in inverse time (G93) is not supported", corner.text));
  if (!(at_.out.frame_of(b) == at_.out.frame_of(a)) || at_.out.state_of(a).plane_g != at_.out.state_of(b).plane_g)
    return fail(fmt::format("{} before a block in another plane or frame; the same was expected", corner.text));
  const CornerCutResult cut =
      cut_corner(at_.out, {before, after, modal_.plane(), fmt::format("G{}", modal_.state().plane_g), corner.chamfer,
                           corner.size_mm, corner.text});
  if (!cut.error.empty()) return fail(cut.error);
  if (!cut.between) return;
  at_.out.moves.insert(at_.out.moves.begin() + static_cast<std::ptrdiff_t>(after), *cut.between);
  for (auto e = at_.out.events.rbegin(); e != at_.out.events.rend() && e->before_move >= after; ++e) ++e->before_move;
  radius_.move_inserted(after);
}

void CornerWords::finish() {
  if (corner_.waits && !at_.report.has_errors())
    at_.report.error(corner_.offset, "corner-word",
                     fmt::format("{} is not followed by a further move; G1, G2 or G3 was expected", corner_.text));
}

}  // namespace camber::nc
