#pragma once
// The loops behind removal/simd/upright_block_kernels.h for one instruction set; as
// removal/simd/upright_kernels_impl.h.
#include <xsimd/xsimd.hpp>

#include "removal/field/rounded_cutter.h"
#include "removal/simd/arena_lanes.h"
#include "removal/simd/upright_block_kernels.h"
#include "removal/simd/vector_table.h"

namespace camber::removal::upright {
namespace {

template <class A>
struct BlockVectors {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  using T = Table<A>;
  static constexpr int n = static_cast<int>(F::size);
  static constexpr int kSide = 17;  ///< Tile::kSide
  static constexpr int kCoreBits = ArenaLanes<A>::kCoreBits, kCore = ArenaLanes<A>::kCore;
  static constexpr int kLanes = 8;
  static constexpr float kLevel = BlockBounds::kLevel;
  static constexpr int kSquareBits = 2, kSquareShift = kCoreBits - kSquareBits;  ///< TopMap::kCellBits

  static F load(const float* p) { return F::load_unaligned(p); }
  static I load(const std::int32_t* p) { return I::load_unaligned(p); }
  static I to_int(const F& f) { return xsimd::batch_cast<std::int32_t>(f); }
  static F to_float(const I& i) { return xsimd::batch_cast<float>(i); }

  static I cell_of(const StampPlace& s, const ArenaView& arena, const F& bx, const F& by, const F& bz) {
    return ArenaLanes<A>::cell_of(s, arena, bx, by, bz);
  }

  static int find_blocks(const BlockBounds& b, const StampPlace& s, const ArenaView& arena, std::int32_t* out) {
    int found = 0;
    const F fx(s.feed_mm[0]), fy(s.feed_mm[1]), fz(s.feed_mm[2]), length(s.feed_length_mm), least(s.min_forward_mm);
    const float max_mm = s.feed_length_mm + s.lateral_mm;  // between stamps, deflections and all
    const F lateral(s.lateral_mm), tilt(s.tilt_mm), curving(0.5f * max_mm * max_mm), slack(s.slack_mm);
    const F per_voxel(s.per_voxel), half(0.5f), base_z(static_cast<float>(s.base[2]) + s.fraction[2]);
    const I squares_x(arena.n[0] << kSquareShift), squares_y(arena.n[1] << kSquareShift);
    constexpr int kAhead = 4;
    struct Asked {
      alignas(64) std::int32_t cell[n];
      int first;
      std::uint32_t bits;
    };
    Asked asked[kAhead];
    int count = 0;
    const auto take = [&](const Asked& a) {
      const F distance = T::gather(arena.distance, I::load_aligned(a.cell));
      std::uint32_t bits = a.bits & T::bits(distance <= load(b.reach + a.first) + slack);
      for (int l = 0; bits != 0; bits >>= 1, ++l)
        if (bits & 1u) {
          out[found++] = a.first + l;
          const float* centre = arena.distance + a.cell[l];  // read_blocks reads all around it
          for (const int row : {-kSide, kSide, -kSide * kSide, kSide * kSide, kSide * kSide + kSide})
            __builtin_prefetch(centre + row);
        }
    };
    for (int k = 0; k < b.count; k += n) {
      F into = fx * load(b.nx + k) + fy * load(b.ny + k) + fz * load(b.nz + k) + length * load(b.spread + k);
      if (b.lateral) {
        const F across = load(b.lateral + k);
        into += lateral * across + curving * load(b.curvature + k) + xsimd::select(across < F(kLevel), F(0.0f), tilt);
      }
      const auto forward = into > least;
      if (!xsimd::any(forward)) continue;
      const F gx = F(s.fraction[0]) + load(b.x + k) * per_voxel, gy = F(s.fraction[1]) + load(b.y + k) * per_voxel;
      const I i = (to_int(xsimd::floor(gx)) + I(s.base[0])) >> kSquareBits;
      const I j = (to_int(xsimd::floor(gy)) + I(s.base[1])) >> kSquareBits;
      const auto inside = (i >= I(0)) & (i < squares_x) & (j >= I(0)) & (j < squares_y);
      const I top = T::gather(arena.top, xsimd::select(inside, i * squares_y + j, I(0)));
      const auto under = to_float(xsimd::select(inside, top, I(0))) > base_z + load(b.bottom + k) * per_voxel;
      if (!xsimd::any(forward & under)) continue;
      const I cell = cell_of(s, arena, xsimd::floor(gx + half), xsimd::floor(gy + half),
                             xsimd::floor(F(s.fraction[2]) + load(b.z + k) * per_voxel + half));
      // Voxels come from far away: what is asked for now is read a few vectors later.
      Asked& next = asked[count % kAhead];
      if (count >= kAhead) take(next);
      next.first = k;
      next.bits = T::bits(forward & under);
      cell.store_aligned(next.cell);
      for (int l = 0; l < n; ++l) __builtin_prefetch(arena.distance + next.cell[l]);
      ++count;
    }
    for (int i = count < kAhead ? 0 : count - kAhead; i < count; ++i) take(asked[i % kAhead]);
    return found;
  }

