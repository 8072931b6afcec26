#pragma once
// The envelope of one stamp whose point (s, phi) is displaced by the shift of the instant at which an edge passes it.
#include "removal/carve.h"
#include "removal/cutter.h"
#include "removal/shift_table.h"

namespace camber::removal {

/// One bent stamp. What it is made from must outlive it.
class BentEnvelope {
 public:
  BentEnvelope(const EnvelopeGrid& envelope, const ShiftTable& shifts, const CarveBend& bend, const Vec3& tip_mm)
      : e_(envelope), shifts_(shifts), bend_(bend), tip_(tip_mm) {}

  const Vec3& tip_mm() const { return tip_; }
  const CarveBend& bend() const { return bend_; }

  /// Height above q along n at which q + height n lies on the bent envelope, if that is under `highest`; else
  /// `highest`. mm. removal/mark_kernels.h does the same for many at once.
  double height_mm(const Vec3& q, const Vec3& n, double highest) const;

 private:
  double settled_mm(const Vec3& q, const Vec3& n, double highest, Vec3 bend) const;
  double outward_mm(const Vec3& from_tip) const;
  double envelope_height_mm(const Vec3& p) const;
  Vec3 shift(const Vec3& from_tip) const;

  const EnvelopeGrid& e_;
  const ShiftTable& shifts_;
  const CarveBend& bend_;
  Vec3 tip_;
};

}  // namespace camber::removal
