#pragma once
// How the part yields under the tool, along one run of a tool: as the tool yields, seen from the part.
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"

namespace camber::deflection {

/// Compliance of the part in the tool's frame, at places of a run; linear between them.
///
/// Forces along the edge are gathered at a few heights above the tip, with the weights of linear interpolation, and
/// displacements are read between the same heights. Row and column 2 i + a: at height i along x or y (a = 0, 1); the
/// last one: along the axis, at the lowest height for all. The force on the tool moves the part the opposite way: the
/// tool moves against the part by this compliance times the force on the tool, which adds to its own deflection.
/// Symmetric, without negative eigenvalues.
struct PartCompliance {
  struct Place {
    std::size_t stamp = 0;  ///< number of the stamp in the run
    Eigen::MatrixXd mm_per_N;
  };
  std::vector<double> height_mm;  ///< above the tip, ascending, evenly spaced, two or more, the first 0
  std::vector<Place> places;      ///< ascending, one or more

  std::size_t heights() const { return height_mm.size(); }
  std::size_t size() const { return 2 * heights() + 1; }
  /// At a stamp of the run; before the first place and after the last one as there.
  Eigen::MatrixXd at(std::size_t stamp) const;
};

/// Interpolation weights of the nodes below and above a height over the tip.
struct HeightWeight {
  std::size_t lower = 0;
  double upper_fraction = 0;  ///< weight of node lower + 1, 0 to 1
  double of_lower() const { return 1 - upper_fraction; }
};
HeightWeight height_weight(const PartCompliance& part, double height_mm);

/// Lateral displacement at a height above the tip from displacements as PartCompliance has them.
Vec2 lateral_at(const PartCompliance& part, double height_mm, const Eigen::VectorXd& moved);

}  // namespace camber::deflection
