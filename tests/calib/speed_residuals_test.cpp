// Where a model is wrong shows in the residuals of that kind or axis: the truth is a control, the model the same with
// one number changed.
#include <gtest/gtest.h>

#include "calib/feed_accuracy.h"
#include "tests/support/synthetic_control.h"

namespace camber::calib {
namespace {

class SpeedResiduals : public ::testing::Test {
 protected:
  SpeedResiduals() {
    for (machine::Axis& axis : control_.axis) axis.acceleration_mm_per_s2 = 1000;
    control_.control.corner.speed_difference_mm_per_s = 6;
    control_.control.block_time_s = 0.001;
    run_ = tests::traced_run(tests::ShortProtocol().program(), control_, {});
  }

  FeedAccuracy accuracy_of(const machine::Machine& model) const {
    return feed_accuracy(run_.trace, run_.program, model, parts_of(run_.program), {.kept_stations = 100});
  }
  static double rms(const FeedAccuracy& a, PathState state) {
    return a.by_state[static_cast<std::size_t>(state)].rms_percent;
  }

  machine::Machine control_ = tests::synthetic_control(3, machine::CornerLaw::speed_difference);
  FeedRun run_;
};

TEST_F(SpeedResiduals, AreNoneOfTheRightModelAndCountEveryStationOnce) {
  const FeedAccuracy a = accuracy_of(control_);
  std::size_t stations = 0;
  for (const SpeedResidual& r : a.by_state) {
    EXPECT_GT(r.stations, 0u);
    EXPECT_LT(r.rms_percent, 0.5);
    stations += r.stations;
  }
  EXPECT_EQ(stations, 2000 * a.parts.size());
  for (const SpeedResidual& r : a.by_axis) EXPECT_EQ(r.stations, stations);
  for (const PartAccuracy& part : a.parts) {
    EXPECT_EQ(part.speeds.traced.size(), 100u);
    EXPECT_EQ(part.speeds.model.size(), 100u);
  }
}

TEST_F(SpeedResiduals, NameCornersWhereTheirSpeedIsWrong) {
  machine::Machine model = control_;
  model.control.corner.speed_difference_mm_per_s *= 2;
  const FeedAccuracy a = accuracy_of(model);
  EXPECT_GT(rms(a, PathState::corner), 5.0);
  EXPECT_GT(rms(a, PathState::corner), 3 * rms(a, PathState::feed));
}

TEST_F(SpeedResiduals, NameArcsWhereTheirLimitIsWrong) {
  machine::Machine model = control_;
  model.control.arc_normal_fraction = 0.3;
  const FeedAccuracy a = accuracy_of(model);
  EXPECT_GT(rms(a, PathState::arc), 5.0);
  EXPECT_GT(rms(a, PathState::arc), 3 * rms(a, PathState::corner));
}

TEST_F(SpeedResiduals, NameTheAxisWhoseDriveIsWrong) {
  machine::Machine model = control_;
  model.axis[2].position_gain_per_s *= 0.5;
  const FeedAccuracy a = accuracy_of(model);
  for (const int other : {0, 1}) EXPECT_GT(a.by_axis[2].rms_percent, a.by_axis[other].rms_percent) << other;
}

}  // namespace
}  // namespace camber::calib
