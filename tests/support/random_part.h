#pragma once
// Parts of boxes and holes taken from a block at random.
#include <optional>
#include <random>

#include "tests/support/block_part.h"

namespace camber::tests {

struct RandomPart {
  BlockPart part;
  machine::Box blank;
};

/// Two to six pockets, slots and steps, up to three holes, in a block; sizes are multiples of half a millimetre. Every
/// third part has a blank larger than its block. The same seed gives the same part.
inline RandomPart random_part(unsigned seed) {
  std::mt19937 random(seed);
  const auto pick = [&](int from, int to) {
    return from + static_cast<int>(random() % static_cast<unsigned>(to - from + 1));
  };
  const auto half = [&](int from, int to) { return 0.5 * pick(2 * from, 2 * to); };
  RandomPart out;
  out.part.block = {{0, 0, 0}, {half(80, 140), half(60, 100), half(20, 40)}};
  const Vec3 size = out.part.block.max_mm;
  for (int i = pick(2, 6); i > 0; --i) {
    const double lx = half(12, 60), ly = half(12, 50), x = half(-20, static_cast<int>(size.x()) - 8),
                 y = half(-20, static_cast<int>(size.y()) - 8), floor = half(4, static_cast<int>(size.z()) - 3);
    out.part.pockets.push_back({{x, y, floor}, {x + lx, y + ly, size.z() + 1}});
  }
  const auto free_of_walls = [&](const BlockHole& h) {
    const double r = h.diameter_mm / 2 + 1;
    for (const machine::Box& p : out.part.pockets)
      for (int a = 0; a < 2; ++a)
        for (const double wall : {p.min_mm[a], p.max_mm[a]})
          if (std::abs(wall - (a == 0 ? h.x_mm : h.y_mm)) <= r) return false;
    for (const BlockHole& o : out.part.holes)
      if (std::abs(o.x_mm - h.x_mm) <= r + o.diameter_mm / 2 + 1 &&
          std::abs(o.y_mm - h.y_mm) <= r + o.diameter_mm / 2 + 1)
        return false;
    return h.x_mm > r && h.y_mm > r && h.x_mm < size.x() - r && h.y_mm < size.y() - r;
  };
  constexpr int kTries = 30;
  for (int i = pick(0, 3), tries = 0; i > 0 && tries < kTries; ++tries) {
    const double d = pick(0, 1) == 0 ? 8 : 10;
    const BlockHole h{half(8, static_cast<int>(size.x()) - 8), half(8, static_cast<int>(size.y()) - 8), d,
                      pick(0, 1) == 0 ? 0.0 : 2.0, 48};
    if (!free_of_walls(h)) continue;
    out.part.holes.push_back(h);
    --i;
  }
  // The squares of holes cut up other holes' cells: no line of one may pass another.
  const auto crossed = [&](const BlockHole& h) {
    for (const BlockHole& o : out.part.holes)
      for (const double s : {-1.0, 1.0}) {
        const double x = o.x_mm + s * (o.diameter_mm / 2 + 1), y = o.y_mm + s * (o.diameter_mm / 2 + 1);
        const double r = h.diameter_mm / 2 + 1;
        if (&o != &h && (std::abs(x - h.x_mm) < r || std::abs(y - h.y_mm) < r)) return true;
      }
    return false;
  };
  while (std::ranges::any_of(out.part.holes, crossed)) out.part.holes.pop_back();
  out.blank = out.part.block;
  if (seed % 3 == 0) {
    out.blank.min_mm -= Vec3(half(0, 4), half(0, 4), 0);
    out.blank.max_mm += Vec3(half(0, 4), half(0, 4), half(1, 5));
  }
  return out;
}

}  // namespace camber::tests
