#pragma once
// Teeth that are not even: where the tool stands as each of them passes a place, for the marks that they leave.
#include <cstddef>

#include "deflection/teeth.h"
#include "removal/cutter.h"
#include "removal/deflection_table.h"

namespace camber::deflection {

/// Even teeth pass all points of a rotation step at one instant of a tooth passing, and a row of that many deflections
/// says all. Of others each comes at its own instant, and stands out by its own throw: their rows hold a deflection for
/// every point of the turn, as if the tool had one tooth.
class ToothMarks {
 public:
  ToothMarks(const removal::EnvelopeGrid& envelope, const Teeth& teeth);

  /// For reading the tables: the cutter, with one tooth, and no points.
  const removal::EnvelopeGrid& envelope() const { return envelope_; }

  /// Takes from the passings' deflections those of stamps from ... from + count - 1, each point's at the instant at
  /// which that tooth is there whose turn it is. `passing`: number of the stamp `from`. An instant of the passing after
  /// the table's last is taken from that one, as if it went on alike.
  removal::DeflectionTable bending(const removal::DeflectionTable& deflections, std::size_t from, std::size_t count,
                                   std::size_t passing) const;
  /// Adds the run-out: the cutter's axis turns about the spindle's.
  void add_run_out(removal::DeflectionTable& deflections, std::size_t passing) const;

 private:
  /// Instant at which a point's tooth passes it, in `steps` of the turn, from the start of its passing; may lie in the
  /// passing before (>= a pitch) or the next one (< 0).
  int instant(std::size_t passing, int point, int steps) const;

  removal::EnvelopeGrid envelope_;
  Teeth teeth_;
  int steps_per_pitch_;
};

}  // namespace camber::deflection
