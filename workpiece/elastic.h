#pragma once
// Displacements of a part under loads: linear elasticity on its cells.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "base/geometry.h"
#include "removal/stock.h"

namespace camber::workpiece {

// Stiffness of a cubic cell of which a part is material.

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

// The part as cubic cells: which of them have material, how stiff each is, and where the part is held.

/// A load, or a reading of the displacement, spread over nodes. Weights of a load of 1 N add up to 1.
struct NodeWeights {
  struct Weight {
    std::int32_t node = 0;
    double weight = 0;
  };
  std::vector<Weight> nodes;
  /// Adds `share` of what `other` has.
  void add(const NodeWeights& other, double share);
};

struct SolidOptions {
  double cell_mm = 1;  ///< a whole number of voxels is taken, 1 or more
  double youngs_modulus_MPa = 70000;
  double poisson_ratio = 0.33;
  /// True where the part is held. `bottom`: its lowest level is held as well.
  std::function<bool(const Vec3&)> held{};
  bool bottom = true;
  /// Stiffness of the fixture in every direction; not given: it does not move.
  std::optional<double> fixture_stiffness_N_per_mm{};
};

/// Cells of a stock's material. A cell that the surface crosses has the stiffness of its material alone, integrated
/// over it voxel by voxel: walls may stand anywhere in the grid.
class Solid {
 public:
  struct Cell {
    std::array<std::int32_t, 8> node;
    std::int32_t kind = 0;             ///< index into kinds(): cells of the same filling share a stiffness
    std::array<std::int32_t, 3> at{};  ///< indices of the cell in the grid
  };

  /// Cells of less than a two-hundredth of material are left out, and what hangs on nothing that is held.
  Solid(const removal::Stock& stock, const SolidOptions& options);

  double cell_mm() const { return cell_mm_; }
  const std::vector<Cell>& cells() const { return cells_; }
  std::size_t node_count() const { return node_at_.size(); }
  const std::vector<std::array<std::int32_t, 3>>& node_places() const { return node_at_; }
  Vec3 node_mm(std::size_t node) const;
  /// Stiffness by unit(), see stiffness_unit_N_per_mm().
  const std::vector<CellMatrix>& kinds() const { return kinds_; }
  /// E c / 2, by which kinds() are to be multiplied.
  double stiffness_unit_N_per_mm() const { return unit_N_per_mm_; }
  /// Volume of the layer of voxels by which the part is held, mm^3. Zero: the part is loose.
  double held_mm3() const { return held_mm3_; }
  /// First cell of each layer across x, and the number of all.
  const std::vector<std::size_t>& layers() const { return layers_; }

  /// Nodes whose displacements give that of a point: those of the cell around it, or of the nearest within two cells.
  /// Empty where there is none.
  NodeWeights at(const Vec3& point_mm) const;

 private:
  std::int32_t cell_at(const std::array<std::int32_t, 3>& at) const;
  std::size_t place_of(const std::array<std::int32_t, 3>& at) const;
  void drop_loose(const std::vector<bool>& holds);
  void number_nodes();

  double cell_mm_ = 1, unit_N_per_mm_ = 1, held_mm3_ = 0;
  Vec3 origin_mm_ = Vec3::Zero();
  std::array<std::int32_t, 3> size_{};
  std::vector<Cell> cells_;
  std::vector<std::int32_t> cell_at_;  ///< [size x][size y][size z], -1: none
  std::vector<CellMatrix> kinds_;
  std::vector<std::array<std::int32_t, 3>> node_at_;
  std::vector<std::size_t> layers_;
};

/// A force of 1 N along a direction, spread over nodes.
struct Load {
  NodeWeights where;
  Vec3 direction = Vec3::UnitZ();
};

struct ElasticOptions {
  double tolerance = 1e-6;  ///< tolerance of the residual against the load
  int max_iterations = 400;
};

/// How a solution went.
struct ElasticSummary {
  int iterations = 0;
  double residual = 0;  ///< against the load; the largest of all loads
  bool solved = true;
};

/// Displacements under one load of 1 N, mm: [nodes][3].
using Displacements = std::vector<double>;

/// Conjugate gradients, without a matrix on the cells themselves. The preconditioner is a multigrid of aggregates: of
/// three by three by three nodes that hang together one becomes a rigid body of the next level, with three
/// displacements and three turns, until few are left. Unlike a coarser grid of cells, rigid bodies bend in a chain as a
/// thin wall does. Each level is smoothed by Chebyshev's polynomial with the blocks of the diagonal, and visited twice
/// with conjugate gradients of its own (K-cycle).
/// Sources: Notay & Vassilevski, Recursive Krylov-based multigrid cycles, Numer. Linear Algebra Appl. 15 (2008)
/// 473-487; Adams et al., Parallel multigrid smoothing: polynomial versus Gauss-Seidel, J. Comput. Phys. 188 (2003)
/// 593-610.
/// Several loads are solved side by side. Results do not depend on the number of threads.
class Elastic {
 public:
  explicit Elastic(const Solid& solid);
  ~Elastic();
  Elastic(Elastic&&) noexcept;

  /// One result per load. Requires a part that is held.
  std::vector<Displacements> solve(std::span<const Load> loads, const ElasticOptions& options,
                                   ElasticSummary* summary = nullptr) const;

  /// Strain energy of displacements, N mm: u^T K u / 2, without that of the fixture's springs if they yield.
  double energy_Nmm(const Displacements& u) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

Vec3 displacement_mm(const NodeWeights& where, const Displacements& u);

/// Memory of a solution, bytes; loads side by side.
std::size_t elastic_memory_bytes(std::size_t cells, std::size_t loads);

}  // namespace camber::workpiece
