#pragma once
// Reading voxels of an arena's tiles, in vectors. Included by the files that are compiled for one instruction set, as
// removal/simd/upright_kernels_impl.h.
#include <xsimd/xsimd.hpp>

#include "removal/simd/upright_block_kernels.h"
#include "removal/simd/vector_table.h"

namespace camber::removal::upright {
namespace {

template <class A>
struct ArenaLanes {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  using T = Table<A>;
  static constexpr int kSide = 17;  ///< Tile::kSide
  static constexpr int kCoreBits = 4, kCore = 1 << kCoreBits;

  static I to_int(const F& f) { return xsimd::batch_cast<std::int32_t>(f); }

  /// Returns the index of voxels in the arena; of those outside it one in the tile of air. bx, by, bz: whole numbers of
  /// voxels from the stamp's.
  static I cell_of(const StampPlace& s, const ArenaView& arena, const F& bx, const F& by, const F& bz) {
    const I x = to_int(bx) + I(s.base[0]), y = to_int(by) + I(s.base[1]), z = to_int(bz) + I(s.base[2]);
    const auto inside = (x >= I(0)) & (x < I(arena.n[0] * kCore)) & (y >= I(0)) & (y < I(arena.n[1] * kCore)) &
                        (z >= I(0)) & (z < I(arena.n[2] * kCore));
    const I tile = ((x >> kCoreBits) * I(arena.n[1]) + (y >> kCoreBits)) * I(arena.n[2]) + (z >> kCoreBits);
    const I slot = xsimd::select(inside, T::gather(arena.slot, xsimd::select(inside, tile, I(0))), I(0));
    const I last(kCore - 1);
    return slot * I(arena.stride) + ((x & last) * I(kSide) + (y & last)) * I(kSide) + (z & last);
  }

  /// Trilinear distance at a place in a cell.
  static F field_at(const float* distance, const I& cell, const F& u, const F& v, const F& w) {
    const auto along_z = [&](int i, int j) {
      F a, b;
      T::gather_pair(distance, cell + I((i * kSide + j) * kSide), a, b);
      return a + w * (b - a);
    };
    const auto along_y = [&](int i) {
      const F a = along_z(i, 0);
      return a + v * (along_z(i, 1) - a);
    };
    const F a = along_y(0);
    return a + u * (along_y(1) - a);
  }
};

}  // namespace
}  // namespace camber::removal::upright
