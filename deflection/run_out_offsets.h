#pragma once
// Run-out of equally spaced teeth, as the offset of the tool axis from the spindle axis at each rotation step. Static
// coupling adds it to the deflection.
#include <cstddef>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "deflection/teeth.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"

namespace camber::deflection {

class RunOutOffsets {
 public:
  /// No run-out.
  RunOutOffsets() = default;
  /// Requires equally spaced teeth (Teeth::evenly_spaced).
  RunOutOffsets(const Teeth& teeth, int steps_per_pitch);

  bool none() const { return offset_mm_.empty(); }
  /// Returns the offsets at the rotation steps of a tooth passing, mm, in the tool's frame; empty without run-out.
  /// `passing` counts from the start of the tool.
  std::span<const Vec2> of(std::size_t passing) const;
  /// Adds `times` the offsets to a row of removal::DeflectionTable, [nodes][steps][2].
  void add(std::size_t passing, float times, std::size_t nodes, std::span<float> row) const;

 private:
  std::size_t steps_ = 0, teeth_ = 1;
  std::vector<Vec2> offset_mm_;  ///< [tooth passings of a turn][steps]
};

// Marks of non-uniform teeth (unequal pitch, run-out): the deflection of the tool at the instant at which each tooth
// passes a point of the envelope.

/// Uniform teeth pass all points of a rotation step at one instant of a tooth passing, so one row of deflections
/// suffices. Non-uniform teeth pass at different instants and with different run-out: their rows contain a deflection
/// for every point of the revolution, as if the tool had one tooth.
class ToothMarks {
 public:
  ToothMarks(const removal::EnvelopeGrid& envelope, const Teeth& teeth);

  /// Returns the cutter with one tooth and no points, for reading the tables.
  const removal::EnvelopeGrid& envelope() const { return envelope_; }

  /// Selects, for stamps from ... from + count - 1, the deflection of each point at the instant at which its tooth
  /// passes. `passing`: number of the stamp `from`. An instant of the passing after the table's last is taken from the
  /// last one.
  removal::DeflectionTable bending(const removal::DeflectionTable& deflections, std::size_t from, std::size_t count,
                                   std::size_t passing) const;
  /// Adds the run-out: the rotation of the cutter axis about the spindle axis.
  void add_run_out(removal::DeflectionTable& deflections, std::size_t passing) const;

 private:
  /// Returns the instant at which a point's tooth passes it, in rotation steps from the start of its passing (`steps`:
  /// per turn); may lie in the passing before (>= a pitch) or the next one (< 0).
  int instant(std::size_t passing, int point, int steps) const;

  removal::EnvelopeGrid envelope_;
  Teeth teeth_;
  int steps_per_pitch_;
};

}  // namespace camber::deflection
