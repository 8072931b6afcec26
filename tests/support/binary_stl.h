#pragma once
// The vertices of a binary STL, for tests.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "base/geometry.h"
#include "tests/support/temp_folder.h"

namespace camber::tests {

/// Three vertices a triangle, in the file's order. Empty when the file is not what its count says.
inline std::vector<Vec3> stl_vertices(const std::string& path) {
  constexpr std::size_t kHeader = 84, kTriangle = 50, kNormal = 12;
  const std::string bytes = file_text(path);
  std::uint32_t count = 0;
  if (bytes.size() < kHeader) return {};
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  if (bytes.size() != kHeader + kTriangle * count) return {};
  std::vector<Vec3> out;
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t v = 0; v < 3; ++v) {
      float xyz[3];
      std::memcpy(xyz, bytes.data() + kHeader + kTriangle * t + kNormal + 12 * v, sizeof xyz);
      out.emplace_back(xyz[0], xyz[1], xyz[2]);
    }
  return out;
}

}  // namespace camber::tests
