#pragma once
// A test piece whose measured features tell lag, force, stiffness and tool diameters apart.
#include <string>
#include <vector>

#include "machine/machine_model.h"

namespace camber::calib {

struct TestPieceOptions {
  double diameter_mm = 6;  ///< of the end mill
  int flutes = 2;
  double spindle_rpm = 8000;
};

struct TestPieceFile {
  std::string name, tells, text;
};

/// test_piece.nc, job.toml, measured.csv (to be filled in). `machine_path`: as the job names it.
///
/// One end mill in two clamping lengths, T1 short (three diameters) and T2 long (six). For each, at feeds per tooth of
/// D/300, D/150 and D/75: a bore of path radius D/2 (its size: lag, tool), a slot along X and one along Y (widths:
/// force and bending, the two axes apart; the finishing cuts take D/30 of each wall). Between the feeds of one tool the
/// tool's diameter and the measuring machine cancel; between the tools the bending of the root and of the tool differ.
/// The block is 17 D by 18 D by 2 D, its top at Z0, its corner at X0 Y0.
std::vector<TestPieceFile> test_piece(const std::string& machine_path, const TestPieceOptions& options);

}  // namespace camber::calib
