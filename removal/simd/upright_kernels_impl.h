#pragma once
// The loops behind removal/simd/upright_kernels.h for one instruction set. Included by the files that are compiled for
// one; nothing else of ours is included, as what is compiled here for wide vectors must not be linked into code for
// narrow ones.
#include <cmath>

#include <xsimd/xsimd.hpp>

#include "removal/field/rounded_cutter.h"
#include "removal/simd/arena_lanes.h"
#include "removal/simd/deflection_lanes.h"
#include "removal/simd/upright_kernels.h"
#include "removal/simd/vector_table.h"

namespace camber::removal::upright {
namespace {

template <class A>
struct Vectors {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  using Mask = xsimd::batch_bool<float, A>;
  static constexpr int n = static_cast<int>(F::size);
  static constexpr int kSide = 17;  ///< Tile::kSide
  static constexpr float kFar = 2;  ///< voxels: no cell with a surface in it reaches so far

  static F load(const float* p) { return F::load_unaligned(p); }
  static I load(const std::int32_t* p) { return I::load_unaligned(p); }
  static I to_int(const F& f) { return xsimd::batch_cast<std::int32_t>(f); }
  static F to_float(const I& i) { return xsimd::batch_cast<float>(i); }

  using Deflection = typename DeflectionLanes<A>::Deflection;
  static Deflection at(const float* row, const I& node_offset, const I& step) {
    return DeflectionLanes<A>::at(row, node_offset, step);
  }
  static Deflection between(const float* row, const I& lower, const I& upper, const F& share, const I& step) {
    const Deflection a = at(row, lower, step), b = at(row, upper, step);
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
  }

  /// Motion of a point of the tool since the stamp before.
  struct Motion {
    F x, y, z;
  };
  static Motion motion_of(const StampPlace& s, const F&, const F&, const F&) {
    return {F(s.feed_mm[0]), F(s.feed_mm[1]), F(s.feed_mm[2])};
  }
  static Motion motion_of(const TiltedPlace& s, const F& x, const F& y, const F& z) {
    const Motion tip = motion_of(s.tip, x, y, z);
    const F wx(s.turn_rad[0]), wy(s.turn_rad[1]), wz(s.turn_rad[2]);
    return {tip.x + wy * z - wz * y, tip.y + wz * x - wx * z, tip.z + wx * y - wy * x};
  }

  /// Place of a point, voxels from the stamp's.
  struct InVoxels {
    F x, y, z;
  };
  static InVoxels in_voxels(const StampPlace& s, const F& x, const F& y, const F& z) {
    const F per_voxel(s.per_voxel);
    return {F(s.fraction[0]) + x * per_voxel, F(s.fraction[1]) + y * per_voxel, F(s.fraction[2]) + z * per_voxel};
  }
  static InVoxels in_voxels(const TiltedPlace& s, const F& x, const F& y, const F& z) {
    const auto along = [&](int a) {
      return F(s.tip.fraction[a]) + (F(s.voxels[a][0]) * x + F(s.voxels[a][1]) * y + F(s.voxels[a][2]) * z);
    };
    return {along(0), along(1), along(2)};
  }

  static F max_tilt_mm(const StampPlace&, const StampBend& b, const Motion&) { return F(b.max_tilt_mm); }
  static F max_tilt_mm(const TiltedPlace& s, const StampBend&, const Motion& m) {
    return F(s.max_tilt) * xsimd::sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
  }

  /// The least motion bound of a point that is read, deflections apart.
  static F raised(const StampPlace&, const F& least, const Motion&) { return least; }
  static F raised(const TiltedPlace& s, const F& least, const Motion& m) {
    return least + F(s.min_cap_per_mm) * (m.x * m.x + m.y * m.y + m.z * m.z);
  }

  static const StampPlace& tip_of(const StampPlace& s) { return s; }
  static const StampPlace& tip_of(const TiltedPlace& s) { return s.tip; }

