#pragma once
// How much a chain may kink where one primitive meets the next, and the sweeps of arcs that keep to it.
#include <optional>
#include <span>
#include <vector>

#include "repath/compress/fit.h"

namespace camber::repath {

/// Signed sweeps that a primitive may have, low to high; of a line both are zero. Over a chord of direction c a sweep s
/// begins at c - s/2 and ends at c + s/2, so an interval of sweeps is an interval of directions at either end.
struct Sweeps {
  double low_rad = 0, high_rad = 0;
};

/// A block of the path as it was.
inline bool is_block(const Primitive& p) { return !p.arc && p.last == p.first + 1; }

/// The rule of FitOptions::max_kink_rad at the joints of one path.
class PieceJoints {
 public:
  /// `corners`: as corners_of says. Both must outlive this.
  PieceJoints(const Polyline& path, const FitOptions& options, const std::vector<bool>& corners);

  /// Whether any joint is bounded at all.
  bool bounded() const { return bounded_; }

  /// Most that two primitives may kink where they meet, rad; infinite at corners and where nothing is bounded. The
  /// blocks of the path as they were may always follow each other.
  double max_kink_rad(const Primitive& before, const Primitive& p) const;

  /// Sets the fraction of a kink between arcs that behind() gives away; rounding of centres takes from the rest.
  void give_away(double fraction) { fraction_tried_ = fraction; }

  /// Returns those sweeps of `p` that some sweep of the primitive before can be joined to; nothing where there is none.
  /// In space the directions from above get what the slopes leave of the kink.
  std::optional<Sweeps> behind(const Primitive& before, const Sweeps& of_before, const Primitive& p,
                               const Sweeps& of_p) const;

  /// The sweep among `of_p` that kinks least against the begin of the primitive behind, as that one is.
  double sweep_towards(const Primitive& p, const Sweeps& of_p, const Primitive& behind) const;

  /// Returns what the free function of that name does, and keeps it for a while: searches ask for the same again.
  double chord_angle_rad(const Primitive& p) const;

  /// Whether two primitives as they are kink no more than they may.
  bool keep(const Primitive& before, const Primitive& p) const;
  bool keep(std::span<const Primitive> chain) const;

 private:
  double rounding_rad(const Primitive& p) const;

  const Polyline path_;
  const std::vector<bool>& corners_;
  double max_kink_rad_, increment_mm_;
  bool bounded_;
  double fraction_tried_ = 1;
  std::vector<double> turn_;         ///< of the path at each of its points, between legs as for corners
  std::vector<double> blocks_turn_;  ///< between the two blocks that meet there
  struct KeptAngle {
    std::uint32_t first = 0, last = 0;
    double angle_rad = 0;
  };
  mutable std::vector<KeptAngle> angles_;  ///< by a hash of the two points
  std::vector<bool> edges_;  ///< points at which it turns more than a little, and much more than beside them
};

/// Direction of the chord; of a full turn half a turn behind the direction at its start.
double chord_angle_rad(std::span<const Vec2> points, const Primitive& p);

/// Edges too gentle for a corner: vertices that turn by more than 5 degrees and three times as much as beside them.
/// Arcs may meet there with a kink, as large as the path's.
std::vector<bool> edges_of(const Polyline& path, const FitOptions& options);

struct Kink {
  double angle_rad = 0;
  std::uint32_t point = 0;  ///< of the path
  bool of_path = false;     ///< at an edge of the path
};
/// The kinks at the joints beside an arc that are no corners of the path.
std::vector<Kink> kinks_beside_arcs(const Polyline& path, const FitOptions& options, std::span<const Primitive> chain);

/// Where joints of a chain kink too much, as after rounding, arcs give way to the blocks as they were, until none does.
void give_way(const PieceJoints& joints, std::vector<Primitive>& chain);

}  // namespace camber::repath
