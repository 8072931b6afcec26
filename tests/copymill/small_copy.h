#pragma once
// A copy job on one of the sample's parts.
#include <string>

#include "copymill/copy_milling.h"
#include "machine/job_file.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::tests {

struct SmallCopy {
  std::string part = "island";  ///< of samples/14-copy-milling; or a file, its name ending in .stl
  std::string stock = "box_mm = [[0, 0, -15], [60, 45, 0]]";
  std::string operations;
  double voxel_mm = 0.25;
};

inline std::string write_copy_job(const TempFolder& folder, const SmallCopy& c) {
  folder.write("machine.toml",
               "[control]\ndialect = \"linuxcnc\"\nperiod_ms = 1.0\ncorner = { law = \"exact_stop\" }\n"
               "[axis.x]\nmax_velocity_mm_per_min = 9000\nacceleration_mm_per_s2 = 1000\n"
               "[axis.y]\nmax_velocity_mm_per_min = 9000\nacceleration_mm_per_s2 = 1000\n"
               "[axis.z]\nmax_velocity_mm_per_min = 9000\nacceleration_mm_per_s2 = 1000\n"
               "[spindle]\nmax_rpm = 12000\n");
  const std::string part =
      c.part.ends_with(".stl") ? c.part : CAMBER_SOURCE_DIR "/samples/14-copy-milling/" + c.part + ".stl";
  return folder.write("job.toml",
                      "machine = \"machine.toml\"\n[part]\nmesh = \"" + part + "\"\n[stock]\n" + c.stock +
                          "\n[tool.1]\ntype = \"flat\"\ndiameter_mm = 8\nflutes = 3\nhelix_deg = 30\noverhang_mm = 30\n"
                          "[tool.2]\ntype = \"ball\"\ndiameter_mm = 6\nflutes = 2\nhelix_deg = 30\noverhang_mm = 30\n"
                          "[tool.3]\ntype = \"drill\"\ndiameter_mm = 5\nflutes = 2\nhelix_deg = 30\noverhang_mm = 40\n"
                          "[material]\npreset = \"Al6082-T6\"\n[simulation]\nvoxel_mm = " +
                          std::to_string(c.voxel_mm) + "\n" + c.operations);
}

struct ReadCopy {
  machine::Job job;
  std::vector<machine::CopyOperation> operations;
};

inline ReadCopy read_copy(const TempFolder& folder, const SmallCopy& c) {
  Diagnostics diagnostics;
  const std::string path = write_copy_job(folder, c);
  ReadCopy out{machine::read_unprogrammed_job(path, diagnostics), {}};
  out.operations = machine::read_copy_operations(path, out.job, diagnostics);
  diagnostics.throw_if_errors();
  return out;
}

}  // namespace camber::tests
