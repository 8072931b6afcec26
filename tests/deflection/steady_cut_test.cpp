// Forces of steady cuts against the closed forms of Altintas, Manufacturing Automation, 2nd ed., ch. 2, against
// published measurements, and against a simulator of its own.
#include "deflection/steady_cut.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/cutting.h"
#include "tests/support/milling_simulator.h"

namespace camber::deflection {
namespace {

using testing::make_tool;

constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};
constexpr double kRounding = 1e-9;

TEST(SteadyCut, SlotMeansAreTheClosedForm) {
  const auto tool = make_tool(machine::ToolType::flat, 10, 3, 30);
  const double a = 2, f = 0.05, n = 3;
  const Vec3 mean = SteadyCutModel(tool, {f, a, 10, Milling::up}).mean_N(kSteel);
  EXPECT_NEAR(mean.x(), -n * a * f / 4 * 700 - n * a / kPi * 12, kRounding);
  EXPECT_NEAR(mean.y(), n * a * f / 4 * 2000 + n * a / kPi * 15, kRounding);
  EXPECT_NEAR(mean.z(), -(n * a * f / kPi * 300 + n * a / 2 * 5), kRounding);
}

TEST(SteadyCut, MeansAtAnyImmersionAreTheClosedForm) {
  // phi clockwise from the left of the feed, entry to exit:
  // Fx = N a f / 8 pi (Ktc cos 2phi - Krc (2 phi - sin 2phi)) + N a / 2 pi (-Kte sin phi + Kre cos phi), and so on.
  const double a = 3, f = 0.08, n = 4, radius = 8;
  for (const double ae : {0.5, 3.0, 8.0, 11.0, 16.0})
    for (const Milling milling : {Milling::up, Milling::down}) {
      const double angle = std::acos(1 - ae / radius);
      const double from = milling == Milling::up ? 0 : kPi - angle, to = milling == Milling::up ? angle : kPi;
      const auto between = [&](auto g) { return g(to) - g(from); };
      const machine::Material& m = kSteel;
      const double x = between([&](double p) {
        return n * a * f / (8 * kPi) * (m.ktc_MPa * std::cos(2 * p) - m.krc_MPa * (2 * p - std::sin(2 * p))) +
               n * a / (2 * kPi) * (-m.kte_N_per_mm * std::sin(p) + m.kre_N_per_mm * std::cos(p));
      });
      const double y = between([&](double p) {
        return n * a * f / (8 * kPi) * (m.ktc_MPa * (2 * p - std::sin(2 * p)) + m.krc_MPa * std::cos(2 * p)) -
               n * a / (2 * kPi) * (m.kte_N_per_mm * std::cos(p) + m.kre_N_per_mm * std::sin(p));
      });
      const double up =
          between([&](double p) { return n * a / (2 * kPi) * (-m.kac_MPa * f * std::cos(p) + m.kae_N_per_mm * p); });
      for (const double helix : {0.0, 45.0}) {
        const auto tool = make_tool(machine::ToolType::flat, 2 * radius, 4, helix);
        const Vec3 mean = SteadyCutModel(tool, {f, a, ae, milling}).mean_N(kSteel);
        EXPECT_NEAR(mean.x(), x, 1e-8) << ae;
        EXPECT_NEAR(mean.y(), y, 1e-8) << ae;
        EXPECT_NEAR(mean.z(), -up, 1e-8) << ae;
      }
    }
}

TEST(SteadyCut, BallSlotMeansAreTheClosedForm) {
  // A slot as deep as the ball's radius: over kappa = 0 ... pi/2, db = R dkappa, h = f sin phi sin kappa.
  // Ft dirs: mean y = N/(2 pi) (Ktc f pi/2 R + Kte 2 R pi/2); radial and axial as integrated by hand below.
  const double radius = 4, f = 0.04, n = 2;
  const machine::Material& m = kSteel;
  const auto tool = make_tool(machine::ToolType::ball, 2 * radius, 2, 30);
  const Vec3 mean = SteadyCutModel(tool, {f, radius, 2 * radius, Milling::up}, 0.01).mean_N(kSteel);
  const double per_turn = n / (2 * kPi);
  EXPECT_NEAR(mean.y(), per_turn * radius * (m.ktc_MPa * f * kPi / 2 + m.kte_N_per_mm * kPi), 1e-4 * mean.y());
  // x: radial sin kappa and axial cos kappa, both times sin phi.
  const double x = -per_turn * radius *
                   (m.krc_MPa * f * kPi / 2 * (kPi / 4) + 2 * m.kre_N_per_mm * 1 + m.kac_MPa * f * kPi / 2 * 0.5 +
                    2 * m.kae_N_per_mm * 1);
  EXPECT_NEAR(mean.x(), x, 1e-4 * std::abs(x));
  // z: radial -cos kappa, axial sin kappa.
  const double z =
      -per_turn * radius *
      (-m.krc_MPa * f * 2 * 0.5 - m.kre_N_per_mm * kPi + m.kac_MPa * f * 2 * (kPi / 4) + m.kae_N_per_mm * kPi);
  EXPECT_NEAR(mean.z(), z, 1e-4 * std::abs(z));
}

TEST(SteadyCut, ForceIsConstantAtAWholeAxialPitch) {
  // Depth = pitch of the helix / flutes: at every instant some tooth stands at every angle.
  const double helix = 40, radius = 5;
  const double depth = 2 * kPi / 3 * radius / std::tan(helix * kPi / 180);
  const auto tool = make_tool(machine::ToolType::flat, 2 * radius, 3, helix);
  const SteadyCutModel model(tool, {0.05, depth, 3, Milling::down}, 0.02);
  const Vec3 mean = model.mean_N(kSteel);
  for (const Vec3& f : model.waveform_N(kSteel, RunOut::Zero(), 0.3, 180))
    EXPECT_LT((f - mean).norm(), 0.002 * mean.norm());
}

TEST(SteadyCut, WaveformAveragesToTheMean) {
  const auto tool = make_tool(machine::ToolType::bull, 12, 4, 25);
  machine::Tool bull = tool;
  bull.corner_radius_mm = 2;
  const SteadyCutModel model(bull, {0.06, 3, 4, Milling::up});
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : model.waveform_N(kSteel, RunOut::Zero(), 1.1, 360)) sum += f / 360;
  EXPECT_LT((sum - model.mean_N(kSteel)).norm(), 1e-4 * sum.norm());
}

