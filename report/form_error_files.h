#pragma once
// form_error.csv and form_error.vtp: the error at every point of the machined surface.
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

#include "base/geometry.h"

namespace camber::report {

struct FormErrorPoint {
  Vec3 place_mm = Vec3::Zero();
  Vec3 crossing_mm = Vec3::Zero();  ///< where a line of the voxels' grid crosses the surface; for meshes
  Vec3 normal = Vec3::UnitZ();
  double error_um = 0;    ///< machined minus nominal surface along the normal; positive: excess material
  double contour_um = 0;  ///< part of it due to servo lag and corner rounding of the target program
  double deflection_um() const { return error_um - contour_um; }
  bool part_yields() const { return part_um == part_um; }
  double tool_um() const { return part_yields() ? deflection_um() - part_um : deflection_um(); }
  double area_mm2 = 0;                                               ///< represented by the point
  double total_error_um = std::numeric_limits<double>::quiet_NaN();  ///< against the part's mesh; NaN: no mesh
  double model_error_um = std::numeric_limits<double>::quiet_NaN();  ///< by the feed model; NaN: no trace
  std::uint32_t block = 0;  ///< 1-based line that generated the surface here; 0: unknown
  int tool = 0;             ///< whose stamp made it; 0: unknown
  bool valid = true;        ///< the model holds here
  /// The part's share of deflection_um(); NaN: the part is rigid.
  double part_um = std::numeric_limits<double>::quiet_NaN();
};

/// Points made as they are asked for: there are millions of them.
struct FormErrorPoints {
  std::size_t count = 0;
  std::function<FormErrorPoint(std::size_t)> at;
};

/// Columns x_mm,y_mm,z_mm,nx,ny,nz,error_um,deflection_um,contour_um,total_error_um,area_mm2,block,tool,valid; every
/// figure of the form error can be worked out again from the rows whose `valid` is 1. total_error_um is empty where
/// there is none. Of a trace model_error_um,difference_um follow: the feed model's error, and error_um minus that; of a
/// part that yields tool_deflection_um,part_deflection_um, whose sum is deflection_um.
/// Throws InputError [file-unwritable].
void write_form_error_csv(const std::string& path, const FormErrorPoints& points);

/// The same points for ParaView (VTK PolyData, XML, base64): normals, error_um, deflection_um, contour_um, area_mm2,
/// block, tool, valid and, where there are such, total_error_um and the columns that follow in the CSV. Throws
/// InputError [file-unwritable].
void write_form_error_vtp(const std::string& path, const FormErrorPoints& points);

/// Blue, white, red for -1, 0, 1.
std::array<std::uint8_t, 3> error_colour(double fraction);

/// The same points as binary PLY with colours: blue where the cutter went too deep, white at zero, red where material
/// is left; full colour at `full_um` and beyond. Properties x y z nx ny nz red green blue error_um deflection_um
/// contour_um area_mm2 block tool. Throws InputError [file-unwritable].
void write_form_error_ply(const std::string& path, const FormErrorPoints& points, double full_um);

}  // namespace camber::report
