#include "base/stage.h"

#include <stop_token>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/cancel.h"
#include "camber/diagnostics.h"

namespace camber {
namespace {

using Shown = std::vector<std::pair<std::string, double>>;

StageSink into(Shown& shown) {
  return [&shown](const std::string& what, double share) { shown.emplace_back(what, share); };
}

/// Longer than the time between two looks at a stage.
void wait() { std::this_thread::sleep_for(std::chrono::milliseconds(60)); }

TEST(Stage, ShowsItsBeginningAndTheShareThatIsDone) {
  Shown shown;
  const StageScope scope(into(shown));
  Stage stage("carving", 8);
  wait();
  stage.advance(2);
  stage.advance(4);  // too soon to be shown
  wait();
  stage.advance(4);
  EXPECT_EQ(shown, (Shown{{"carving", 0.0}, {"carving", 0.25}, {"carving", 1.0}})) << "no more than the whole";
}

TEST(Stage, OfAnotherThreadCountsAndIsNotShownThere) {
  Shown shown;
  const StageScope scope(into(shown));
  Stage stage("carving", 4);
  wait();
  std::thread([&] {
    stage.advance(3);
    Stage own("not shown", 1);
  }).join();
  ASSERT_EQ(shown.size(), 1u);
  stage.advance();
  EXPECT_EQ(shown.back(), std::pair(std::string("carving"), 1.0));
}

TEST(Stage, WithinAnotherOneIsPartOfIt) {
  Shown shown;
  const StageScope scope(into(shown));
  {
    Stage outer("outer", 1);
    Stage inner("inner", 1);
  }
  Stage next("next", 1);
  EXPECT_EQ(shown, (Shown{{"outer", 0.0}, {"next", 0.0}}));
}

TEST(Stage, AnEmptyScopeLeavesTheOneAroundItInPlace) {
  Shown shown;
  const StageScope scope(into(shown));
  {
    const StageScope empty({});
    Stage("seen", 1).advance();
  }
  Shown other;
  {
    const StageScope inner(into(other));
    Stage("elsewhere", 1).advance();
  }
  Stage("seen again", 1).advance();
  EXPECT_EQ(shown, (Shown{{"seen", 0.0}, {"seen again", 0.0}}));
  EXPECT_EQ(other, (Shown{{"elsewhere", 0.0}}));
}

TEST(Stage, IsACancellationPoint) {
  std::stop_source stop;
  const CancelScope scope(stop.get_token());
  Stage stage("carving", 2);
  EXPECT_NO_THROW(stage.advance());
  stop.request_stop();
  EXPECT_THROW(stage.advance(), Cancelled);
}

}  // namespace
}  // namespace camber
