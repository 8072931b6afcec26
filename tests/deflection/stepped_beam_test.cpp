// Stepped cantilevers by hand: moment-area sums and unit-load integrals written out for two steps.
#include <cmath>

#include <gtest/gtest.h>

#include "base/units.h"
#include "deflection/beam.h"
#include "deflection/tooth_pass.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"

namespace camber::deflection {
namespace {

constexpr double kFlutes = 12, kNeck = 10, kOverhang = 40, kYoung = 600000, kRoot = 25000;

machine::Tool necked() {
  auto tool = testing::make_tool(machine::ToolType::flat, 10, 4, 30);
  tool.flute_length_mm = kFlutes;
  tool.neck_diameter_mm = 9;
  tool.neck_length_mm = kNeck;
  tool.shank_diameter_mm = 12;
  tool.youngs_modulus_MPa = kYoung;
  tool.root_stiffness_N_per_mm = kRoot;
  return tool;
}

double inertia(double d) { return kPi / 64 * std::pow(d, 4); }

/// Unit load at `load`, deflection at `at`: integral of M m / EI from the higher place to the holder, by a fine sum.
double by_sum(double at, double load) {
  constexpr int kSlices = 400000;
  double w = 1 / kRoot;
  const double dz = kOverhang / kSlices;
  for (int i = 0; i < kSlices; ++i) {
    const double z = (i + 0.5) * dz, d = z < kFlutes ? 8 : z < kFlutes + kNeck ? 9 : 12;
    w += std::max(0.0, z - at) * std::max(0.0, z - load) * dz / (kYoung * inertia(d));
  }
  return w;
}

TEST(SteppedBeam, TipLoadOnTwoStepsHasItsTextbookForm) {
  // Flutes and shank: delta = F (a^3 / I1 + (L^3 - a^3) / I2) / 3E.
  auto tool = necked();
  tool.neck_length_mm = 0;
  const double expected =
      (std::pow(kFlutes, 3) / inertia(8) + (std::pow(kOverhang, 3) - std::pow(kFlutes, 3)) / inertia(12)) /
      (3 * kYoung);
  EXPECT_NEAR(beam_of(tool).compliance_mm_per_N(0, 0) - 1 / kRoot, expected, 1e-12);
}

TEST(SteppedBeam, TipDeflectionUnderALoadAtTheStepHasItsTextbookForm) {
  // Load at the step: only the shank (length b) bends; the tip follows its end's slope: b^3/3EI + a b^2/2EI.
  auto tool = necked();
  tool.neck_length_mm = 0;
  const double b = kOverhang - kFlutes, ei = kYoung * inertia(12);
  EXPECT_NEAR(beam_of(tool).compliance_mm_per_N(0, kFlutes) - 1 / kRoot,
              b * b * b / (3 * ei) + kFlutes * b * b / (2 * ei), 1e-12);
}

TEST(SteppedBeam, AnyLoadAndAnyHeightAgreeWithTheUnitLoadIntegral) {
  const Beam beam = beam_of(necked());
  for (const double at : {0.0, 3.0, 12.0, 17.0, 30.0})
    for (const double load : {0.0, 5.0, 15.0, 22.0, 39.0}) {
      EXPECT_NEAR(beam.compliance_mm_per_N(at, load) / by_sum(at, load), 1, 1e-6) << at << " " << load;
      EXPECT_NEAR(beam.compliance_mm_per_N(at, load), beam.compliance_mm_per_N(load, at), 1e-16);
    }
}

TEST(SteppedBeam, ShearAddsTheLengthOverKappaGA) {
  auto tool = necked();
  const double bending = beam_of(tool).compliance_mm_per_N(2, 6);
  tool.shear = true;
  const double g = kYoung / 2.6, kappa = 6 * 1.3 / 8.8;
  const auto part = [&](double length, double d) { return length / (kappa * g * kPi / 4 * d * d); };
  const double expected = part(kFlutes - 6, 8) + part(kNeck, 9) + part(kOverhang - kFlutes - kNeck, 12);
  tests::expect_figure("compliance by shear", beam_of(tool).compliance_mm_per_N(2, 6) - bending, expected, 1e-9);
  EXPECT_NEAR(beam_of(tool).compliance_mm_per_N(6, 2), beam_of(tool).compliance_mm_per_N(2, 6), 1e-18);
}

TEST(SteppedBeam, ATaperedToolBendsAsAConeDoes) {
  auto tool = testing::make_tool(machine::ToolType::tapered_ball, 4, 2, 30);
  tool.taper_rad = rad_from_deg(3);
  tool.effective_diameter_ratio = 1;
  tool.youngs_modulus_MPa = kYoung;
  // Cone of diameters d0 at the tip and d1 at the holder, tip load: 64 F L^3 / (3 pi E d0 d1^3).
  const double tan = std::tan(tool.taper_rad);
  const double d0 = 4 * (1 - std::sin(tool.taper_rad)) / std::cos(tool.taper_rad), d1 = d0 + 2 * kOverhang * tan;
  const double expected = 64 * std::pow(kOverhang, 3) / (3 * kPi * kYoung * d0 * std::pow(d1, 3));
  EXPECT_NEAR(beam_of(tool).compliance_mm_per_N(0, 0) / expected, 1, 0.002);
}

TEST(MachineAxes, AddTheirComplianceAtEveryHeight) {
  const auto tool = necked();
  const auto envelope = removal::make_envelope(tool, 4, 0.5, kPi / 36);
  const machine::Material material{2000, 700, 0, 0, 0, 0};
  const Vec3 axes(1 / 20000.0, 1 / 50000.0, 0);
  const ToothPassModel stiff(envelope, material, beam_of(tool), {0, 2, 4}, 0, Teeth(tool));
  const ToothPassModel soft(envelope, material, beam_of(tool), {0, 2, 4}, 0, Teeth(tool), axes);
  // One point of the wall, at some angle.
  const auto point = static_cast<std::uint32_t>((envelope.rings.size() - 2) * envelope.steps + 7);
  const std::vector<removal::ChipSample> chips{{point, 0.05f, false}};
  ToothPass a, b;
  stiff.evaluate(chips, 0, Vec3(0.05, 0, 0), a);
  soft.evaluate(chips, 0, Vec3(0.05, 0, 0), b);
  const auto m = static_cast<std::size_t>(7 % envelope.steps_per_pitch);
  ASSERT_GT(a.force_N[m].norm(), 1);
  for (std::size_t node = 0; node < 3; ++node)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const std::size_t at = 2 * (node * static_cast<std::size_t>(envelope.steps_per_pitch) + m) + axis;
      EXPECT_NEAR(b.deflection_mm[at] - a.deflection_mm[at],
                  axes[static_cast<Eigen::Index>(axis)] * a.force_N[m][static_cast<Eigen::Index>(axis)], 1e-8);
    }
}

}  // namespace
}  // namespace camber::deflection