TEST(SteadyCut, TorqueAndPowerFollowTheRemovalRate) {
  // Without edge terms the spindle's work over the volume is Ktc: P = Ktc Q.
  machine::Material m{1800, 500, 200};
  for (const double ae : {2.0, 12.0}) {
    const auto tool = make_tool(machine::ToolType::flat, 12, 4, 30);
    const double f = 0.07, ap = 3, rpm = 4000;
    const SteadyCutModel model(tool, {f, ap, ae, Milling::down});
    const double rate_mm3_per_s = ap * ae * f * 4 * rpm / 60;
    EXPECT_NEAR(model.chip_mm3(), ap * ae * f, 1e-6);
    EXPECT_NEAR(model.torque_mean_Nmm(m) * 2 * kPi * rpm / 60, 1800 * rate_mm3_per_s, 1e-6 * 1800 * rate_mm3_per_s);
  }
}

TEST(SteadyCut, KienzleSlotHasTheSpecificEnergyOfTheCatalogue) {
  const std::vector<machine::CatalogueRow> exact{{0.1, 2000}, {0.2, 2000 * std::pow(2.0, -0.25)}};
  const auto pair = machine::kienzle_from_catalogue(exact);
  EXPECT_NEAR(pair.m, 0.25, 1e-12);
  machine::Material m;
  m.law = machine::ForceLaw::kienzle;
  m.kc1_1_MPa = pair.k1_1_MPa;
  m.mc = pair.m;
  const auto tool = make_tool(machine::ToolType::flat, 50, 4, 0);
  for (const auto& row : exact) {
    const SteadyCutModel slot(tool, {row.feed_per_tooth_mm, 2, 50, Milling::up});
    const double energy = slot.torque_mean_Nmm(m) * 2 * kPi / 4 / slot.chip_mm3();
    EXPECT_NEAR(energy, row.kc_MPa, 1e-3 * row.kc_MPa);
  }
}

