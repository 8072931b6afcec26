#pragma once
// Memory that a mesh's distance field takes, before it is built.
#include <string>

#include "base/diagnostics.h"
#include "base/triangle_mesh.h"

namespace camber::removal {

double surface_mm2(const TriangleMesh& mesh);

/// Bytes of the field about a surface while it is built, as OpenVDB builds it: whole leaves of eight voxels along the
/// band, with a distance and the index of the nearest triangle each.
double mesh_field_bytes(double surface_mm2, double voxel_mm, double band_mm);

/// Throws InputError [voxel-memory] where the field needs more than `free_bytes`; says how much.
void require_mesh_memory(const std::string& path, const TriangleMesh& mesh, double voxel_mm, double band_mm,
                         double free_bytes);

}  // namespace camber::removal
