#pragma once
// Which triangles meet at an edge.
#include <cstdint>
#include <vector>

#include "plan/solid.h"

namespace camber::plan {

/// neighbours[3 t + e]: the triangle at the edge from corner e to corner e + 1 of triangle t; kNone where there is none
/// or more than one.
struct MeshEdges {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  explicit MeshEdges(const Solid& solid);
  std::uint32_t across(std::size_t triangle, std::size_t edge) const { return neighbours[3 * triangle + edge]; }
  std::vector<std::uint32_t> neighbours;
};

}  // namespace camber::plan
