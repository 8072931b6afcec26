// Real programs and samples on a machine of 20 m/min whose axes lag: nowhere in a cut are the axes millimetres off.
#include <gtest/gtest.h>

#include <filesystem>

#include "kinematics/control_options.h"
#include "nc/program_text.h"
#include "repath/resegment/fastest.h"
#include "test_paths.h"
#include "tests/support/test_data.h"

namespace camber::repath {
namespace {

constexpr double kLargestMm = 1.0;  // a circle of 0.5 mm at F1500 and the like: the lag of the drives, no jump

machine::Machine lagging_machine() {
  machine::Machine m;
  m.control.in_position_mm = machine::kInPositionMm;
  m.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 4.1};
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 20000 / 60.0;
    axis.acceleration_mm_per_s2 = 2000;
    axis.position_gain_per_s = 33;
  }
  return m;
}

TEST(RealContour, NoProgramHasContourErrorsOfMillimetres) {
  namespace fs = std::filesystem;
  std::vector<fs::path> programs;
  const fs::path samples = CAMBER_SOURCE_DIR "/samples", data = tests::data_path("nc");
  for (const auto& entry : fs::recursive_directory_iterator(samples))
    if (entry.path().extension() == ".nc" && entry.path().parent_path().filename() != "12-five-axis")
      programs.push_back(entry.path());
  for (const char* name : {"fusion_parallel_ball_inch.nc", "gpr_haas_sample.ncf", "maestro_contour_R.nc",
                           "maestro_g91.nc", "maestro_helix_full_turns.nc", "nist_cover.nc", "nist_d2mi_904_op1.nc",
                           "nist_d2mi_904_op2.nc", "nist_plate_5.nc"})
    programs.push_back(data / name);
  const machine::Machine m = lagging_machine();
  for (const fs::path& path : programs) {
    Diagnostics diagnostics;
    nc::InterpreterOptions options;
    options.inch = false;
    const nc::Program program = nc::read_program(SourceText::read(path), diagnostics);
    const auto moves = nc::interpret(program, kinematics::interpreter_options(m, options), diagnostics);
    const ContourFigures figures = contour_figures(moves, moves, m);
    printf("%-32s %9.1f s, contour %.3f mm at most\n", path.filename().c_str(), figures.time_s, figures.contour_max_mm);
    EXPECT_LT(figures.contour_max_mm, kLargestMm) << path;
  }
}

// Out and back the same way: the drives lag, so that the turn is not reached, and the way back counts from there on.
TEST(RealContour, AWayBackIsNoContourError) {
  Diagnostics diagnostics;
  const nc::Program program =
      nc::read_program(SourceText("back.nc", "G21 G90 G17\nG0 X0 Y0 Z1\nG1 Z-1 F900\nZ5\nZ-1\nX20\nM2\n"), diagnostics);
  const machine::Machine m = lagging_machine();
  const auto moves =
      nc::interpret(program, kinematics::interpreter_options(m, std::optional<bool>(false)), diagnostics);
  // 15 mm/s at a gain of 33 /s lag by 0.45 mm; a square corner is cut by less than that
  EXPECT_LT(contour_figures(moves, moves, m).contour_max_mm, 0.45);
}

}  // namespace
}  // namespace camber::repath
