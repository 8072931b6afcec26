// Multipliers against a simulation in time, with loss of contact.
#include <random>

#include <gtest/gtest.h>

#include "dynamics/semi_discretisation.h"
#include "tests/support/chatter_simulation.h"

namespace camber::dynamics {
namespace {

struct RandomCut {
  std::vector<Mode> modes;
  Cut cut;
  double speed_rpm = 0, depth_mm = 0;
};

RandomCut random_cut(std::mt19937& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto of = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  RandomCut r;
  r.modes = {{Vec2::UnitX(), between(500, 1000), between(0.01, 0.05), between(1000, 6000)},
             {Vec2::UnitY(), between(500, 1000), between(0.01, 0.05), between(1000, 6000)}};
  const double kt = between(500, 2000);
  r.cut.slices = {shoulder(between(0.05, 1), of(2) ? Milling::up : Milling::down, kt, kt * between(0.1, 0.5))};
  r.cut.pitch_rad = equal_pitches(2 + of(3));
  constexpr double kRadius_mm = 5;
  r.cut.lag_rad_per_mm = std::tan(of(3) * 15 * kPi / 180) / kRadius_mm;
  r.speed_rpm = between(3000, 20000);
  const double lowest = ZeroOrderLobes(r.modes, r.cut).lowest_depth_mm();
  r.depth_mm = lowest * between(0.4, 4);
  return r;
}

testing::VibrationVerdict simulated(const RandomCut& r) {
  testing::VibratingCut c;
  for (const Mode& m : r.modes) c.modes.push_back({m.direction, m.frequency_hz, m.damping_ratio, m.stiffness_N_per_mm});
  const CutSlice& s = r.cut.slices.front();
  c.teeth = static_cast<int>(r.cut.pitch_rad.size());
  c.entry_rad = s.entry_rad, c.exit_rad = s.exit_rad, c.kt_MPa = s.kt_MPa, c.kr_MPa = s.kr_MPa;
  c.depth_mm = r.depth_mm, c.lag_rad_per_mm = r.cut.lag_rad_per_mm, c.speed_rpm = r.speed_rpm;
  return testing::simulate_chatter(c);
}

bool unstable(const RandomCut& r, double of_depth) {
  return std::abs(dominant_multiplier(r.modes, r.cut, r.speed_rpm, of_depth * r.depth_mm)) > 1;
}

/// Returns how many verdicts differ; each of these must be within 10 % of the border.
int differences(int points, int& chattering) {
  std::mt19937 random(7);
  int different = 0;
  for (int i = 0; i < points; ++i) {
    const RandomCut r = random_cut(random);
    const bool chatters = simulated(r).chatters;
    chattering += chatters;
    if (chatters == unstable(r, 1)) continue;
    ++different;
    EXPECT_TRUE(unstable(r, 0.9) == chatters || unstable(r, 1.1) == chatters)
        << "point " << i << " at " << r.speed_rpm << " rpm, " << r.depth_mm << " mm";
  }
  return different;
}

TEST(TimeDomain, AgreesOnWhetherACutChatters) {
  int chattering = 0;
  EXPECT_LE(differences(15, chattering), 1);
  EXPECT_GT(chattering, 3);
  EXPECT_LT(chattering, 12);
}

TEST(TimeDomainSlow, AgreesInNineteenOfTwentyOfTwoHundredCuts) {
  int chattering = 0;
  EXPECT_LE(differences(200, chattering), 10);
  EXPECT_GT(chattering, 50);
  EXPECT_LT(chattering, 150);
}

}  // namespace
}  // namespace camber::dynamics
