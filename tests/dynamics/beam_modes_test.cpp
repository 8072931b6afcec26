// Modes of beams against tests/data/dynamics/beam_modes.csv.
#include "dynamics/tool_modes.h"

#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "deflection/beam.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"
#include "tests/support/test_data.h"

namespace camber::dynamics {
namespace {

constexpr double kFrequency = 0.001, kStiffness = 0.005;

BeamSection steel(double length, double lower, double upper) { return {length, lower, upper, 210e3, 7850, 0.3}; }
BeamSection carbide(double length, double diameter) { return {length, diameter, diameter, 600e3, 14500, 0.22}; }

/// f1 to f3, Hz, and modal stiffnesses, N/um, of a beam with 40 Timoshenko elements a section.
std::array<double, 6> tabled(const std::string& beam) {
  std::ifstream in(tests::data_path("dynamics/beam_modes.csv"));
  const std::string start = beam + ",timoshenko,40,";
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(start)) continue;
    std::array<double, 6> values{};
    std::istringstream cells(line.substr(start.size()));
    std::string cell;
    for (double& v : values) std::getline(cells, cell, ','), v = std::stod(cell);
    return values;
  }
  throw std::runtime_error(beam);
}

void expect_modes_of(const std::string& beam, const std::vector<BeamSection>& sections, const BeamRoot& root = {}) {
  const auto expected = tabled(beam);
  const auto modes = beam_modes(sections, root, 3);
  ASSERT_EQ(modes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string of = fmt::format(", {}, mode {}", beam, i + 1);
    tests::expect_figure("frequency" + of, modes[i].frequency_hz, expected[i], kFrequency);
    tests::expect_figure("modal stiffness" + of, modes[i].tip_stiffness_N_per_mm, 1000 * expected[3 + i], kStiffness);
  }
}

TEST(BeamModes, AreThoseOfTheTable) {
  expect_modes_of("steel_rod_d10_L100", {steel(100, 10, 10)});
  expect_modes_of("carbide_rod_d10_L60", {carbide(60, 10)});
  expect_modes_of("carbide_rod_d10_L30", {carbide(30, 10)});
  expect_modes_of("carbide_stepped_12x35_8x30", {carbide(30, 8), carbide(35, 12)});
  expect_modes_of("holder_cone_and_carbide", {carbide(30, 9.6), carbide(25, 12), steel(40, 25, 32)});
  expect_modes_of("holder_cone_and_carbide_on_springs", {carbide(30, 9.6), carbide(25, 12), steel(40, 25, 32)},
                  {.stiffness_N_per_mm = 1.5e5, .tilt_stiffness_Nmm_per_rad = 4e8});
}

TEST(BeamModes, OfAToolHaveItsSectionsAndHolder) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 12, 4, 30);
  tool.overhang_mm = 55, tool.flute_length_mm = 30, tool.effective_diameter_ratio = 0.8;
  tool.holder = {{25, 32, 40}};
  const auto sections = beam_of_tool(tool, 14500);
  ASSERT_EQ(sections.size(), 3u);
  expect_modes_of("holder_cone_and_carbide", sections);
}

/// A stiff spring under a short rod: all of it moves, and the mass is what it weighs.
TEST(BeamModes, OnASoftRootIsAMassOnASpring) {
  const double mass_kg = kPi / 4 * 100 * 20 * 14500e-9;
  const auto modes = beam_modes({carbide(20, 10)}, {.stiffness_N_per_mm = 10}, 1);
  EXPECT_NEAR(modes[0].frequency_hz, std::sqrt(10e3 / mass_kg) / (2 * kPi), 0.05);
  EXPECT_NEAR(modes[0].stiffness_N_per_mm(20), 10, 0.01);
}

/// Flexibilities of all modes add up to that of the resting beam.
TEST(BeamModes, FlexibilitiesAddUpToTheStaticOneAlongTheFlute) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 8, 4, 30);
  tool.overhang_mm = 40, tool.flute_length_mm = 20, tool.shear = true, tool.root_stiffness_N_per_mm = 20000;
  tool.youngs_modulus_MPa = 210e3;
  const auto modes = beam_modes(beam_of_tool(tool, 7850), {.stiffness_N_per_mm = 20000}, 40);
  const deflection::Beam beam = deflection::beam_of(tool);
  for (const double z : {0.0, 7.0, 19.0}) {
    double flexibility = 0;
    for (const BeamMode& m : modes) flexibility += 1 / m.stiffness_N_per_mm(z);
    EXPECT_NEAR(flexibility, beam.compliance_mm_per_N(z, z), 0.005 * flexibility) << z;
  }
}

TEST(BeamModes, DensityGoesByTheModulus) {
  EXPECT_EQ(usual_density_kg_per_m3(600e3), 14500);
  EXPECT_EQ(usual_density_kg_per_m3(210e3), 7850);
}

}  // namespace
}  // namespace camber::dynamics
