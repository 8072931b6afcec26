#pragma once
// One short wall with a slender flat end mill and coarse voxels: a fraction of a second a round of compensation.
#include <string>

#include "tests/support/temp_folder.h"

namespace camber::tests {

inline const std::string kWallProgram =
    "%\nO1 (WALL)\nG21 G90 G17 G40 G49 G80 G54\nT1 M6\nS3000 M3\nG0 X-4. Y-2.\nG0 Z-1.\nG1 X2. F600 "
    "(IN)\nX8.\nX12.\nG0 Z5.\n"
    "M30\n%\n";

inline const std::string kWallMachine =
    "[axis.x]\nacceleration_mm_per_s2 = 500\ntravel_mm = [-100, 100]\n[axis.y]\n[axis.z]\n";

inline std::string wall_job(double voxel_mm = 0.2, const std::string& program = "p.nc") {
  return "program = \"" + program +
         "\"\nmachine = \"machine.toml\"\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 4.0\nflutes = 2\n"
         "overhang_mm = 30.0\nhelix_deg = 30\n[material]\nktc_MPa = 2000.0\nkrc_MPa = 700.0\n[stock]\n"
         "box_mm = [[0, -0.5, -2], [8, 2, 0]]\nallowance_mm = 0.1\n[simulation]\nvoxel_mm = " +
         std::to_string(voxel_mm) +
         "\ncoupling = \"rigid\"\n[compensation]\nlevers = [\"shift\"]\ntolerance_um = 10.0\nmax_overcut_um = "
         "6.0\nmax_rounds = 3\n";
}

/// p.nc, machine.toml and job.toml; `folder` ends with a slash, or is empty.
inline void write_wall(const TempFolder& place, const std::string& folder = "", double voxel_mm = 0.2) {
  if (!folder.empty()) std::filesystem::create_directories(place / folder);
  place.write(folder + "p.nc", kWallProgram);
  place.write(folder + "machine.toml", kWallMachine);
  place.write(folder + "job.toml", wall_job(voxel_mm));
}

}  // namespace camber::tests
