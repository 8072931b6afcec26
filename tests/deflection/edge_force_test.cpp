// edge_force of every force law, with and without the ramp.
#include "deflection/edge_force.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/law_material.h"

namespace camber::deflection {
namespace {

constexpr double kRamp_mm = 0.002;

std::array<double, 3> components(const EdgeForce& f) { return {f.tangential_N, f.radial_N, f.axial_N}; }

/// Of the law, with edge terms.
machine::Material material(const machine::ForceLawDescription& law) {
  machine::Material m = tests::material_of(law);
  m.kte_N_per_mm = 15, m.kre_N_per_mm = 12, m.kae_N_per_mm = -5;
  return m;
}

TEST(EdgeForceOfEachLaw, SlopeIsTheDerivative) {
  for (const auto& law : machine::force_laws())
    for (const double ramp : {0.0, kRamp_mm})
      for (const double h : {0.0005, 0.0015, 0.003, 0.05, 0.4}) {
        SCOPED_TRACE(std::string(law.word) + " " + std::to_string(ramp) + " " + std::to_string(h));
        if (ramp == 0 && h < 0.001) continue;  // the slope is that at a micrometre
        const machine::Material m = material(law);
        const double d = 1e-5 * h;
        const auto above = components(edge_force(m, h + d, 1, ramp)), below = components(edge_force(m, h - d, 1, ramp));
        const auto slope = components(edge_force_slope(m, h, ramp));
        for (std::size_t i = 0; i < 3; ++i) {
          const double want = (above[i] - below[i]) / (2 * d);
          EXPECT_NEAR(slope[i], want, 1e-6 * std::abs(want));
        }
      }
}

TEST(EdgeForceOfEachLaw, IsZeroInAirAndFollowsTheWidth) {
  for (const auto& law : machine::force_laws()) {
    const machine::Material m = material(law);
    for (const double h : {-0.01, 0.0})
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(components(edge_force(m, h, 1))[i], 0) << law.word;
        EXPECT_EQ(components(edge_force_slope(m, h))[i], 0) << law.word;
      }
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_EQ(components(edge_force(m, 0.05, 0.5))[i], 0.5 * components(edge_force(m, 0.05, 1))[i]) << law.word;
  }
}

TEST(EdgeForceOfEachLaw, TheRampIsAChordWithoutAJump) {
  for (const auto& law : machine::force_laws()) {
    const machine::Material m = material(law);
    const auto at = components(edge_force(m, kRamp_mm, 1, kRamp_mm));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(components(edge_force(m, kRamp_mm, 1))[i], at[i], 1e-12 * std::abs(at[i])) << law.word;
      EXPECT_NEAR(components(edge_force(m, kRamp_mm / 4, 1, kRamp_mm))[i], at[i] / 4, 1e-12 * std::abs(at[i]))
          << law.word;
    }
  }
}

}  // namespace
}  // namespace camber::deflection