  template <class Place>
  static void read_points(const PointLanes& p, int from, int count, const Place& s, const StampBend& b,
                          const ArenaView& arena, LaneReading& out) {
    const F zero(0.0f), one(1.0f);
    for (int l = 0; l < count; l += n) {
      const int k = from + l;
      F x = load(p.x + k), y = load(p.y + k);
      F z = load(p.z + k);
      const F nx = load(p.nx + k), ny = load(p.ny + k), nz = load(p.nz + k);
      const F cosine_phi = load(p.cos_phi + k), sine_phi = load(p.sin_phi + k);
      const Motion f = motion_of(s, x, y, z);
      F mx = f.x, my = f.y, mz = f.z, tilt = zero;
      if (b.deflection.now) {
        const I lower = load(p.lower + k), step = load(p.step + k), steps(b.deflection.steps);
        const I lower_at = lower * steps;
        const I upper_at = xsimd::min(lower + I(1), I(b.deflection.nodes - 1)) * steps;
        const F share = load(p.upper_fraction + k);
        const Deflection low = at(b.deflection.now, lower_at, step), high = at(b.deflection.now, upper_at, step);
        const Deflection now{low.x + share * (high.x - low.x), low.y + share * (high.y - low.y)};
        const Deflection before = between(b.deflection.before, lower_at, upper_at, share, step);
        // How much less the motion goes along the deflected envelope's normal than along n: n_bent = n - sum over the
        // surface directions e of e (d(deflection)/de . n).
        const I next = xsimd::select(step + I(1) == steps, I(0), step + I(1));
        const I last = xsimd::select(step == I(0), steps - I(1), step - I(1));
        const Deflection ahead = between(b.deflection.now, lower_at, upper_at, share, next);
        const Deflection behind = between(b.deflection.now, lower_at, upper_at, share, last);
        F by_step = (ahead.x - behind.x) * nx + (ahead.y - behind.y) * ny;
        if (b.deflection.axial) {
          const I axial_at(b.deflection.nodes * b.deflection.steps);
          const Deflection own = at(b.deflection.now, axial_at, step), from = at(b.deflection.now, axial_at, last);
          by_step += (own.y - from.x) * nz;
          z += own.x;
          mz += own.x - at(b.deflection.before, axial_at, step).x;
        }
        const F by_angle = F(b.per_rad) * by_step;
        const F by_height = ((high.x - low.x) * nx + (high.y - low.y) * ny) / F(b.deflection.node_step_mm);
        const F sine = load(p.sine + k);
        const F around = cosine_phi * f.y - sine_phi * f.x;
        const F up = load(p.cosine + k) * (cosine_phi * f.x + sine_phi * f.y) + sine * f.z;
        tilt = around * by_angle * load(p.per_radius + k) + up * sine * (by_height - F(b.lag_per_mm) * by_angle);
        const F most = max_tilt_mm(s, b, f);
        tilt = xsimd::min(xsimd::max(tilt, -most), most);
        tilt = xsimd::select(sine < F(BlockBounds::kLevel), zero, tilt);
        x += now.x, y += now.y;
        mx += now.x - before.x, my += now.y - before.y;
      }
      const F along = mx * nx + my * ny + mz * nz - tilt;
      const F tangential2 = xsimd::max(zero, mx * mx + my * my + mz * mz - along * along);
      const F around = cosine_phi * my - sine_phi * mx, around2 = around * around;
      const F cap =
          along + F(0.5f) * (load(p.k1 + k) * xsimd::max(zero, tangential2 - around2) + load(p.k2 + k) * around2);
      const InVoxels g = in_voxels(s, x, y, z);
      const F bx = xsimd::floor(g.x), by = xsimd::floor(g.y), bz = xsimd::floor(g.z);
      // A lateral deflection brings a point nearer to the material across the axis alone, an axial one along it.
      const F lateral = xsimd::sqrt(nx * nx + ny * ny);
      const F least = -F(b.reach_mm) * lateral - F(b.axial_reach_mm) * xsimd::abs(nz);
      const auto forward = cap > raised(s, least, {mx, my, mz});
      if (!xsimd::any(forward)) {
        I(-1).store_unaligned(out.cell + l);
        continue;
      }
      const I cell = ArenaLanes<A>::cell_of(tip_of(s), arena, bx, by, bz);
      const F u = g.x - bx, v = g.y - by, w = g.z - bz;
      const F field = ArenaLanes<A>::field_at(arena.distance, cell, u, v, w);
      cap.store_unaligned(out.cap + l);
      field.store_unaligned(out.field + l);
      u.store_unaligned(out.fraction[0] + l), v.store_unaligned(out.fraction[1] + l),
          w.store_unaligned(out.fraction[2] + l);
      xsimd::select(to_int(xsimd::select(forward, one, zero)) == I(1), cell, I(-1)).store_unaligned(out.cell + l);
    }
  }