TEST(SteadyCut, RunOutAgreesWithAnIndependentSimulator) {
  testing::SimulatedCut c;
  c.radius_mm = 10, c.helix_rad = 30 * kPi / 180, c.axial_depth_mm = 4, c.radial_depth_mm = 6;
  c.flutes = 3, c.up = false, c.feed_per_tooth_mm = 0.05;
  c.ktc = 2000, c.krc = 700, c.kac = 300, c.kte = 15, c.kre = 12, c.kae = 5;
  c.run_out_mm = 0.03, c.run_out_rad = 0.7;
  const auto tool = make_tool(machine::ToolType::flat, 20, 3, 30);
  const SteadyCutModel model(tool, {0.05, 4, 6, Milling::down}, 0.05);
  const RunOut run_out(0.03 * std::cos(0.7), 0.03 * std::sin(0.7));
  constexpr int kSteps = 120;
  const auto wave = model.waveform_N(kSteel, run_out, 0, kSteps);
  double largest = 0, worst = 0;
  for (int i = 0; i < kSteps; ++i) {
    Vec3 mean = Vec3::Zero();  // over the step, as the model
    constexpr int kParts = 8;
    for (int p = 0; p < kParts; ++p) {
      const double turned = (i + (p + 0.5) / kParts) * 2 * kPi / kSteps;
      const auto s = testing::simulate_at(c, turned / (2 * kPi * c.rpm / 60));
      mean += Vec3(s.x_N, s.y_N, s.z_N) / kParts;
    }
    largest = std::max(largest, mean.norm());
    worst = std::max(worst, (mean - wave[static_cast<std::size_t>(i)]).norm());
  }
  EXPECT_GT(largest, 100);
  EXPECT_LT(worst, 0.02 * largest);  // c/R = 0.005, 60 slices
}

// Measured slot: D25, 2 flutes, helix 45, ap 3 mm, 6000 rpm; x feed, y normal, z as reported (on the work).
TEST(SteadyCut, PublishedCoefficientsGiveTheMeasuredSlotMeans) {
  constexpr machine::Material published{958.9, 250.9, 146.4, 15.76, 19.43, 18.21};
  const double feeds[] = {300, 600, 900, 1200, 1500};
  const Vec3 measured[] = {
      {-39.8, 63.0, 55.7}, {-60.1, 107.1, 70.9}, {-71.6, 137.7, 82.6}, {-76.8, 171.3, 85.2}, {-78.5, 210.7, 83.5}};
  const auto tool = make_tool(machine::ToolType::flat, 25, 2, 45);
  for (int i = 0; i < 5; ++i) {
    const Vec3 mean = SteadyCutModel(tool, {feeds[i] / 12000, 3, 25, Milling::up}).mean_N(published);
    EXPECT_NEAR(mean.x(), measured[i].x(), 8);
    EXPECT_NEAR(mean.y(), measured[i].y(), 8);
    EXPECT_NEAR(-mean.z(), measured[i].z(), 8);
    std::printf("case 2, F%-5g model - measured: %+5.1f %+5.1f %+5.1f N\n", feeds[i], mean.x() - measured[i].x(),
                mean.y() - measured[i].y(), -mean.z() - measured[i].z());
  }
}

// Bull-nose D16 R3, 2 flutes, helix 25, slot, 0.1 mm a tooth, with coefficients from elsewhere.
TEST(SteadyCut, BullNoseSlotMeansAgainstMeasuredOnes) {
  constexpr machine::Material elsewhere{796.1, 168.8, 222, 27.7, 30.8, 1.4};
  const double measured[] = {72, 138, 200, 253, 310};
  auto tool = make_tool(machine::ToolType::bull, 16, 2, 25);
  tool.corner_radius_mm = 3;
  for (int ap = 1; ap <= 5; ++ap) {
    const Vec3 mean = SteadyCutModel(tool, {0.1, static_cast<double>(ap), 16, Milling::up}, 0.02).mean_N(elsewhere);
    const double rounded = ap < 3 ? 3 * std::acos(1 - ap / 3.0) : 3 * kPi / 2 + (ap - 3);
    EXPECT_NEAR(mean.y(), 796.1 * 0.1 * ap / 2 + 27.7 * 2 / kPi * rounded, 0.1);  // N/2pi (Ktc f pi/2 a + 2 Kte s)
    EXPECT_NEAR(mean.y(), measured[ap - 1], ap == 1 ? 13.0 : 8.0);
    std::printf("case 3, ap %d: %6.1f N, measured %g: %+5.1f N (%+.1f %%)\n", ap, mean.y(), measured[ap - 1],
                mean.y() - measured[ap - 1], 100 * (mean.y() / measured[ap - 1] - 1));
  }
}

}  // namespace
}  // namespace camber::deflection
