#pragma once
// Text of a small job, for tests that need any job that runs.
#include <string>

#include <fmt/format.h>

namespace camber::tests {

struct BallJob {
  std::string machine = "machine.toml";
  double diameter_mm = 6;
  std::string box_mm = "[[0, 0, -2], [4, 2, 0]]";
  double voxel_mm = 0.2;
};

/// job.toml: program p.nc, tool 1 a ball end mill with two flutes and 40 mm overhang, cutting coefficients of a steel.
inline std::string ball_job(const BallJob& job = {}) {
  return fmt::format(R"(program = "p.nc"
machine = "{}"
[tool.1]
type = "ball"
diameter_mm = {:.1f}
flutes = 2
overhang_mm = 40.0
[material]
ktc_MPa = 2000.0
krc_MPa = 700.0
[stock]
box_mm = {}
[simulation]
voxel_mm = {}
)",
                     job.machine, job.diameter_mm, job.box_mm, job.voxel_mm);
}

}  // namespace camber::tests