  static void thin_pairs(const PairLanes& p, float flat, float corner, float min_slope) {
    const F zero(0.0f), tiny(1e-12f);
    const RoundedCutter<F> cutter{F(flat), F(corner)};
    for (int l = 0; l < p.count; l += n) {
      F x = load(p.x + l), y = load(p.y + l), z = load(p.z + l);
      const F nx = load(p.nx + l), ny = load(p.ny + l);
      if (p.rows.now) {
        const F known = load(p.known + l);
        const Deflection guess{load(p.guess_x + l), load(p.guess_y + l), load(p.guess_z + l)};
        const Deflection s = DeflectionLanes<A>::settled_at({flat, corner, p.lag_per_mm, p.steps_per_rad}, p.rows,
                                                            load(p.row + l), x, y, z, guess);
        x -= known * s.x, y -= known * s.y;
        x.store_unaligned(p.x + l), y.store_unaligned(p.y + l);
        if (p.rows.axial) {
          z -= known * s.z;
          z.store_unaligned(p.z + l);
        }
      }
      const F rho = xsimd::sqrt(x * x + y * y);
      const auto place = cutter.place(rho, z);
      const auto normal = cutter.normal(place);
      const F depth = place.distance - load(p.farther + l);
      const F outward = (x * nx + y * ny) / xsimd::max(rho, tiny);
      const F fall = normal.radial * outward - normal.down * load(p.nz + l);
      const F slope = xsimd::min(xsimd::max(fall, F(min_slope)), F(1.0f));
      (depth / slope).store_unaligned(p.thickness + l);
    }
  }

  /// Deflection of the envelope's point that is displaced to a place.
  static Deflection settled_at(const LineCut& c, const LineDeflection& b, const F& x, const F& y, const F& z,
                               const Deflection& guess, const Mask& exact) {
    return DeflectionLanes<A>::settled_at({c.flat, c.corner, b.lag_per_mm, b.steps_per_rad}, b.deflection, I(0), x, y,
                                          z, guess, exact);
  }

  /// Calls f(first voxel of a vector) for all of a column from `low` up to `top`; the lowest vectors may overlap.
  template <class Function>
  static void for_vectors(int low, int top, Function f) {
    for (int k = top - n; k > low - n; k -= n) f(k > 0 ? k : 0);
  }

  /// Height above the tip from which on a column at qx outside the flat comes within `reach` of the envelope.
  static float lowest_reached(float qx, float corner, float reach) {
    if (qx <= 0) return corner - reach;
    const float left = reach * reach - qx * qx;
    return left > 0 ? corner - std::sqrt(left) : corner;
  }

  static F distance(const F& rho, const F& z, float flat, float corner) {
    return RoundedCutter<F>{F(flat), F(corner)}.distance(rho, z);
  }

  static F ramp() {
    alignas(64) float first[n];
    for (int l = 0; l < n; ++l) first[l] = static_cast<float>(l);
    return F::load_aligned(first);
  }

  /// One vector of a column: takes v where it is more.
  static bool take(float* distance, std::int32_t* stamp, const F& v, std::int32_t id) {
    const F old = load(distance);
    const auto cut = v > old;
    if (!xsimd::any(cut)) return false;
    xsimd::select(cut, v, old).store_unaligned(distance);
    const auto bits = xsimd::select(cut, F(1.0f), F(0.0f));
    const I ids = load(stamp);
    xsimd::select(to_int(bits) == I(1), I(id), ids).store_unaligned(stamp);
    return true;
  }

  /// Position of the straight cutter relative to the columns of a line: its axis, and the first voxel that it reaches.
  struct Columns {
    alignas(64) float rho[LineCut::kLine];
    alignas(64) std::int32_t low[LineCut::kLine];

    /// Columns first, first + 1, ... of a vector; dx, dy, z0: from the tips, z0 of voxel 0.
    void find(const LineCut& c, int first, const F& dx, const F& dy, const F& z0) {
      const F zero(0.0f), corner(c.corner), reach(c.band + c.corner - c.shrink), per_voxel(1 / c.voxel);
      const F from_axis = xsimd::sqrt(dx * dx + dy * dy), qx = from_axis - F(c.flat);
      const F left = reach * reach - qx * qx;
      const F lowest =
          xsimd::select(qx <= zero, corner - reach, xsimd::select(left > zero, corner - xsimd::sqrt(left), corner));
      const I up = to_int((lowest - z0) * per_voxel);
      from_axis.store_unaligned(rho + first);
      // Nowhere: above all columns.
      const I none(LineCut::kColumns);
      xsimd::select(to_int(xsimd::select(qx > reach, F(1.0f), zero)) == I(1), none, up).store_unaligned(low + first);
    }
  };

