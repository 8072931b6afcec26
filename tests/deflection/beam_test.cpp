#include "deflection/beam.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::deflection {
namespace {

TEST(Beam, CantileverUnderATipLoadBendsByItsClosedForm) {
  machine::Tool tool = testing::make_tool(machine::ToolType::ball, 6, 2, 30);
  const double i = kPi / 64 * std::pow(4.8, 4), e = 600000, l = 40;
  const Beam beam = beam_of(tool);
  tests::expect_figure("compliance at the tip", beam.compliance_mm_per_N(0, 0), l * l * l / (3 * e * i), 1e-9);
  // Load at a, seen at the tip: a'^2 (3 L - a') / (6 E I), a' from the holder.
  EXPECT_NEAR(beam.compliance_mm_per_N(0, 10), 30 * 30 * (3 * l - 30) / (6 * e * i), 1e-12);
}

TEST(Beam, IsSymmetric) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 10, 4, 30);
  tool.flute_length_mm = 15;
  tool.shank_diameter_mm = 12;
  tool.root_stiffness_N_per_mm = 20000;
  const Beam beam = beam_of(tool);
  for (double a = 0; a < 40; a += 7)
    for (double b = 0; b < 40; b += 5)
      EXPECT_NEAR(beam.compliance_mm_per_N(a, b), beam.compliance_mm_per_N(b, a), 1e-15);
}

TEST(Beam, SteppedBarAddsTheBendingOfItsParts) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 10, 4, 30);
  tool.flute_length_mm = 15;
  tool.shank_diameter_mm = 12;
  tool.youngs_modulus_MPa = 210000;
  tool.root_stiffness_N_per_mm = 20000;
  const double i1 = kPi / 64 * std::pow(8.0, 4), i2 = kPi / 64 * std::pow(12.0, 4), e = 210000;
  const double expected =
      std::pow(15.0, 3) / (3 * e * i1) + (std::pow(40.0, 3) - std::pow(15.0, 3)) / (3 * e * i2) + 1.0 / 20000;
  tests::expect_figure("compliance at the tip", beam_of(tool).compliance_mm_per_N(0, 0), expected, 1e-9);
}

TEST(Beam, RootThatTiltsAddsTheProductOfTheLevers) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 10, 4, 30);
  const double rigid = beam_of(tool).compliance_mm_per_N(3, 8);
  tool.root_rotational_stiffness_Nmm_per_rad = 5e6;
  const double got = beam_of(tool).compliance_mm_per_N(3, 8) - rigid;
  tests::expect_figure("compliance of the root", got, 37.0 * 32.0 / 5e6, 1e-11);
}

TEST(Beam, TypicalFlutesBendAsFlutesAndTheRestAsAShank) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 6, 4, 30), given = tool;
  tool.typical_flute_mm = 18;
  given.flute_length_mm = 18;
  EXPECT_EQ(beam_of(tool).compliance_mm_per_N(0, 0), beam_of(given).compliance_mm_per_N(0, 0));
  EXPECT_LT(beam_of(tool).compliance_mm_per_N(0, 0),
            0.7 * beam_of(testing::make_tool(machine::ToolType::flat, 6, 4, 30)).compliance_mm_per_N(0, 0));
}

TEST(Beam, FirstFrequencyOfAUniformBarIsWithinTwoPercentOfTheClosedForm) {
  machine::Tool tool = testing::make_tool(machine::ToolType::flat, 10, 4, 30);
  tool.effective_diameter_ratio = 1;
  tool.youngs_modulus_MPa = 210000;
  const double i = kPi / 64 * 1e4, area = kPi / 4 * 100, rho = 7850e-12;  // t/mm3 with N and mm
  const double exact = 3.5160 / (2 * kPi) * std::sqrt(210000 * i / (rho * area * std::pow(40.0, 4)));
  EXPECT_NEAR(beam_of(tool).first_frequency_hz(tool, 7850) / exact, 1, 0.02);
}

}  // namespace
}  // namespace camber::deflection