  static void read_blocks(const BlockPoints& p, const std::int32_t* blocks, int count, const StampPlace& s,
                          const ArenaView& arena, float air, BlockHits& hits, ShallowPoints& shallow) {
    const F zero(0.0f), half(0.5f), per_voxel(s.per_voxel);
    const F fx(s.feed_mm[0]), fy(s.feed_mm[1]), fz(s.feed_mm[2]), feed2 = fx * fx + fy * fy + fz * fz;
    for (int i = 0; i < count; ++i) {
      const int first = blocks[i] * kLanes;
      std::uint32_t deep_bits = 0, shallow_bits = 0;
      alignas(64) float caps[kLanes], thickness[kLanes], u_of[kLanes], v_of[kLanes], w_of[kLanes];
      alignas(64) std::int32_t cells[kLanes];
      for (int l = 0; l < kLanes; l += n) {
        const int k = first + l;
        const F along = fx * load(p.nx + k) + fy * load(p.ny + k) + fz * load(p.nz + k);
        const F tangential2 = xsimd::max(zero, feed2 - along * along);
        const F around = load(p.cos_phi + k) * fy - load(p.sin_phi + k) * fx, around2 = around * around;
        const F cap =
            along + half * (load(p.k1 + k) * xsimd::max(zero, tangential2 - around2) + load(p.k2 + k) * around2);
        const auto forward = cap > F(s.min_cap_mm);
        cap.store_aligned(caps + l);
        if (!xsimd::any(forward)) {
          zero.store_aligned(thickness + l);
          continue;
        }
        const F gx = F(s.fraction[0]) + load(p.x + k) * per_voxel, gy = F(s.fraction[1]) + load(p.y + k) * per_voxel,
                gz = F(s.fraction[2]) + load(p.z + k) * per_voxel;
        const F bx = xsimd::floor(gx), by = xsimd::floor(gy), bz = xsimd::floor(gz);
        const I cell = cell_of(s, arena, bx, by, bz);
        const F u = gx - bx, v = gy - by, w = gz - bz;
        const F field = ArenaLanes<A>::field_at(arena.distance, cell, u, v, w);
        const F wall = load(p.wall_half + k), least = xsimd::max(cap, wall);
        const auto deep = forward & (-field > least);
        const auto near = forward & (-field <= least) & (field <= xsimd::max(F(air), wall));
        deep_bits |= T::bits(deep) << l;
        shallow_bits |= T::bits(near) << l;
        xsimd::select(deep, cap, zero).store_aligned(thickness + l);
        cell.store_aligned(cells + l);
        u.store_aligned(u_of + l), v.store_aligned(v_of + l), w.store_aligned(w_of + l);
      }
      if ((deep_bits | shallow_bits) == 0) continue;
      const int hit = hits.count++;
      hits.block[hit] = static_cast<std::uint32_t>(blocks[i]);
      hits.deep[hit] = deep_bits;
      for (int l = 0; l < kLanes; ++l) hits.thickness[hit * kLanes + l] = thickness[l];
      for (int l = 0; shallow_bits != 0; shallow_bits >>= 1, ++l) {
        if (!(shallow_bits & 1u)) continue;
        const int at = shallow.count++;
        shallow.lane[at] = first + l;
        shallow.cell[at] = cells[l];
        shallow.cap[at] = caps[l];
        shallow.share[0][at] = u_of[l], shallow.share[1][at] = v_of[l], shallow.share[2][at] = w_of[l];
        shallow.hit[at] = hit * kLanes + l;
        const std::int32_t* named = arena.stamp + cells[l];  // thin_points reads them
        for (const int row : {0, kSide, kSide * kSide, kSide * kSide + kSide}) __builtin_prefetch(named + row);
      }
    }
  }