  /// Column j with the straight cutter, voxel 0 at z0 above its tip.
  static void cut_column(const LineCut& c, int j, const Columns& columns, float z0, int lowest, std::int32_t id,
                         LineResult& result) {
    const int low = columns.low[j] > lowest ? columns.low[j] : lowest, top = c.top[j];
    if (low >= top) return;
    result.tried |= 1u << j;
    bool changed = false;
    const F rhos(columns.rho[j]), steps = ramp() * F(c.voxel), band(c.band), shrink(c.shrink);
    for_vectors(low, top, [&](int k) {
      const F z = F(z0 + static_cast<float>(k) * c.voxel) + steps;
      const F v = xsimd::min(-(distance(rhos, z, c.flat, c.corner) + shrink), band);
      changed |= take(c.distance + j * LineCut::kColumns + k, c.stamp + j * LineCut::kColumns + k, v, id);
    });
    if (changed) result.changed |= 1u << j;
  }

  /// Places of columns first, first + 1, ..., from column 0.
  static F along_y(const LineCut& c, int first) { return (F(static_cast<float>(first)) + ramp()) * F(c.voxel); }

  static LineResult cut_line(const LineCut& c) {
    LineResult result;
    Columns columns;
    const F dx(c.dx), z(c.z);
    for (int j = c.first / n * n; j < c.end; j += n) columns.find(c, j, dx, F(c.dy) + along_y(c, j), z);
    for (int j = c.first; j < c.end; ++j)
      if (c.changeable[j] > 0) cut_column(c, j, columns, c.z, c.lowest, c.id, result);
    return result;
  }

  static LineResult cut_winners(const LineCut& c, const LineSearch& s, const std::int32_t* id_of_tip) {
    LineResult result;
    Columns columns;
    const F x(s.x);
    for (int j = c.first / n * n; j < c.end; j += n)
      columns.find(c, j, x - load(s.tip_x + j), along_y(c, j) - load(s.tip_y + j), -load(s.tip_z + j));
    for (int j = c.first; j < c.end; ++j) {
      if (!(c.changeable[j] > 0)) continue;
      const int lowest = static_cast<int>((s.tip_z[j] - c.band) / c.voxel);  // below 0: not cut off downwards, but so
      cut_column(c, j, columns, -s.tip_z[j], lowest > 0 ? lowest : 0, c.id + id_of_tip[s.winner[j]], result);
    }
    return result;
  }

  static void find_winners(const LineSearch& s) {
    const bool ball = s.flat <= 0;
    const F zero(0.0f), steps = ramp() * F(s.voxel);
    for (int j = s.first; j < s.end; j += n) {
      const F y = F(static_cast<float>(j) * s.voxel) + steps, z = load(s.z + j);
      F best(1e30f), best_x(zero), best_y(zero), best_z(zero), winner(zero);
      for (int c = 0; c < s.count; ++c) {
        const int t = s.which[c];
        const F tx(s.tips.x[t]), ty(s.tips.y[t]), tz(s.tips.z[t]);
        const F dx = F(s.x) - tx, dy = y - ty, up = z - tz;
        const F rho2 = dx * dx + dy * dy;
        // Of balls the nearest centre.
        const F below = xsimd::min(up - F(s.corner), zero);
        const F rho = xsimd::sqrt(rho2);
        const F rank =
            ball ? rho2 + below * below : covering_rank(distance(rho, up, s.flat, s.corner), tz, rho, F(s.band));
        const auto nearer = rank < best;
        best = xsimd::select(nearer, rank, best);
        best_x = xsimd::select(nearer, tx, best_x);
        best_y = xsimd::select(nearer, ty, best_y);
        best_z = xsimd::select(nearer, tz, best_z);
        winner = xsimd::select(nearer, F(static_cast<float>(t)), winner);
      }
      best_x.store_unaligned(s.tip_x + j), best_y.store_unaligned(s.tip_y + j), best_z.store_unaligned(s.tip_z + j);
      to_int(winner).store_unaligned(s.winner + j);
    }
  }

