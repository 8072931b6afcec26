#include "base/cancel.h"

#include <gtest/gtest.h>

#include <thread>

#include "camber/diagnostics.h"

namespace camber {
namespace {

TEST(Cancel, NothingIsStoppedWithoutAToken) { EXPECT_NO_THROW(cancellation_point()); }

TEST(Cancel, AStopIsSeenWithinItsScopeOnItsThread) {
  std::stop_source stop;
  const CancelScope scope(stop.get_token());
  EXPECT_NO_THROW(cancellation_point());
  stop.request_stop();
  EXPECT_THROW(cancellation_point(), Cancelled);
  std::thread([] { EXPECT_NO_THROW(cancellation_point()); }).join();
}

TEST(Cancel, ScopesNest) {
  std::stop_source outer, inner;
  const CancelScope scope(outer.get_token());
  {
    const CancelScope within(inner.get_token());
    inner.request_stop();
    EXPECT_THROW(cancellation_point(), Cancelled);
  }
  EXPECT_NO_THROW(cancellation_point());
  outer.request_stop();
  EXPECT_THROW(cancellation_point(), Cancelled);
}

TEST(Cancel, AThreadMayEndWithAToken) {
  std::stop_source stop;
  std::thread([&] {
    set_stop_token(stop.get_token());
    const CancelScope within{std::stop_token()};
    EXPECT_NO_THROW(cancellation_point());
  }).join();
  stop.request_stop();
  std::thread([&] {
    set_stop_token(stop.get_token());
    EXPECT_THROW(cancellation_point(), Cancelled);
    set_stop_token({});
    EXPECT_NO_THROW(cancellation_point());
  }).join();
}

}  // namespace
}  // namespace camber