  static void thin_points(const BlockPoints& p, const ShallowPoints& shallow, const ArenaView& arena,
                          const FixedTips& tips, float flat, float corner, float min_slope, float* out) {
    constexpr int kCorners = 8;
    const F zero(0.0f), tiny(1e-12f), one(1.0f), step(tips.step_mm), none(1e30f);
    const RoundedCutter<F> cutter{F(flat), F(corner)};
    for (int i = 0; i < shallow.count; i += n) {
      const I lane = load(shallow.lane + i), cell = load(shallow.cell + i);
      const F px = T::gather(p.x, lane), py = T::gather(p.y, lane), pz = T::gather(p.z, lane);
      const F nx = T::gather(p.nx, lane), ny = T::gather(p.ny, lane), nz = T::gather(p.nz, lane);
      F best = none;
      I ids[kCorners];
      for (int c = 0; c < kCorners; ++c) {
        if (c % 2 == 0)
          T::gather_pair(arena.stamp, cell + I(((c >> 2) * kSide + (c >> 1 & 1)) * kSide), ids[c], ids[c + 1]);
        // Neighbouring corners mostly name the same stamps.
        auto known = ids[c] != ids[c];
        for (int other = 1; other < kCorners; other *= 2)
          if ((c & other) != 0) known = known | (ids[c] == ids[c ^ other]);
        if (xsimd::all(known)) continue;
        const I index = ids[c] - I(tips.first_id);
        const auto named = index >= I(0);
        const I at = xsimd::select(named, index, I(0));
        // From the tip to the point.
        const F x = px + to_float(I(tips.own[0]) - T::gather(tips.x, at)) * step;
        const F y = py + to_float(I(tips.own[1]) - T::gather(tips.y, at)) * step;
        const F z = pz + to_float(I(tips.own[2]) - T::gather(tips.z, at)) * step;
        const F rho = xsimd::sqrt(x * x + y * y);
        const auto place = cutter.place(rho, z);
        const auto normal = cutter.normal(place);
        const F outward = (x * nx + y * ny) / xsimd::max(rho, tiny);
        const F slope = xsimd::min(xsimd::max(normal.radial * outward - normal.down * nz, F(min_slope)), one);
        const I kept = xsimd::select(named, I(1), I(0));
        best = xsimd::min(best, xsimd::select(to_float(kept) > zero, place.distance / slope, none));
      }
      best.store_unaligned(out + i);
    }
  }

  static void thin_by_blank(const BlockPoints& p, const BlankPoints& b) {
    const F zero(0.0f), one(1.0f), per_voxel(1 / b.voxel_mm);
    for (int i = 0; i < b.count; i += n) {
      const I lane = load(b.lane + i), cell = load(b.cell + i);
      const F u = load(b.share[0] + i), v = load(b.share[1] + i), w = load(b.share[2] + i);
      F value[2], along_y[2], along_z[2];  // on the cell's two faces across x
      for (int f = 0; f < 2; ++f) {
        F d00, d01, d10, d11;
        T::gather_pair(b.blank, cell + I(f * kSide * kSide), d00, d01);
        T::gather_pair(b.blank, cell + I((f * kSide + 1) * kSide), d10, d11);
        const F z0 = d01 - d00, z1 = d11 - d10, at0 = d00 + w * z0, at1 = d10 + w * z1;
        along_y[f] = at1 - at0;
        along_z[f] = z0 + v * (z1 - z0);
        value[f] = at0 + v * along_y[f];
      }
      const F gx = value[1] - value[0], distance = value[0] + u * gx;
      const F gy = along_y[0] + u * (along_y[1] - along_y[0]), gz = along_z[0] + u * (along_z[1] - along_z[0]);
      const F fall =
          -(gx * T::gather(p.nx, lane) + gy * T::gather(p.ny, lane) + gz * T::gather(p.nz, lane)) * per_voxel;
      const F slope = xsimd::min(xsimd::max(fall, F(b.min_slope)), one);
      const F depth = -distance, thickness = load(b.thickness + i);
      xsimd::min(thickness, xsimd::select(depth > zero, depth / slope, depth)).store_unaligned(b.thickness + i);
    }
  }

  static constexpr BlockKernels table() { return {&find_blocks, &read_blocks, &thin_points, &thin_by_blank}; }
};

}  // namespace
}  // namespace camber::removal::upright
