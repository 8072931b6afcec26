#include "base/mesh_file.h"

#include <algorithm>
#include <cctype>

#include "base/diagnostics.h"

namespace camber {

bool is_step_file(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos) return false;
  std::string end = path.substr(dot + 1);
  std::ranges::transform(end, end.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return end == "step" || end == "stp";
}

TriangleMesh read_mesh(const std::string& path) { return is_step_file(path) ? read_step(path) : read_stl(path); }

#ifndef CAMBER_OPENCASCADE
TriangleMesh read_step(const std::string& path) {
  fail_on_file(path,
               "this build does not read STEP files; an STL file was expected, or a build configured with "
               "-DCAMBER_OPENCASCADE=ON (scripts/install-packages --step installs Open CASCADE)",
               "step-not-built");
}
#endif

}  // namespace camber
