#pragma once
// The loops behind removal/kernels.h for one instruction set. Included by the files that are compiled for one; nothing
// else of ours is included, as what is compiled here for wide vectors must not be linked into code for narrow ones.
#include <cmath>

#include <xsimd/xsimd.hpp>

#include "removal/kernels.h"
#include "removal/vector_table.h"

namespace camber::removal {
namespace {

template <class A>
struct Vectors {
  using F = xsimd::batch<float, A>;
  using I = xsimd::batch<std::int32_t, A>;
  static constexpr int n = static_cast<int>(F::size);
  static constexpr int kSide = 17;  ///< Tile::kSide
  static constexpr int kCore = 16;

  static F load(const float* p) { return F::load_unaligned(p); }
  static I load(const std::int32_t* p) { return I::load_unaligned(p); }
  static I to_int(const F& f) { return xsimd::batch_cast<std::int32_t>(f); }
  static F to_float(const I& i) { return xsimd::batch_cast<float>(i); }

  struct Shift {
    F x, y;
  };
  static Shift at(const float* row, const I& node_offset, const I& step) {
    const I i = I(2) * (node_offset + step);
    return {Table<A>::gather(row, i), Table<A>::gather(row, i + I(1))};
  }
  static Shift between(const float* row, const I& lower, const I& upper, const F& share, const I& step) {
    const Shift a = at(row, lower, step), b = at(row, upper, step);
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
  }

  static void read_points(const PointLanes& p, int from, int count, const StampView& s, const TileView& tile,
                          LaneReading& out) {
    const F zero(0.0f), one(1.0f);
    for (int l = 0; l < count; l += n) {
      const int k = from + l;
      F x = load(p.x + k), y = load(p.y + k);
      const F z = load(p.z + k), nx = load(p.nx + k), ny = load(p.ny + k), nz = load(p.nz + k);
      const F cosine_phi = load(p.cos_phi + k), sine_phi = load(p.sin_phi + k);
      const F fx(s.feed_mm[0]), fy(s.feed_mm[1]), fz(s.feed_mm[2]);
      F mx = fx, my = fy, tilt = zero;
      if (s.shift.now) {
        const I lower = load(p.lower + k), step = load(p.step + k), steps(s.shift.steps);
        const I lower_at = lower * steps;
        const I upper_at = xsimd::min(lower + I(1), I(s.shift.nodes - 1)) * steps;
        const F share = load(p.upper_share + k);
        const Shift low = at(s.shift.now, lower_at, step), high = at(s.shift.now, upper_at, step);
        const Shift now{low.x + share * (high.x - low.x), low.y + share * (high.y - low.y)};
        const Shift before = between(s.shift.before, lower_at, upper_at, share, step);
        // How much less the motion goes along the bent envelope's normal than along n: n_bent = n - sum over the
        // surface directions e of e (d(shift)/de . n).
        const I next = xsimd::select(step + I(1) == steps, I(0), step + I(1));
        const I last = xsimd::select(step == I(0), steps - I(1), step - I(1));
        const Shift ahead = between(s.shift.now, lower_at, upper_at, share, next);
        const Shift behind = between(s.shift.now, lower_at, upper_at, share, last);
        const F by_angle = F(s.per_rad) * ((ahead.x - behind.x) * nx + (ahead.y - behind.y) * ny);
        const F by_height = ((high.x - low.x) * nx + (high.y - low.y) * ny) / F(s.shift.node_step_mm);
        const F sine = load(p.sine + k);
        const F around = cosine_phi * fy - sine_phi * fx;
        const F up = load(p.cosine + k) * (cosine_phi * fx + sine_phi * fy) + sine * fz;
        tilt = around * by_angle * load(p.per_radius + k) + up * sine * (by_height - F(s.lag_per_mm) * by_angle);
        tilt = xsimd::min(xsimd::max(tilt, F(-s.most_tilt_mm)), F(s.most_tilt_mm));
        tilt = xsimd::select(sine < F(0.05f), zero, tilt);
        x += now.x, y += now.y;
        mx += now.x - before.x, my += now.y - before.y;
      }
      const F along = mx * nx + my * ny + fz * nz - tilt;
      const F tangential2 = xsimd::max(zero, mx * mx + my * my + fz * fz - along * along);
      const F around = cosine_phi * my - sine_phi * mx, around2 = around * around;
      const F cap =
          along + F(0.5f) * (load(p.k1 + k) * xsimd::max(zero, tangential2 - around2) + load(p.k2 + k) * around2);
      const F per_voxel(s.per_voxel);
      const F gx = F(s.fraction[0]) + x * per_voxel, gy = F(s.fraction[1]) + y * per_voxel,
              gz = F(s.fraction[2]) + z * per_voxel;
      const F bx = xsimd::floor(gx), by = xsimd::floor(gy), bz = xsimd::floor(gz);
      const I ix = to_int(bx) - I(tile.from[0]), iy = to_int(by) - I(tile.from[1]), iz = to_int(bz) - I(tile.from[2]);
      const auto inside = (ix >= I(0)) & (ix < I(kCore)) & (iy >= I(0)) & (iy < I(kCore)) & (iz >= I(0)) &
                          (iz < I(kCore)) & (to_int(xsimd::select(cap > zero, one, zero)) == I(1));
      const I cell = xsimd::select(inside, (ix * I(kSide) + iy) * I(kSide) + iz, I(0));
      const F u = gx - bx, v = gy - by, w = gz - bz;
      const auto d = [&](int i, int j, int m) {
        return Table<A>::gather(tile.distance, cell + I((i * kSide + j) * kSide + m));
      };
      const auto along_z = [&](int i, int j) {
        const F a = d(i, j, 0);
        return a + w * (d(i, j, 1) - a);
      };
      const auto along_y = [&](int i) {
        const F a = along_z(i, 0);
        return a + v * (along_z(i, 1) - a);
      };
      const F a = along_y(0), field = a + u * (along_y(1) - a);
      cap.store_unaligned(out.cap + l);
      field.store_unaligned(out.field + l);
      u.store_unaligned(out.fraction[0] + l), v.store_unaligned(out.fraction[1] + l),
          w.store_unaligned(out.fraction[2] + l);
      xsimd::select(inside, cell, I(-1)).store_unaligned(out.cell + l);
    }
  }

