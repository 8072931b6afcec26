#include "repath/compress/chain_window.h"

#include <algorithm>
#include <cmath>

namespace camber::repath {
namespace {

/// The fraction of a room that rounding of the centre may need at either side.
constexpr double kMargin = 0.06;

}  // namespace

std::optional<Bent> Bends::behind(const Bent& before, const std::optional<Primitive>& p) const {
  if (!p) return std::nullopt;
  const Bent out = fixed(*p);
  if (!joints_.behind(before.primitive, before.sweeps, *p, out.sweeps)) return std::nullopt;
  return out;
}

Bends::Section Bends::stretch(std::uint32_t first, std::uint32_t last) const {
  const TriedPrimitives& tried = fitter_.tried(first, last);
  Section out{first, last, tried.line, std::nullopt, std::nullopt};
  if (!tried.arc) return out;
  out.arc = tried.arc;
  out.best_sweep = tried.best_sweep;
  if (joints_.bounded()) out.room = tried.room;
  return out;
}

std::optional<Bent> Bends::arc(const Bent& before, const Section& stretch) const {
  if (!stretch.room) return behind(before, stretch.arc);
  const std::uint32_t first = stretch.first, last = stretch.last;
  ArcRoom room = *stretch.room;
  const double margin = kMargin * (room.max_sweep_rad - room.min_sweep_rad);
  const double least = room.direction * (room.min_sweep_rad + margin),
               most = room.direction * (room.max_sweep_rad - margin);
  const Primitive like{.first = first,
                       .last = last,
                       .arc = true,
                       .center_from_start_mm = Vec2(0, 0.5 * (path_.points[last] - path_.points[first]).norm() /
                                                           std::sin(0.5 * room.best_sweep_rad)),
                       .sweep_rad = room.direction * room.best_sweep_rad};
  const auto sweeps =
      joints_.behind(before.primitive, before.sweeps, like, {std::min(least, most), std::max(least, most)});
  if (!sweeps) return std::nullopt;
  room.min_sweep_rad = std::min(std::abs(sweeps->low_rad), std::abs(sweeps->high_rad));
  room.max_sweep_rad = std::max(std::abs(sweeps->low_rad), std::abs(sweeps->high_rad));
  room.best_sweep_rad = std::clamp(room.best_sweep_rad, room.min_sweep_rad, room.max_sweep_rad);
  if (stretch.best_sweep && room.best_sweep_rad == stretch.room->best_sweep_rad) return Bent{*stretch.arc, *sweeps};
  const auto arc = fitter_.arc_in(first, last, room);
  if (!arc) return std::nullopt;
  return Bent{*arc, *sweeps};
}

bool Bends::covers(const Bent& kept, const Bent& other) const {
  constexpr double kSameRad = 1e-12;
  const Primitive &a = kept.primitive, &b = other.primitive;
  if (a.last != b.last) return false;
  if (!joints_.bounded()) return true;
  if (a.arc != b.arc || (is_block(b) && !is_block(a))) return false;
  const double turn = std::remainder(joints_.chord_angle_rad(b) - joints_.chord_angle_rad(a), 2 * kPi);
  return 0.5 * kept.sweeps.low_rad <= turn + 0.5 * other.sweeps.low_rad + kSameRad &&
         turn + 0.5 * other.sweeps.high_rad <= 0.5 * kept.sweeps.high_rad + kSameRad;
}

std::vector<Primitive> Bends::settled(std::span<const Bent> chain, const Primitive* behind) const {
  std::vector<Primitive> out(chain.size());
  if (!joints_.bounded()) {
    std::transform(chain.begin(), chain.end(), out.begin(), [](const Bent& b) { return b.primitive; });
    return out;
  }
  for (std::size_t k = chain.size(); k-- > 0;) {
    out[k] = chain[k].primitive;
    if (k + 1 < chain.size()) behind = &out[k + 1];
    const double was = out[k].sweep_rad;
    if (behind != nullptr && out[k].arc && chain[k].sweeps.low_rad < chain[k].sweeps.high_rad) {
      const Sweeps& may = chain[k].sweeps;
      const double wish = joints_.sweep_towards(out[k], may, *behind);
      // Rounding may spoil one or the other: the first that joins, else the first that holds the tolerance.
      std::optional<Primitive> holds;
      for (const double sweep : {wish, wish + 0.1 * (was - wish), wish + 0.3 * (was - wish), 0.5 * (wish + may.low_rad),
                                 0.5 * (wish + may.high_rad), was}) {
        const auto arc = fitter_.arc_with_sweep(out[k].first, out[k].last, sweep > 0 ? 1 : -1, std::abs(sweep));
        if (!arc) continue;
        if (!holds) holds = arc;
        if (!joints_.keep(*arc, *behind)) continue;
        holds = arc;
        break;
      }
      if (holds) out[k] = *holds;
    }
  }
  return out;
}

}  // namespace camber::repath
