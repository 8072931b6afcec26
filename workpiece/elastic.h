#pragma once
// Displacements of a part under loads: linear elasticity on its cells.
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "workpiece/solid.h"

namespace camber::workpiece {

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
