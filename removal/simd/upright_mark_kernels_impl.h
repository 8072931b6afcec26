#pragma once
// The loops behind removal/simd/upright_mark_kernels.h for one instruction set; as removal/simd/upright_kernels_impl.h.
#include <xsimd/xsimd.hpp>

#include "removal/field/rounded_cutter.h"
#include "removal/form_error/settling.h"
#include "removal/simd/deflection_lanes.h"
#include "removal/simd/upright_mark_kernels.h"

namespace camber::removal::upright {
namespace {

template <class A>
struct MarkVectors {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  using Mask = xsimd::batch_bool<float, A>;
  using Deflection = typename DeflectionLanes<A>::Deflection;
  static constexpr int n = static_cast<int>(F::size);

  static F load(const float* p) { return F::load_unaligned(p); }

  /// Points and what belongs to them.
  struct Lanes {
    F x, y, z, nx, ny, nz, highest;
    I row;
  };

  /// Distance of places from the undeflected cutter.
  static F distance(float flat, float corner, const F& x, const F& y, const F& z) {
    return RoundedCutter<F>{F(flat), F(corner)}.distance(xsimd::sqrt(x * x + y * y), z);
  }

  /// Against a point's normal.
  static F slope_against(const typename RoundedCutter<F>::Normal& n, const F& rho, const F& x, const F& y,
                         const Lanes& l) {
    const F tiny(1e-12f);
    return n.down * l.nz - n.radial * (x * l.nx + y * l.ny) / xsimd::max(rho, tiny);
  }

  static Deflection deflection_at(const MarkTool& t, const I& row, const F& x, const F& y, const F& z) {
    return DeflectionLanes<A>::deflection_at({t.flat, t.corner, t.lag_per_mm, t.steps_per_rad}, t.rows, row, x, y, z);
  }

  /// From a guess of the deflections to the heights at which place and deflection agree.
  static F settled(const MarkTool& t, const Lanes& l, Deflection deflection, Mask live) {
    const F zero(0.0f), one(1.0f), flattest(Settling::kFlattest), close(Settling::kClose_mm), close2 = close * close;
    const RoundedCutter<F> cutter{F(t.flat), F(t.corner)};
    F h = l.highest;
    for (int step = 0; step < Settling::kSteps; ++step) {
      const F x = l.x + h * l.nx - deflection.x, y = l.y + h * l.ny - deflection.y;
      const F z = l.z + h * l.nz - deflection.z;
      const F rho = xsimd::sqrt(x * x + y * y);
      const auto p = cutter.place(rho, z);
      if (step == 0) live = live & (p.distance < zero);
      if (!xsimd::any(live)) break;
      const F slope = xsimd::min(xsimd::max(slope_against(cutter.normal(p), rho, x, y, l), flattest), one);
      const F change = xsimd::select(live, p.distance / slope, zero);
      h += change;
      const Deflection s = deflection_at(t, l.row, l.x + h * l.nx - deflection.x, l.y + h * l.ny - deflection.y,
                                         l.z + h * l.nz - deflection.z);
      const F turned_x = s.x - deflection.x, turned_y = s.y - deflection.y, turned_z = s.z - deflection.z;
      const F turned2 = turned_x * turned_x + turned_y * turned_y + turned_z * turned_z;
      live = live & !((xsimd::abs(change) < close) & (turned2 < close2));
      const F share(Settling::share_of(step));
      deflection.x += xsimd::select(live, share * turned_x, zero);
      deflection.y += xsimd::select(live, share * turned_y, zero);
      deflection.z += xsimd::select(live, share * turned_z, zero);
    }
    return xsimd::min(h, l.highest);
  }

