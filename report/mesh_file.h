#pragma once
// Surfaces as meshes for other programs: the machined part, and the machined surface with its form error.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/triangle_mesh.h"
#include "machine/job_file.h"
#include "removal/stock.h"
#include "report/form_error_files.h"
#include "report/surface_mesh.h"

namespace camber::report {

/// The closed surface of a machined stock, a vertex for every cell of a voxel's width that it passes.
SurfaceMesh machined_mesh(const removal::Stock& stock);

/// The blank where the program has it; of a field no finer than pictures need. Empty: it is a box, or there is none.
TriangleMesh blank_mesh(machine::Job job);

/// The surface that the program leaves, at the voxels' width; its vertices have the error of largest magnitude of their
/// cell. `grid_mm`: width of the voxels.
SurfaceMesh error_mesh(const FormErrorPoints& points, double grid_mm);

/// The quadrangles cut into triangles, counter-clockwise as seen from outside.
std::vector<std::array<std::uint32_t, 3>> triangles_of(const SurfaceMesh& mesh);

/// Binary STL, or PLY where the name ends in .ply; mm. Throws InputError [file-unwritable].
void write_mesh(const std::string& path, const SurfaceMesh& mesh);

/// Binary PLY with normals, colours as of write_form_error_ply, error_um, deflection_um, contour_um and block at every
/// vertex. Throws InputError [file-unwritable].
void write_error_mesh(const std::string& path, const SurfaceMesh& mesh, double full_um);

}  // namespace camber::report
