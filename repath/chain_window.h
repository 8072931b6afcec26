#pragma once
// The cheapest chain over a stretch: every pair of some points is tried.
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "repath/bends.h"

namespace camber::repath {

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
