#pragma once
// Sharp edges of a blank. Its field is read trilinearly, which rounds an edge: the material ends up to a third of a
// voxel short of it, and a point near it takes its chip along a mixture of two normals. In the cells that a convex edge
// runs through, the faces that meet there are known instead, each continued from the voxels on its own side.
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/geometry.h"
#include "removal/field/cell.h"

namespace camber::removal {

/// A face of the blank in a cell.
struct EdgeFace {
  Vec3 outwards;     ///< unit
  double lowest_mm;  ///< distance of the cell's lowest voxel from it, negative in material

  /// At a place in voxels from the lowest.
  double at(const Vec3& place, double voxel_mm) const { return lowest_mm + voxel_mm * outwards.dot(place); }
  double distance_mm(const CellShare& share, double voxel_mm) const {
    return at({static_cast<double>(share[0]), static_cast<double>(share[1]), static_cast<double>(share[2])}, voxel_mm);
  }
};

/// The cells of one tile that an edge runs through.
class BlankEdges {
 public:
  static constexpr int kAround = 4;
  /// Reads a cube of kAround voxels a side around a cell, from one voxel below its lowest on.
  using ReadAround = std::function<void(const std::array<int, 3>& cell, float* out)>;

  /// Finds the edges of a tile. `distance`: values of the tile (Tile::kVolume); those of band_mm and more are clipped.
  void find(const float* distance, double voxel_mm, double band_mm, const ReadAround& read);
  /// As find(), for the cells of layer i along x. Requires that the layers below were read in order since clear().
  void find_in_layer(int i, const float* distance, double voxel_mm, double band_mm, const ReadAround& read);
  void clear();
  /// The faces that meet in the cell at this offset in the tile; none where the field is smooth.
  std::span<const EdgeFace> faces(int cell) const;

 private:
  std::vector<std::int32_t> cell_;   ///< rising
  std::vector<std::uint32_t> from_;  ///< their first face
  std::vector<EdgeFace> face_;
};

/// The blank at a point of a cell.
struct BlankCell {
  const float* lowest;  ///< voxel of the cell
  std::span<const EdgeFace> faces;
  CellShare share;
  double voxel_mm;

  /// Calls f(distance, outwards) for the field, or for each face where an edge runs through the cell. Material is where
  /// all distances are negative.
  template <class Function>
  void for_each_face(Function f) const {
    if (faces.empty()) f(static_cast<double>(trilinear(lowest, share)), trilinear_gradient(lowest, share, voxel_mm));
    for (const EdgeFace& face : faces) f(face.distance_mm(share, voxel_mm), face.outwards);
  }
  /// Distance of the place `up_mm` along `axis` from the point, negative in material.
  double distance_mm(double up_mm, const Vec3& axis) const;
};

}  // namespace camber::removal
