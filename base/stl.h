#pragma once
// Triangle meshes from STL files.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/geometry.h"

namespace camber {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> points;  ///< mm, equal ones joined
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// True if every edge has exactly two triangles, of opposite direction.
  bool closed() const { return open_edges() == 0; }
  /// Number of edges for which this is not so.
  std::size_t open_edges() const;
};

/// Binary or ASCII. Degenerate triangles are skipped. Throws InputError [file-missing], [stl-format], [stl-empty].
TriangleMesh read_stl(const std::string& path);

}  // namespace camber
