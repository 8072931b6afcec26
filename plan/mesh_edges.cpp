#include "plan/mesh_edges.h"

#include <algorithm>

namespace camber::plan {

MeshEdges::MeshEdges(const Solid& solid) : neighbours(3 * solid.triangles.size(), kNone) {
  struct Edge {
    std::uint32_t low, high, place;
    bool operator<(const Edge& o) const {
      return low != o.low ? low < o.low : high != o.high ? high < o.high : place < o.place;
    }
  };
  std::vector<Edge> edges;
  edges.reserve(neighbours.size());
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = solid.triangles[t][e], b = solid.triangles[t][(e + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<std::uint32_t>(3 * t + e)});
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t end = i + 1;
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    if (end == i + 2) {
      neighbours[edges[i].place] = edges[i + 1].place / 3;
      neighbours[edges[i + 1].place] = edges[i].place / 3;
    }
    i = end;
  }
}

}  // namespace camber::plan
