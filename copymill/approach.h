#pragma once
// Approach: moves the tool to a pass and into the material.
#include <algorithm>
#include <optional>
#include <vector>

#include "copymill/path_piece.h"
#include "copymill/runner.h"
#include "copymill/standing.h"
#include "copymill/tip_field.h"

namespace camber::copymill {

struct ApproachOptions {
  double clearance_mm = 1;     ///< distance that rapids keep above and beside material
  double more_than_mm = 0.02;  ///< material of less height is ignored
  double link_mm = 0;          ///< longest straight way through material from pass to pass
  bool remembers = false;      ///< keeps the ways of the axis for finish()
};

/// Runs links, entries and passes. Between passes the tool stays down where the straight way is free of the part and
/// leads through air, or is short; else it is lifted over the material on the way. It enters material from the side,
/// through air, if possible; else straight down where the cutter may; else along the pass, which is free of the part at
/// every height above it: in a helix on a closed pass, in a ramp to and fro on an open one. Rapids keep above the
/// runner's ClearHeight.
class Approach {
 public:
  Approach(const OperationCut& cut, const TipField& field, Standing& standing, Runner& runner,
           const ApproachOptions& options)
      : cut_(cut), field_(field), standing_(standing), runner_(runner), options_(options) {}

  /// Cuts the stretches of a pass that meet material.
  Runner::Ended follow(const Pass& pass);
  /// Returns the stretches of a pass that meet material now.
  std::vector<Pass> in_material(const Pass& pass) const;
  /// Cuts the stretches of a pass that the axis has not gone along since forget(), whether or not material is seen
  /// there.
  Runner::Ended finish(const Pass& pass);
  void forget() { ways_.clear(); }
  /// Enters a closed pass that is cut from its beginning on: down through air where none of it meets material, else in
  /// a helix along it. The pass then begins where the tool is, or as near to that as its points allow.
  Runner::Ended enter_ring(Pass& ring);
  /// Lifts the tool over the material on the way to a place, and moves it to the place's X and Y.
  Runner::Ended lift_over(const Vec3& to);
  /// Lowers the tool in rapid to the clearance above a place in air, or above anything that can stand there, then at
  /// the feed.
  Runner::Ended lower_to(const Vec3& to);

 private:
  Runner::Ended cut(const std::vector<Vec3>& points, bool closed, double feed_share = 1);
  Runner::Ended cut_piece(Pass piece);
  bool stays_down(const Vec3& to) const;
  Runner::Ended enter(Pass& piece);
  Runner::Ended rapid_down(const Vec3& to);
  bool nothing_can_stand(const Vec3& tip) const;
  std::optional<Vec3> side_entry(const Vec3& to, const removal::CutterShape& shape, bool surely) const;
  /// Returns the cutter made two cells wider, since cells stand for their middles.
  removal::CutterShape wide() const;
  bool free_way(const Vec3& from, const Vec3& to) const;
  bool in_air(const Vec3& from, const Vec3& to) const;
  double lift_into_air(const Vec3& tip) const;
  double lead_mm() const { return 0.2 * cut_.shape.radius_mm; }
  /// Returns the length of gaps that are passed through in less time than a lift takes (three rapids and an entry).
  double join_mm() const {
    constexpr double kLift_s = 0.3;
    return std::max({2 * cut_.shape.radius_mm, 4.0, kLift_s * cut_.operation.feed_mm_per_s});
  }
  Runner::Ended ramp(Pass& piece, double lift_mm);

  const OperationCut& cut_;
  const TipField& field_;
  Standing& standing_;
  Runner& runner_;
  ApproachOptions options_;
  std::vector<std::vector<Vec3>> ways_;  ///< way of each cut, from its beginning
};

}  // namespace camber::copymill