  /// Depth of places inside the straight cutter, and their largest depth inside one that is deflected by at most
  /// `outwards` in their direction (negative: at least so far inwards), by at most `largest` in any, and by at most
  /// `axial` along the axis. A lateral deflection changes a distance by at most, or at least, its product with the
  /// radial part of the gradient, which grows with the distance from the axis.
  struct Inside {
    F straight, most;
    F radial;  ///< part of the gradient, at most
  };
  static Inside inside_of(const LineCut& c, const F& rho, const F& z, float outwards, const F& largest,
                          const F& axial) {
    const F zero(0.0f), one(1.0f);
    const auto place = RoundedCutter<F>{F(c.flat), F(c.corner)}.place(rho, z);
    const F at_most = place.outside + largest, a = xsimd::max(at_most, zero), below = place.below - axial;
    const F rounded = a / xsimd::max(xsimd::sqrt(a * a + below * below), F(1e-12f));
    const F radial =
        xsimd::select(below > zero, xsimd::min(rounded * F(1.0001f), one), xsimd::select(at_most < below, zero, one));
    F of_outwards = radial;
    if (outwards < 0) {
      const F out = xsimd::max(place.outside, zero), low = place.below + axial;
      const F least = out / xsimd::max(xsimd::sqrt(out * out + low * low), F(1e-12f));
      of_outwards = xsimd::select(low > zero, least * F(0.9999f), xsimd::select(place.outside > low, one, zero));
    }
    return {-place.distance, F(outwards) * of_outwards - place.distance + axial, radial};
  }

  /// How far a deflection moves the bottom downwards in each column of a line, at most. Only the rotation step of an
  /// edge in that direction counts, and those beside it; near the axis a deflection turns a place into another
  /// direction.
  static F downwards(const LineDeflection& deflection, float largest, const F& dx, const F& dy) {
    const DeflectionRow& rows = deflection.deflection;
    const I all(rows.steps), axial_at(rows.nodes * rows.steps);
    const F steps(static_cast<float>(rows.steps));
    F step = DeflectionLanes<A>::atan2(dy, dx) * F(deflection.steps_per_rad);
    step -= steps * xsimd::floor(step / steps);
    I own = to_int(step);
    own = xsimd::select((own >= all) | (own < I(0)), I(0), own);
    const I behind = xsimd::select(own == I(0), all - I(1), own - I(1)),
            ahead = xsimd::select(own + I(1) == all, I(0), own + I(1));
    const Deflection a = at(rows.now, axial_at, behind), b = at(rows.now, axial_at, ahead);
    const F most = -xsimd::min(xsimd::min(a.x, a.y), xsimd::min(b.x, b.y));
    const float turned = largest * deflection.steps_per_rad;  // a step, seen from there
    return xsimd::select(dx * dx + dy * dy > F(turned * turned), most, F(deflection.axial_mm));
  }

  /// The deflections at the feet of the columns of a line: good guesses for all of a column, however wide the vectors
  /// are.
  struct Feet {
    alignas(64) float y[LineCut::kLine], z[LineCut::kLine];
    alignas(64) float guess_x[LineCut::kLine], guess_y[LineCut::kLine], guess_z[LineCut::kLine];
    bool known[LineCut::kLine / n + 1] = {};

    Deflection of(int j, const LineCut& c, const LineDeflection& deflection) {
      if (const int first = j / n * n; !known[j / n]) {
        const F zero(0.0f);
        const Deflection s =
            settled_at(c, deflection, F(c.dx), load(y + first), load(z + first), {zero, zero}, F(1.0f) > zero);
        s.x.store_aligned(guess_x + first), s.y.store_aligned(guess_y + first), s.z.store_aligned(guess_z + first);
        known[j / n] = true;
      }
      return {F(guess_x[j]), F(guess_y[j]), F(guess_z[j])};
    }
  };

  static constexpr float kPassed_mm = 5e-6f;  ///< what a bottom need not go deeper; the field settles within more

