#pragma once
// Deflections of the envelope at places, in vectors. Included by the files that are compiled for one instruction
// set, as removal/simd/upright_kernels_impl.h.
#include <xsimd/xsimd.hpp>

#include "removal/field/rounded_cutter.h"
#include "removal/form_error/settling.h"
#include "removal/simd/upright_kernels.h"
#include "removal/simd/vector_table.h"

namespace camber::removal::upright {
namespace {

/// A rounded cylinder and the rotation steps of its edges.
struct EdgeLanes {
  float flat, corner;
  float lag_per_mm, steps_per_rad;
};

template <class A>
struct DeflectionLanes {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;

  struct Deflection {
    F x, y, z = F(0.0f);
  };
  static I to_int(const F& f) { return xsimd::batch_cast<std::int32_t>(f); }
  static F to_float(const I& i) { return xsimd::batch_cast<float>(i); }

  static Deflection at(const float* row, const I& node_offset, const I& step) {
    Deflection out;
    Table<A>::gather_pair(row, I(2) * (node_offset + step), out.x, out.y);
    return out;
  }

  /// To 1e-7 rad (Abramowitz & Stegun 4.4.49).
  static F atan2(const F& y, const F& x) {
    const F ax = xsimd::abs(x), ay = xsimd::abs(y);
    const F a = xsimd::min(ax, ay) / xsimd::max(xsimd::max(ax, ay), F(1e-20f));
    const F s = a * a;
    F r = F(0.0028662257f);
    for (const float c : {-0.0161657367f, 0.0429096138f, -0.0752896400f, 0.1065626393f, -0.1420889944f, 0.1999355085f,
                          -0.3333314528f, 1.0f})
      r = r * s + F(c);
    r *= a;
    r = xsimd::select(ay > ax, F(1.57079633f) - r, r);
    r = xsimd::select(x < F(0.0f), F(3.14159265f) - r, r);
    return xsimd::select(y < F(0.0f), -r, r);
  }

  /// Deflection of the envelope's point nearest to a place; `offset` of each lane's row in the table.
  static Deflection deflection_at(const EdgeLanes& e, const DeflectionRow& rows, const I& offset, const F& x,
                                  const F& y, const F& z) {
    const F zero(0.0f);
    const RoundedCutter<F> cutter{F(e.flat), F(e.corner)};
    const F height = cutter.nearest_height(cutter.place(xsimd::sqrt(x * x + y * y), z), z);
    const F steps(static_cast<float>(rows.steps));
    F step = (atan2(y, x) - height * F(e.lag_per_mm)) * F(e.steps_per_rad);
    step -= steps * xsimd::floor(step / steps);
    I m0 = to_int(step);
    const F fm = step - to_float(m0);
    const I all(rows.steps);
    // Of a height that diverges, the remainder may be anything: the table is not left.
    m0 = xsimd::select((m0 >= all) | (m0 < I(0)), I(0), m0);
    const I m1 = xsimd::select(m0 + I(1) == all, I(0), m0 + I(1));
    const F at_node =
        xsimd::min(xsimd::max(height / F(rows.node_step_mm), zero), F(static_cast<float>(rows.nodes - 1)));
    const I n0 = xsimd::min(to_int(at_node), I(rows.nodes > 1 ? rows.nodes - 2 : 0));
    const F fn = at_node - to_float(n0);
    const I low = offset + n0 * all, high = rows.nodes > 1 ? low + all : low;
    const Deflection s00 = at(rows.now, low, m0), s01 = at(rows.now, low, m1), s10 = at(rows.now, high, m0),
                     s11 = at(rows.now, high, m1);
    const F one(1.0f), w00 = (one - fn) * (one - fm), w01 = (one - fn) * fm, w10 = fn * (one - fm), w11 = fn * fm;
    return {w00 * s00.x + w01 * s01.x + w10 * s10.x + w11 * s11.x,
            w00 * s00.y + w01 * s01.y + w10 * s10.y + w11 * s11.y, axial_at(rows, offset, m0, fm)};
  }

  /// Axial deflection between a rotation step and the next one.
  static F axial_at(const DeflectionRow& rows, const I& offset, const I& step, const F& fraction) {
    if (!rows.axial) return F(0.0f);
    const Deflection pair = at(rows.now, offset + I(rows.nodes * rows.steps), step);
    return pair.x + fraction * (pair.y - pair.x);
  }

  using Mask = xsimd::batch_bool<float, A>;

  /// The deflection s of the envelope's point that is displaced to a place: s = deflection_at(place - s), from a first
  /// guess, until the next step would change it by no more than Settling::kFieldClose_mm. Of lanes that are not
  /// `exact` one step is enough.
  static Deflection settled_at(const EdgeLanes& e, const DeflectionRow& rows, const I& offset, const F& x, const F& y,
                               const F& z, Deflection s, const Mask& exact = F(1.0f) > F(0.0f)) {
    const F zero(0.0f), close2(Settling::kFieldClose_mm * Settling::kFieldClose_mm);
    const F least_fall2(Settling::kTrustedFall * Settling::kTrustedFall);
    Mask live = close2 > zero;
    F before2 = zero;
    for (int step = 0; step < Settling::kFieldSteps; ++step) {
      const Deflection next = deflection_at(e, rows, offset, x - s.x, y - s.y, z - s.z);
      const F turned_x = next.x - s.x, turned_y = next.y - s.y, turned_z = next.z - s.z;
      const F share(Settling::share_of(step));
      s.x += xsimd::select(live, share * turned_x, zero);
      s.y += xsimd::select(live, share * turned_y, zero);
      s.z += xsimd::select(live, share * turned_z, zero);
      const F turned2 = turned_x * turned_x + turned_y * turned_y + turned_z * turned_z;
      F next2 = turned2;
      if (step > 0 && step < Settling::kPlainSteps)
        next2 *= xsimd::max(turned2 / xsimd::max(before2, close2), least_fall2);
      live = live & exact & (next2 > close2);
      before2 = turned2;
      if (!xsimd::any(live)) break;
    }
    return s;
  }
};

}  // namespace
}  // namespace camber::removal::upright
