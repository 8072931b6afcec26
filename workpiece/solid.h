#pragma once
// The part as cubic cells: which of them have material, how stiff each is, and where the part is held.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "removal/stock.h"
#include "workpiece/hexahedron.h"

namespace camber::workpiece {

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

}  // namespace camber::workpiece
