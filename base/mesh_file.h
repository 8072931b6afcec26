#pragma once
// Triangle meshes from files: STL, and STEP where the build can read it.
#include <string>

#include "base/stl.h"

namespace camber {

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