  static Thinnest thinnest(const CornerLanes& c, float flat, float corner, float least_slope) {
    alignas(64) float each[8];
    const F zero(0.0f), tiny(1e-12f);
    for (int l = 0; l < 8; l += n) {
      // From the tip to the point.
      const F x = -load(c.tip[0] + l), y = -load(c.tip[1] + l), z = -load(c.tip[2] + l);
      const F rho = xsimd::sqrt(x * x + y * y);
      const F qx = rho - F(flat), qz = F(corner) - z;
      const F a = xsimd::max(qx, zero), b = xsimd::max(qz, zero);
      const F length = xsimd::sqrt(a * a + b * b);
      const F depth = xsimd::min(xsimd::max(qx, qz), zero) + length - F(corner) - load(c.bend + l);
      const auto round = (qx > zero) & (qz > zero);
      const F per_length = F(1.0f) / xsimd::max(length, tiny);
      const F radial = xsimd::select(round, qx * per_length, xsimd::select(qx > qz, F(1.0f), zero));
      const F down = xsimd::select(round, qz * per_length, xsimd::select(qx > qz, zero, F(1.0f)));
      const F outward = (x * F(c.normal[0]) + y * F(c.normal[1])) / xsimd::max(rho, tiny);
      const F fall = radial * outward - down * F(c.normal[2]);
      const F slope = xsimd::min(xsimd::max(fall, F(least_slope)), F(1.0f));
      xsimd::select(load(c.valid + l) > zero, depth / slope, F(1e30f)).store_aligned(each + l);
    }
    Thinnest least{each[0], 0};
    for (int l = 1; l < 8; ++l)
      if (each[l] < least.mm) least = {each[l], l};
    return least;
  }

