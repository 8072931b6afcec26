// The spindle's power over its speed.
#include <limits>

#include <gtest/gtest.h>

#include "simulate/spindle_power.h"

namespace camber::simulate {
namespace {

TEST(SpindlePower, RisesToConstantPowerAndFallsBeyondIt) {
  machine::Spindle spindle;
  EXPECT_EQ(spindle_power_at(spindle, 5000), std::numeric_limits<double>::infinity());
  spindle.power_W = 26000;
  for (const double rpm : {100.0, 12000.0}) EXPECT_EQ(spindle_power_at(spindle, rpm), 26000) << rpm;
  spindle.constant_torque_rpm = 1500;
  spindle.constant_power_rpm = 6000;
  EXPECT_DOUBLE_EQ(spindle_power_at(spindle, 300), 5200);
  EXPECT_DOUBLE_EQ(spindle_power_at(spindle, 1500), 26000);
  EXPECT_DOUBLE_EQ(spindle_power_at(spindle, 6000), 26000);
  EXPECT_DOUBLE_EQ(spindle_power_at(spindle, 12000), 13000);
}

}  // namespace
}  // namespace camber::simulate
