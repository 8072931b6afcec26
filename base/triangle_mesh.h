#pragma once
// Triangle meshes from files: STL, and STEP where the build can read it.
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
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

/// The mesh of a file, which must be closed. Throws InputError [stl-open]; `so` says what follows where it is not.
TriangleMesh closed_mesh(TriangleMesh mesh, const std::string& path, std::string_view so = "so it has no inside");

/// Binary STL.
std::string stl_text(const TriangleMesh& mesh);

/// Binary or ASCII. Degenerate triangles are skipped. Throws InputError [file-missing], [stl-format], [stl-empty].
TriangleMesh read_stl(const std::string& path);

/// Largest distance of the triangles of a STEP file's faces from the faces themselves.
inline constexpr double kStepChord_mm = 0.005;
/// Largest angle between the normals of neighbouring triangles on a curved face of a STEP file.
inline constexpr double kStepTurn_deg = 20;

/// True for the names *.step and *.stp, in capitals or not.
bool is_step_file(const std::string& path);

/// STL as read_stl(), in mm or whatever the file means; STEP files in mm, whatever their unit, each face within
/// kStepChord_mm. Throws InputError: those of read_stl(), [file-missing], [step-format], [step-empty],
/// [step-not-built].
TriangleMesh read_mesh(const std::string& path);

/// Defined in step/ in builds with CAMBER_OPENCASCADE. Points of neighbouring faces are joined. Throws InputError
/// [file-missing], [step-format] (not a STEP file, or nothing in it could be transferred), [step-empty] (no face).
TriangleMesh read_step(const std::string& path);

}  // namespace camber
