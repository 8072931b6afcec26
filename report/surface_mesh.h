#pragma once
// The machined surface as a mesh for the page, made of the points at which grid lines cross it.
#include <array>
#include <cstdint>
#include <vector>

#include "report/surface_samples.h"

namespace camber::report {

struct SurfaceMesh {
  /// Places and normals are means over a cell's points. The errors (and their lines) are those of greatest magnitude,
  /// before and after each for itself.
  std::vector<SurfaceSample> vertices;
  std::vector<std::array<std::uint32_t, 4>> quads;  ///< indices into vertices; the last may repeat the first (triangle)
  double cell_mm = 0;                               ///< width of the cells that a vertex stands for
};

/// Surface nets: a vertex for every cell of the grid that the surface passes, a quadrangle for every grid edge that it
/// crosses. The samples must lie on the lines of a grid of `grid_mm` through the origin
/// (removal::SurfacePoint::crossing_mm).
/// Where that would be more than `max_vertices`, cells are taken together in cubes of 2, 3, ... a side.
/// Source: Gibson, Constrained elastic surface nets, MICCAI 1998 (without the relaxation).
SurfaceMesh surface_mesh(const SurfaceSamples& samples, double grid_mm, std::size_t max_vertices);

}  // namespace camber::report
