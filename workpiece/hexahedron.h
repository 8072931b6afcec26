#pragma once
// Stiffness of a cubic cell of which a part is material.
#include <array>

#include <Eigen/Core>

#include "base/geometry.h"

namespace camber::workpiece {

/// Integrals over a part of a cell, in the cell's coordinates x, y, z from -1 to 1: at moment_index(a, b, c) that of
/// x^a y^b z^c, a, b, c from 0 to 2. The first is the volume, 8 for a whole cell.
using Moments = std::array<double, 27>;
constexpr std::size_t moment_index(int a, int b, int c) { return static_cast<std::size_t>((a * 3 + b) * 3 + c); }
Moments moments_of_whole_cell();

/// By the eight nodes, node x + 2 y + 4 z with x, y, z 0 or 1, of each the displacements along x, y and z.
using CellMatrix = Eigen::Matrix<double, 24, 24>;

/// The eight trilinear shape functions at a place in the cell's coordinates.
std::array<double, 8> shape_functions(const Vec3& place);

/// Eight nodes, and nine inner displacements 1 - x^2, 1 - y^2, 1 - z^2 that are eliminated: without them a cell is far
/// too stiff in bending, with them one cell through the thickness bends like a plate. Their strains have the mean zero
/// over the material, so that the patch test holds in a cell of any filling.
/// Sources: Taylor, Beresford & Wilson, A non-conforming element for stress analysis, Int. J. Num. Meth. Eng. 10 (1976)
/// 1211-1219; integrals over the filled part of a cell: Parvizian, Duester & Rank, Finite cell method, Comput. Mech. 41
/// (2007) 121-133.
class Hexahedron {
 public:
  explicit Hexahedron(double poisson_ratio);

  /// Stiffness matrix of the material that has these moments, for Young's modulus 1 and cells 2 wide; K = E c / 2
  /// times this in cells of width c. Where the cell is empty it counts as kVoid of the material.
  CellMatrix stiffness(const Moments& material) const;
  static constexpr double kVoid = 1e-4;

  /// The integral of N^T N over the part that has these moments: an elastic bed under it.
  static CellMatrix bed(const Moments& held);

 private:
  static constexpr int kNodal = 24, kInner = 9, kAll = kNodal + kInner;
  using Strain = Eigen::Matrix<double, 6, kAll>;
  using Whole = Eigen::Matrix<double, kAll, kAll>;

  Eigen::Matrix<double, 6, 6> elasticity_;
  std::array<Strain, 8> strain_;     ///< by x^a y^b z^c, a, b, c 0 or 1
  std::array<Whole, 27> by_moment_;  ///< the stiffness of each moment
};

}  // namespace camber::workpiece
