// The tool along its axis: bar, spring at the root, machine's axis; rows of deflections with it.
#include <limits>

#include <gtest/gtest.h>

#include "deflection/beam.h"
#include "deflection/tooth_pass.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::deflection {
namespace {

constexpr double kYoung = 210000, kRoot = 25000;

/// Flutes of 8 mm (a bar of 4.8 mm), a neck of 5 mm up to 20 mm, a shank of 8 mm up to 50 mm.
machine::Tool stepped() {
  auto tool = testing::make_tool(machine::ToolType::flat, 6, 2, 30);
  tool.youngs_modulus_MPa = kYoung;
  tool.effective_diameter_ratio = 0.8;
  tool.overhang_mm = 50;
  tool.flute_length_mm = 8;
  tool.neck_diameter_mm = 5;
  tool.neck_length_mm = 12;
  tool.shank_diameter_mm = 8;
  tool.root_axial_stiffness_N_per_mm = kRoot;
  return tool;
}

double bar(double length, double diameter) { return length / (kYoung * kPi / 4 * diameter * diameter); }

TEST(AxialBeam, IsASteppedBarOnASpring) {
  const Beam beam = beam_of(stepped());
  tests::expect_figure("axial compliance of the bar", beam.axial_compliance_mm_per_N(0) - 1 / kRoot,
                       bar(8, 4.8) + bar(12, 5) + bar(30, 8), 1e-10);
  EXPECT_NEAR(beam.axial_compliance_mm_per_N(14), 1 / kRoot + bar(6, 5) + bar(30, 8), 1e-15);
  EXPECT_NEAR(beam.axial_compliance_mm_per_N(50), 1 / kRoot, 1e-15);
}

TEST(AxialBeam, AGivenStiffnessTakesTheBarsPlace) {
  auto tool = stepped();
  tool.axial_stiffness_N_per_mm = 80000;
  EXPECT_NEAR(beam_of(tool).axial_compliance_mm_per_N(0), 1 / kRoot + 1 / 80000.0, 1e-15);
  tool.axial_stiffness_N_per_mm = std::numeric_limits<double>::infinity();
  tool.root_axial_stiffness_N_per_mm = std::numeric_limits<double>::infinity();
  EXPECT_EQ(beam_of(tool).axial_compliance_mm_per_N(0), 0);
}

TEST(AxialDeflection, IsForceTimesComplianceAtEveryRotationStep) {
  const auto tool = stepped();
  const auto envelope = removal::make_envelope(tool, 4, 0.5, kPi / 36);
  const machine::Material material{2000, 700, 400, 0, 0, 20};
  const double axis = 1 / 40000.0;
  const ToothPassModel model(envelope, material, beam_of(tool), {0, 2, 4}, 0, Teeth(tool), {0, 0, axis});
  const std::size_t wall = envelope.rings.size() - 2;
  std::vector<removal::ChipSample> chips;
  for (std::uint32_t step = 0; step < 9; ++step)
    chips.push_back({static_cast<std::uint32_t>(wall * static_cast<std::size_t>(envelope.steps)) + step,
                     0.01f * static_cast<float>(step + 1)});
  ToothPass pass;
  model.evaluate(chips, 0, Vec3(0.05, 0, 0), pass);
  const double compliance = beam_of(tool).axial_compliance_mm_per_N(0) + axis;
  EXPECT_DOUBLE_EQ(model.axial_compliance_mm_per_N(), compliance);
  const removal::DeflectionTable table(0, model.steps(), model.node_height_mm(), true);
  ASSERT_EQ(pass.deflection_mm.size(), table.row_size());
  for (int m = 0; m < model.steps(); ++m) {
    const double force = pass.force_N[static_cast<std::size_t>(m)].z();
    // A positive coefficient pulls the tool down.
    EXPECT_EQ(force < 0, m < 9);
    EXPECT_LE(force, 0);
    EXPECT_NEAR(table.axial_mm(pass.deflection_mm.data(), m), compliance * force, 1e-9);
    const double half = (force + pass.force_N[static_cast<std::size_t>((m + 1) % model.steps())].z()) / 2;
    EXPECT_NEAR(table.at(pass.deflection_mm.data(), 1, m + 0.5).z(), compliance * half, 1e-9);
  }
}

TEST(AxialDeflection, IsNothingWithoutASpring) {
  auto tool = stepped();
  tool.root_axial_stiffness_N_per_mm = std::numeric_limits<double>::infinity();
  const auto envelope = removal::make_envelope(tool, 4, 0.5, kPi / 36);
  const machine::Material material{2000, 700, 400, 0, 0, 20};
  const ToothPassModel rigid(envelope, material, beam_of(tool), {0, 2, 4}, 0, Teeth(tool));
  EXPECT_FALSE(rigid.axial());
  const ToothPassModel on_axis(envelope, material, beam_of(tool), {0, 2, 4}, 0, Teeth(tool), {0, 0, 1e-5});
  EXPECT_NEAR(on_axis.axial_compliance_mm_per_N(), beam_of(tool).axial_compliance_mm_per_N(0) + 1e-5, 1e-18);
}

}  // namespace
}  // namespace camber::deflection