  /// atan2 to 1e-5 rad: enough to find a rotation step.
  static F fast_atan2(const F& y, const F& x) {
    const F ax = xsimd::abs(x), ay = xsimd::abs(y);
    const F a = xsimd::min(ax, ay) / xsimd::max(xsimd::max(ax, ay), F(1e-20f));
    const F s = a * a;
    F r = ((((F(0.0208351f) * s - F(0.085133f)) * s + F(0.180141f)) * s - F(0.3302995f)) * s + F(0.999866f)) * a;
    r = xsimd::select(ay > ax, F(1.57079633f) - r, r);
    r = xsimd::select(x < F(0.0f), F(3.14159265f) - r, r);
    return xsimd::select(y < F(0.0f), -r, r);
  }

  /// Shift of the envelope's point nearest to a place.
  static Shift shift_at(const LineCut& c, const LineBend& b, const F& x, const F& y, const F& z) {
    const F zero(0.0f);
    const F qx = xsimd::sqrt(x * x + y * y) - F(c.flat), qz = F(c.corner) - z;
    const F length = xsimd::sqrt(qx * qx + qz * qz);
    const F rounded = F(c.corner) - F(c.corner) * qz / xsimd::max(length, F(1e-12f));
    const F height =
        xsimd::select((qx > zero) & (qz > zero), rounded, xsimd::select(qx > qz, xsimd::max(z, zero), zero));
    const F steps(static_cast<float>(b.shift.steps));
    F step = (fast_atan2(y, x) - height * F(b.lag_per_mm)) * F(b.steps_per_rad);
    step -= steps * xsimd::floor(step / steps);
    I m0 = to_int(step);
    const F fm = step - to_float(m0);
    const I all(b.shift.steps);
    m0 = xsimd::select(m0 >= all, I(0), m0);
    const I m1 = xsimd::select(m0 + I(1) == all, I(0), m0 + I(1));
    const F at_node =
        xsimd::min(xsimd::max(height / F(b.shift.node_step_mm), zero), F(static_cast<float>(b.shift.nodes - 1)));
    const I n0 = xsimd::min(to_int(at_node), I(b.shift.nodes > 1 ? b.shift.nodes - 2 : 0));
    const F fn = at_node - to_float(n0);
    const I low = n0 * all, high = b.shift.nodes > 1 ? low + all : low;
    const Shift s00 = at(b.shift.now, low, m0), s01 = at(b.shift.now, low, m1), s10 = at(b.shift.now, high, m0),
                s11 = at(b.shift.now, high, m1);
    const F one(1.0f), w00 = (one - fn) * (one - fm), w01 = (one - fn) * fm, w10 = fn * (one - fm), w11 = fn * fm;
    return {w00 * s00.x + w01 * s01.x + w10 * s10.x + w11 * s11.x,
            w00 * s00.y + w01 * s01.y + w10 * s10.y + w11 * s11.y};
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
    const F zero(0.0f), qx = rho - F(flat), qz = F(corner) - z;
    const F a = xsimd::max(qx, zero), b = xsimd::max(qz, zero);
    return xsimd::min(xsimd::max(qx, qz), zero) + xsimd::sqrt(a * a + b * b) - F(corner);
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

  /// Column j with the straight cutter, its axis at rho, voxel 0 at z0 above its tip.
  static void cut_column(const LineCut& c, int j, float rho, float z0, int lowest, std::int32_t id,
                         LineResult& result) {
    const float reach = c.band + c.corner - c.shrink, qx = rho - c.flat;
    if (qx > reach) return;
    const int up = static_cast<int>((lowest_reached(qx, c.corner, reach) - z0) / c.voxel);
    const int low = up > lowest ? up : lowest, top = c.top[j];
    if (low >= top) return;
    result.tried |= 1u << j;
    bool changed = false;
    const F rhos(rho), steps = ramp() * F(c.voxel), band(c.band), shrink(c.shrink);
    for_vectors(low, top, [&](int k) {
      const F z = F(z0 + static_cast<float>(k) * c.voxel) + steps;
      const F v = xsimd::min(-(distance(rhos, z, c.flat, c.corner) + shrink), band);
      changed |= take(c.distance + j * LineCut::kColumns + k, c.stamp + j * LineCut::kColumns + k, v, id);
    });
    if (changed) result.changed |= 1u << j;
  }

  static LineResult cut_line(const LineCut& c) {
    LineResult result;
    const float dx2 = c.dx * c.dx;
    for (int j = c.first; j < c.end; ++j) {
      if (!(c.changeable[j] > 0)) continue;
      const float dy = c.dy + static_cast<float>(j) * c.voxel;
      cut_column(c, j, std::sqrt(dx2 + dy * dy), c.z, c.lowest, c.id, result);
    }
    return result;
  }

  static LineResult cut_winners(const LineCut& c, const LineSearch& s, const std::int32_t* id_of_tip) {
    LineResult result;
    for (int j = c.first; j < c.end; ++j) {
      if (!(c.changeable[j] > 0)) continue;
      const float dx = s.x - s.tip_x[j], dy = static_cast<float>(j) * c.voxel - s.tip_y[j];
      const int lowest = static_cast<int>((s.tip_z[j] - c.band) / c.voxel);  // below 0: not cut off downwards, but so
      cut_column(c, j, std::sqrt(dx * dx + dy * dy), -s.tip_z[j], lowest > 0 ? lowest : 0,
                 c.id + id_of_tip[s.winner[j]], result);
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
        const F rank = ball ? rho2 + below * below : distance(xsimd::sqrt(rho2), up, s.flat, s.corner);
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

  static LineResult cut_line_bent(const LineCut& c, const LineBend& bend) {
    LineResult result;
    const float per_voxel = 1 / c.voxel, dx2 = c.dx * c.dx;
    const F steps = ramp() * F(c.voxel), band(c.band), dx(c.dx);
    // How far a shift moves the envelope outwards in each column; near the axis a shift turns a place into another
    // direction.
    alignas(64) float slack[LineCut::kLine];
    const F largest(bend.largest_mm), axis_zone2(25 * bend.largest_mm * bend.largest_mm);
    for (int j = 0; j < LineCut::kLine; j += n) {
      const F dy = F(c.dy + static_cast<float>(j) * c.voxel) + steps;
      const F at = (fast_atan2(dy, dx) + F(3.14159265f)) * F(static_cast<float>(bend.sectors) / 6.28318531f);
      const I sector = xsimd::min(xsimd::max(to_int(at), I(0)), I(bend.sectors - 1));
      const F outward = xsimd::min(Table<A>::gather(bend.outward_mm, sector), largest);
      xsimd::select(F(dx2) + dy * dy > axis_zone2, outward, largest).store_aligned(slack + j);
    }
    for (int j = 0; j < LineCut::kColumns; ++j) {
      if (!(c.changeable[j] > 0)) continue;
      const float y = c.dy + static_cast<float>(j) * c.voxel, reach = c.corner + c.band + slack[j];
      const float rho = std::sqrt(dx2 + y * y), qx = rho - c.flat;
      if (qx > reach) continue;
      const int up = static_cast<int>((lowest_reached(qx, c.corner, reach) - c.z) * per_voxel);
      const int low = up > c.lowest ? up : c.lowest, top = c.top[j];
      if (low >= top) continue;
      const F dy(y), rhos(rho), outwards(slack[j]);
      bool changed = false;
      for_vectors(low, top, [&](int k) {
        float* stock = c.distance + j * LineCut::kColumns + k;
        const F z = F(c.z + static_cast<float>(k) * c.voxel) + steps;
        const F most = xsimd::min(outwards - distance(rhos, z, c.flat, c.corner), band);
        const F old = load(stock);
        if (!xsimd::any(most > old)) return;
        result.tried |= 1u << j;
        Shift s = shift_at(c, bend, dx, dy, z);
        s = shift_at(c, bend, dx - s.x, dy - s.y, z);
        const F x = dx - s.x, yy = dy - s.y;
        const F v = xsimd::min(-distance(xsimd::sqrt(x * x + yy * yy), z, c.flat, c.corner), band);
        // Where the bound says no, rounding must not say yes.
        changed |=
            take(stock, c.stamp + j * LineCut::kColumns + k, xsimd::min(v, xsimd::select(most > old, v, old)), c.id);
      });
      if (changed) result.changed |= 1u << j;
    }
    return result;
  }

  static constexpr Kernels table() {
    return {n, &read_points, &thinnest, &cut_line, &cut_line_bent, &cut_winners, &find_winners};
  }
};

}  // namespace
}  // namespace camber::removal
