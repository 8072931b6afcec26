#pragma once
// Holes: what drilling, tapping and boring cycles take out of the stock, and what they ask of the spindle.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "removal/form_error.h"
#include "removal/tool_path.h"
#include "simulate/cut.h"

namespace camber::simulate {

/// Figures of all the holes of a program.
struct HoleFigures {
  removal::HoleCount count;
  double drilled_mm3 = 0;     ///< change of the stock; also part of CutResult::stock_mm3
  double tapped_mm3 = 0;      ///< change of the stock by taps, which make no chips here
  double thrust_max_N = 0;    ///< along the axis, without the chisel edge
  double torque_max_Nmm = 0;  ///< of drilling
  double surface_mm2 = 0;     ///< of the target, that holes made: not judged

  bool any() const { return count.drilled + count.tapped > 0; }
};

/// Drills with one tool, straight down: chips, thrust and torque of the edge below the wall, by the same law as in
/// milling. On a point of half angle p and a lip each flute this is, with f the feed a turn,
///   h = f / z sin p,  M = (ktc h + kte) z D^2 / (8 sin p),  thrust = ((krc h + kre) sin p - (kac h + kae) cos p) z D /
///   (2 sin p),
/// the torque kc f D^2 / 8 and thrust krc f D sin(p) / 2 of the tables where the edge terms are zero. The chisel edge
/// is not in it. A drill does not bend: its margins lead it.
CutResult drill(removal::Stock& stock, const machine::Tool& tool, const machine::Material& material,
                std::span<const removal::Stamp> stamps, std::int32_t first_id, CutOptions options);

/// Carves what a tap's envelope takes: no chips, no forces.
CutResult tap(removal::Stock& stock, const machine::Tool& tool, std::span<const removal::Stamp> stamps,
              std::int32_t first_id, const CutOptions& options);

/// Which stamps of a path make holes.
class HoleStamps {
 public:
  HoleStamps() = default;
  explicit HoleStamps(const removal::StampPath& path);
  bool contains(std::int32_t stamp) const;
  /// Drops the surface that holes of the target made; returns its area, mm^2.
  double drop_from(std::vector<removal::SurfacePoint>& surface) const;

 private:
  std::vector<std::pair<std::int32_t, std::int32_t>> ranges_;  ///< half open, ascending
};

}  // namespace camber::simulate
