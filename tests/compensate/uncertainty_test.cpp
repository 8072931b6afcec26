// Standard errors of parameters, and the band around the error that follows from them.
#include "compensate/uncertainty.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

TEST(Uncertainty, ReadsTheCommentsOfFittedFiles) {
  const tests::TempFolder folder;
  const auto groups = read_uncertainty(
      folder.write("m.toml",
                   "# ktc_MPa: 800 +- 12 MPa\n# kte_N_per_mm: 20 +- 3 N/mm\n# kre_N_per_mm: 5 +- 0 N/mm\n"
                   "ktc_MPa = 800\n# axis.x.position_gain_per_s: 30 +- 0.5 1/s\n"));
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[0].name, "cutting");
  EXPECT_EQ(groups[1].name, "drives");
  EXPECT_EQ(groups[2].name, "edge");
  EXPECT_EQ(groups[0].parameters.at(0).name, "ktc_MPa");
  EXPECT_EQ(groups[0].parameters.at(0).value, 800);
  EXPECT_EQ(groups[0].parameters.at(0).std_error, 12);
  EXPECT_EQ(groups[2].parameters.size(), 1u) << "without a standard error it is certain";
}

TEST(Uncertainty, APercentageMovesForceAndStiffness) {
  machine::Job job;
  job.material.ktc_MPa = 800, job.material.kte_N_per_mm = 20;
  job.tools[1].youngs_modulus_MPa = 600000;
  job.tools[1].root_stiffness_N_per_mm = 9000;
  std::vector<std::string> unknown;
  const auto groups = read_uncertainty("20 %");
  ASSERT_EQ(groups.size(), 2u);
  const machine::Job force = moved(job, groups[0], unknown), stiffness = moved(job, groups[1], unknown);
  EXPECT_DOUBLE_EQ(force.material.ktc_MPa, 960);
  EXPECT_DOUBLE_EQ(force.material.kte_N_per_mm, 24);
  EXPECT_EQ(force.tools.at(1).youngs_modulus_MPa, 600000);
  EXPECT_EQ(stiffness.material.ktc_MPa, 800);
  EXPECT_DOUBLE_EQ(stiffness.tools.at(1).youngs_modulus_MPa, 500000);
  EXPECT_DOUBLE_EQ(stiffness.tools.at(1).root_stiffness_N_per_mm, 7500);
  EXPECT_TRUE(unknown.empty());
}

/// Two places, one cut 20 um too deep by the whole compensation; the tolerance is 10 um.
Band band_where(double deep_area_mm2, double sigma_mm) {
  std::vector<removal::SurfacePoint> before(2), after(2);
  before[0].area_mm2 = after[0].area_mm2 = deep_area_mm2;
  before[1].area_mm2 = after[1].area_mm2 = 1000 - deep_area_mm2;
  after[0].error_mm = -0.020;
  return band_of(before, after, {"cutting"}, {{sigma_mm, 0}}, 0.010);
}

TEST(Uncertainty, FivePercentOfTheAreaMayBeTooDeep) {
  EXPECT_DOUBLE_EQ(band_where(49.5, 0).safe_fraction, 1);
  EXPECT_DOUBLE_EQ(band_where(50.5, 0).safe_fraction, 0.5);
  EXPECT_DOUBLE_EQ(band_where(50.5, 0.001).safe_fraction, 0.41);  // (10 - 1.645) / 20, whole percent
}

TEST(Uncertainty, FiguresOfTheBand) {
  const Band band = band_where(250, 0.002);
  EXPECT_DOUBLE_EQ(band.groups.at(0).rms_um, 1);  // 2 um on a quarter of the area
  EXPECT_DOUBLE_EQ(band.sigma_rms_um, 1);
  EXPECT_NEAR(band.rms_um, std::hypot(10, 1), 1e-9);
  EXPECT_NEAR(band.deepest_um, 20 + 1.645 * 2, 1e-9);
  EXPECT_NEAR(band.p95_um, 20 + 1.96 * 2, 1e-9);
}

}  // namespace
}  // namespace camber::compensate
