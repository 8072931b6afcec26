#pragma once
// Chains whose arcs have not chosen their bulge yet: what a search for chains without kinks goes over.
#include <span>
#include <vector>

#include "repath/fit.h"
#include "repath/joints.h"

namespace camber::repath {

/// A primitive that holds the tolerance, and the sweeps that can be joined to what comes before it.
struct Bent {
  Primitive primitive{};
  Sweeps sweeps{};
};

/// `p` as it is, behind nothing.
inline Bent fixed(const Primitive& p) { return {p, {p.sweep_rad, p.sweep_rad}}; }

/// Lines and arcs that may follow a bent primitive. Where nothing is bounded they are those of the fitter.
class Bends {
 public:
  Bends(const Polyline& path, const FitOptions& options, const Fitter& fitter, const PieceJoints& joints)
      : path_(path), options_(options), fitter_(fitter), joints_(joints) {}

  /// What lies between two points, whatever comes before it: no arc where the line is straight to an increment.
  struct Section {
    std::uint32_t first = 0, last = 0;
    std::optional<Primitive> line, arc;
    std::optional<ArcRoom> room;  ///< where the arc's sweep is open
    bool best_sweep = false;      ///< the arc has the room's best sweep
  };
  Section stretch(std::uint32_t first, std::uint32_t last) const;

  std::optional<Bent> line(const Bent& before, const Section& stretch) const { return behind(before, stretch.line); }
  std::optional<Bent> arc(const Bent& before, const Section& stretch) const;

  /// Whether a chain that ends with the first could stand in for one that ends with the second: it ends at the same
  /// point, in all of its directions.
  bool covers(const Bent& kept, const Bent& other) const;

  /// Chooses the sweeps of a chain from its end to its begin, each towards the begin of the one behind it.
  std::vector<Primitive> settled(std::span<const Bent> chain, const Primitive* behind) const;

 private:
  std::optional<Bent> behind(const Bent& before, const std::optional<Primitive>& p) const;

  const Polyline path_;
  const FitOptions& options_;
  const Fitter& fitter_;
  const PieceJoints& joints_;
};

}  // namespace camber::repath
