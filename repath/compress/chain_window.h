#pragma once
// The cheapest chain over a stretch: every pair of some points is tried.
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "repath/compress/block_joints.h"
#include "repath/compress/fit.h"

namespace camber::repath {

// Chains whose arcs have not chosen their bulge yet: what a search for chains without kinks goes over.

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

/// Fewer primitives are better, among as many shorter lines; or, where primitives_per_line_mm is more than zero, the
/// lesser sum of primitives and lines.
struct ChainCost {
  std::size_t primitives = 0;
  double lines_mm = 0;
  double primitives_per_line_mm = 0;

  bool operator<(const ChainCost& other) const;
  ChainCost with(const Polyline& path, const Primitive& p) const;
};

/// What may stand for a stretch behind `before`: a line; an arc where no line does, or where it lies nearer to the
/// points by a third. What is straight to an increment stays a line.
std::array<std::optional<Bent>, 2> line_or_arc(const Bends& bends, const Bent& before, const Bends::Section& stretch);

/// Chains without a corner inside.
class ChainWindow {
 public:
  ChainWindow(const Polyline& path, const FitOptions& options, const Fitter& fitter, const PieceJoints& joints)
      : path_(path), options_(options), joints_(joints), bends_(path, options, fitter, joints) {}

  struct Limits {
    double max_deviation_mm = 0;
    std::size_t max_primitives = 0;
    double primitives_per_line_mm = 0;  ///< see ChainCost
  };

  /// The best chain from the end of `before` to the last of the points, `ends`, ascending, at which primitives may end;
  /// it joins `before` and, where there is one, `behind`. Empty, and a cost beyond the limits, where there is none.
  /// Several chains to a point are kept where kinks are bounded: cheaper ones, and ones of other directions.
  std::vector<Primitive> best(const Primitive& before, const Primitive* behind, std::span<const std::uint32_t> ends,
                              const Limits& limits, ChainCost& cost);

 private:
  struct State {
    ChainCost cost;
    Bent bent;
    std::size_t before = 0;
  };

  bool reach(std::size_t from, std::size_t to, std::uint32_t begin, std::uint32_t end, const Limits& limits);
  void keep(std::vector<std::size_t>& here, const State& state);
  std::vector<Primitive> chain_to(const std::vector<std::size_t>& here, const Primitive* behind, ChainCost& cost) const;

  const Polyline path_;
  const FitOptions& options_;
  const PieceJoints& joints_;
  Bends bends_;
  std::vector<State> states_;
  std::vector<std::vector<std::size_t>> at_;  ///< states that end at the begin, and at each of the ends
};

}  // namespace camber::repath