  static void heights(const MarkLanes& m, const MarkTool& t) {
    for (int k = 0; k < m.count; k += n) {
      const Lanes l{load(m.x + k),  load(m.y + k),  load(m.z + k),       load(m.nx + k),
                    load(m.ny + k), load(m.nz + k), load(m.highest + k), I::load_unaligned(m.deflection + k)};
      const F x = l.x + l.highest * l.nx, y = l.y + l.highest * l.ny, z = l.z + l.highest * l.nz;
      const Mask near = distance(t.flat, t.corner, x, y, z) <= load(m.largest + k);
      F h = l.highest;
      if (xsimd::any(near)) {
        // Where the deflection jumps along with the edge, two points of the envelope may lie on one line: the lower
        // counts.
        const F zero(0.0f);
        const F from_straight = settled(t, l, {zero, zero}, near);
        const Deflection first = deflection_at(t, l.row, x, y, z);
        const Deflection guess = deflection_at(t, l.row, x - first.x, y - first.y, z - first.z);
        h = xsimd::min(from_straight, settled(t, l, guess, near));
      }
      h.store_unaligned(m.height + k);
    }
  }

  static void find_near(const CutterLanes& c, float x, float y, float z, NearCutters& out) {
    const F none(1e30f), px(x), py(y), pz(z);
    F nearest = none, where(-1.0f);
    alignas(64) float ramp[n], distances[n], lane[n];
    for (int l = 0; l < n; ++l) ramp[l] = static_cast<float>(l);
    const F lanes = F::load_aligned(ramp);
    out.count = 0;
    for (int k = 0; k < c.count; k += n) {
      const F d = distance(c.flat, c.corner, px - load(c.x + k), py - load(c.y + k), pz - load(c.z + k));
      const F reach = load(c.reach + k);
      const Mask nearer = (d < nearest) & (reach >= F(0.0f));
      nearest = xsimd::select(nearer, d, nearest);
      where = xsimd::select(nearer, F(static_cast<float>(k)) + lanes, where);
      std::uint32_t bits = Table<A>::bits((d <= reach) & (reach >= F(0.0f)));
      for (int l = 0; bits != 0; bits >>= 1, ++l)
        if (bits & 1u) out.within[out.count++] = k + l;
    }
    out.nearest = -1;
    if (out.count == 0) return;
    // The first of those that are equally near, whatever the width.
    nearest.store_aligned(distances), where.store_aligned(lane);
    int best = 0;
    for (int l = 1; l < n; ++l)
      if (distances[l] < distances[best] || (distances[l] == distances[best] && lane[l] < lane[best])) best = l;
    out.nearest = static_cast<int>(lane[best]);
  }

  static void keep_near(const CutterLanes& c, float x, float y, float z, NearCutters& near) {
    constexpr float kInside_mm = 1e-5f;
    const F px(x), py(y), pz(z), zero(0.0f);
    const RoundedCutter<F> cutter{F(c.flat), F(c.corner)};
    std::int32_t* list = near.within;
    for (int i = near.count; i % n != 0; ++i) list[i] = 0;
    alignas(64) float distances[n];
    float nearest = 1e30f;
    int kept = 0;
    near.nearest = -1;
    for (int i = 0; i < near.count; i += n) {
      const I k = I::load_unaligned(list + i);
      const F dx = px - Table<A>::gather(c.x, k), dy = py - Table<A>::gather(c.y, k);
      const auto p = cutter.place(xsimd::sqrt(dx * dx + dy * dy), pz - Table<A>::gather(c.z, k));
      const F reach = Table<A>::gather(c.reach, k);
      auto counts = p.distance <= reach;
      if (c.lateral)
        counts = counts & !((p.outside + reach <= xsimd::min(zero, p.below)) & (p.distance > F(-kInside_mm)));
      std::uint32_t bits = Table<A>::bits(counts);
      if (bits == 0) continue;
      p.distance.store_aligned(distances);
      for (int l = 0; bits != 0 && i + l < near.count; bits >>= 1, ++l) {
        if (!(bits & 1u)) continue;
        const std::int32_t stamp = list[i + l];
        list[kept++] = stamp;
        if (distances[l] >= nearest) continue;
        nearest = distances[l];
        near.nearest = stamp;
      }
    }
    near.count = kept;
  }

  static constexpr MarkKernels table() { return {&find_near, &keep_near, &heights}; }
};

}  // namespace
}  // namespace camber::removal::upright
