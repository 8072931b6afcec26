#pragma once
// How the tool gets to a pass and into the material.
#include "copymill/pass.h"
#include "copymill/runner.h"
#include "copymill/standing.h"
#include "copymill/tip_field.h"

namespace camber::copymill {

struct ApproachOptions {
  double clearance_mm = 1;     ///< above and beside material; rapids keep this away
  double more_than_mm = 0.02;  ///< material of less height is not met
  double link_mm = 0;          ///< longest straight way through material from pass to pass
};

/// Links, entries and the passes themselves. Between passes the tool stays down where the straight way is free of the
/// part and leads through air, or is short; else it is lifted over what stands on the way. Into material it goes from
/// the side, through air, where that can be; else straight down where the cutter may; else down along the pass itself,
/// which is free of the part at every height above it: a helix on a closed pass, a ramp to and fro on an open one.
class Approach {
 public:
  Approach(const Cut& cut, const TipField& field, Standing& standing, Runner& runner, const ApproachOptions& options)
      : cut_(cut), field_(field), standing_(standing), runner_(runner), options_(options) {}

  /// Cuts the stretches of a pass that meet material.
  Runner::Ended follow(const Pass& pass);
  /// To a closed pass that is cut from its beginning on: down through air where none of it meets material, else in a
  /// helix along it. Begins the pass where the tool is then, or as near to that as its points allow.
  Runner::Ended enter_ring(Pass& ring);
  /// Up, over what stands on the way to a place, and to its X and Y.
  Runner::Ended lift_over(const Vec3& to);
  /// Down in rapid to the clearance above a place in air, and on at the feed.
  Runner::Ended lower_to(const Vec3& to);

 private:
  Runner::Ended cut_piece(Pass piece);
  bool stays_down(const Vec3& to) const;
  Runner::Ended enter(Pass& piece);
  std::optional<Vec3> side_entry(const Vec3& to, const removal::CutterShape& shape) const;
  /// Two cells wider: cells stand for their middles, and where the tool comes down in rapid, the tip of what stands may
  /// reach beyond them.
  removal::CutterShape wide() const;
  bool free_way(const Vec3& from, const Vec3& to) const;
  bool in_air(const Vec3& from, const Vec3& to) const;
  double lift_into_air(const Vec3& tip) const;
  Runner::Ended ramp(Pass& piece, double lift_mm);

  const Cut& cut_;
  const TipField& field_;
  Standing& standing_;
  Runner& runner_;
  ApproachOptions options_;
};

}  // namespace camber::copymill