  static LineResult cut_line_deflected(const LineCut& c, const LineDeflection& deflection) {
    LineResult result;
    const float per_voxel = 1 / c.voxel, dx2 = c.dx * c.dx;
    const F steps = ramp() * F(c.voxel), band(c.band), dx(c.dx);
    // How far a deflection moves the envelope outwards in each column, at most; near the axis a deflection turns a
    // place into another direction.
    alignas(64) float slack[LineCut::kLine], down[LineCut::kLine];
    const F far_out(kFar * c.voxel + deflection.largest_mm);
    const F largest(deflection.largest_mm), axial(deflection.axial_mm),
        axis_zone2(25 * deflection.largest_mm * deflection.largest_mm);
    for (int j = 0; j < LineCut::kLine; j += n) {
      const F dy = F(c.dy + static_cast<float>(j) * c.voxel) + steps;
      const F at = (DeflectionLanes<A>::atan2(dy, dx) + F(3.14159265f)) *
                   F(static_cast<float>(deflection.sectors) / 6.28318531f);
      const I sector = xsimd::min(xsimd::max(to_int(at), I(0)), I(deflection.sectors - 1));
      const F outward = xsimd::min(Table<A>::gather(deflection.outward_mm, sector), largest);
      xsimd::select(F(dx2) + dy * dy > axis_zone2, outward, largest).store_aligned(slack + j);
      if (deflection.deflection.axial) downwards(deflection, deflection.largest_mm, dx, dy).store_aligned(down + j);
    }
    alignas(64) float rho[LineCut::kLine];
    int low[LineCut::kLine];
    Feet feet;
    for (int j = 0; j < LineCut::kLine; ++j) {
      feet.y[j] = c.dy + static_cast<float>(j) * c.voxel, feet.z[j] = c.z;
      low[j] = LineCut::kColumns;
      if (j >= LineCut::kColumns || !(c.changeable[j] > 0)) continue;
      const float y = feet.y[j], reach = c.corner + c.band + std::max(slack[j], 0.0f);
      rho[j] = std::sqrt(dx2 + y * y);
      const float qx = rho[j] - c.flat;
      if (qx > reach) continue;
      const int up = static_cast<int>((lowest_reached(qx, c.corner, reach) - c.z) * per_voxel);
      low[j] = up > c.lowest ? up : c.lowest;
      feet.z[j] = c.z + static_cast<float>(low[j]) * c.voxel;
    }
    for (int j = 0; j < LineCut::kColumns; ++j) {
      if (low[j] >= c.top[j]) continue;
      const F dy(feet.y[j]), rhos(rho[j]);
      bool changed = false;
      for_vectors(low[j], c.top[j], [&](int k) {
        float* stock = c.distance + j * LineCut::kColumns + k;
        const F z = F(c.z + static_cast<float>(k) * c.voxel) + steps;
        const Inside inside = inside_of(c, rhos, z, slack[j], largest, axial);
        const F old = load(stock);
        auto may = xsimd::min(inside.most, band) > old;
        if (deflection.deflection.axial)
          may = may & !((inside.radial <= F(0.0f)) & (inside.straight + F(down[j] - kPassed_mm) <= old));
        if (!xsimd::any(may)) return;
        result.tried |= 1u << j;
        // Air that no surface is near only has to be known for air; where no deflection counts none is looked for.
        const auto far = inside.straight > far_out;
        const F known = xsimd::min(xsimd::select(far, inside.straight - largest, inside.straight), band);
        F v = known;
        const auto sought = may & !(far | ((inside.radial <= F(0.0f)) & (axial <= F(0.0f))));
        if (xsimd::any(sought)) {
          // So deep in the material a micrometre does not count before another stamp comes nearer.
          const auto exact = sought & (inside.straight > -far_out);
          const Deflection s = settled_at(c, deflection, dx, dy, z, feet.of(j, c, deflection), exact);
          const F x = dx - s.x, yy = dy - s.y;
          v = xsimd::min(-distance(xsimd::sqrt(x * x + yy * yy), z - s.z, c.flat, c.corner), band);
          v = xsimd::select(far, known, v);
        }
        // Where the bound says no, rounding must not say yes.
        changed |= take(stock, c.stamp + j * LineCut::kColumns + k, xsimd::min(v, xsimd::select(may, v, old)), c.id);
      });
      if (changed) result.changed |= 1u << j;
    }
    return result;
  }

  static constexpr Kernels table() {
    return {n,
            &read_points<StampPlace>,
            &read_points<TiltedPlace>,
            &thin_pairs,
            &cut_line,
            &cut_line_deflected,
            &cut_winners,
            &find_winners};
  }
};

}  // namespace
}  // namespace camber::removal::upright
