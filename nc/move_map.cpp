#include "nc/move_map.h"

#include <algorithm>

namespace camber::nc {
namespace {

/// Consecutive moves of one block.
std::size_t end_of_block(const std::vector<Move>& moves, std::size_t first, auto block_of) {
  std::size_t end = first + 1;
  while (end < moves.size() && block_of(moves[end]) == block_of(moves[first])) ++end;
  return end;
}

}  // namespace

MoveMap::MoveMap(const Interpretation& given, const Interpretation& emitted,
                 std::span<const std::uint32_t> block_of_line) {
  const auto own_block = [](const Move& m) { return m.block; };
  const auto given_block = [&](const Move& m) { return m.block < block_of_line.size() ? block_of_line[m.block] : 0; };
  parts_.resize(emitted.moves.size());
  std::size_t g = 0;
  for (std::size_t e = 0; e < emitted.moves.size();) {
    const std::size_t e_end = end_of_block(emitted.moves, e, given_block);
    const std::uint32_t block = given_block(emitted.moves[e]);
    std::size_t at = g;
    while (at < given.moves.size() && given.moves[at].block != block) ++at;
    if (at == given.moves.size()) at = g > 0 ? g - 1 : 0;  // not met: stays near the last one
    const std::size_t g_end = at < given.moves.size() ? end_of_block(given.moves, at, own_block) : at;
    if (g_end - at == 1) {
      double whole = 0;
      for (std::size_t i = e; i < e_end; ++i) whole += length_mm(emitted, emitted.moves[i]);
      double before = 0;
      for (std::size_t i = e; i < e_end; ++i) {
        const double length = length_mm(emitted, emitted.moves[i]);
        parts_[i] = {static_cast<std::uint32_t>(at), whole > 0 ? before / whole : 0,
                     whole > 0 ? (before + length) / whole : 1};
        before += length;
      }
    } else {
      for (std::size_t i = e; i < e_end; ++i)
        parts_[i] = {static_cast<std::uint32_t>(std::min(at + i - e, g_end > 0 ? g_end - 1 : 0)), 0, 1};
    }
    g = g_end;
    e = e_end;
  }
}

MoveMap::MovePlace MoveMap::given(std::uint32_t emitted_move, double fraction) const {
  if (parts_.empty()) return {emitted_move, fraction};
  const Part& p = parts_[emitted_move];
  return {p.move, std::clamp(p.from + fraction * (p.to - p.from), 0.0, 1.0)};
}

}  // namespace camber::nc
