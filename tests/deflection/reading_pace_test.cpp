#include "deflection/static_cut.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace camber::deflection {
namespace {

removal::Stamp stamp_with(double feed_mm, bool first = false) {
  removal::Stamp s;
  s.feed_per_tooth_mm = {feed_mm, 0, 0};
  s.first = first;
  return s;
}

struct Walk {
  std::vector<std::size_t> read;
  double worst_mm = 0;  ///< difference of an extrapolated deflection from the true one
  ReadingPace::Errors errors;
};

constexpr double kAllowed_um = 0.1;

/// Passings with a deflection of one number, `true_mm`; `glance`: material met.
Walk walk(std::size_t passings, std::size_t period, const std::function<double(std::size_t)>& true_mm,
          const std::function<double(std::size_t)>& glance, const std::function<removal::Stamp(std::size_t)>& stamp) {
  Walk out;
  ReadingPace pace(period);
  for (std::size_t k = 0; k < passings; ++k) {
    std::vector<float> row(1);
    const bool may = pace.may_follow(k, stamp(k));
    if (pace.has_line(k)) pace.follow(k, row);
    if (may && pace.as_much_material(k, glance(k))) {
      out.worst_mm = std::max(out.worst_mm, std::abs(static_cast<double>(row[0]) - true_mm(k)));
      continue;
    }
    ReadingPace::Reading reading{glance(k), 1000 * std::abs(static_cast<double>(row[0]) - true_mm(k)), kAllowed_um};
    row[0] = static_cast<float>(true_mm(k));
    pace.was_read(k, stamp(k), row, reading);
    out.read.push_back(k);
  }
  out.errors = pace.errors();
  return out;
}

double as_ever(std::size_t) { return 1; }
removal::Stamp even(std::size_t k) { return stamp_with(0.1, k == 0); }

TEST(ReadingPace, AConstantDeflectionIsReadEveryEighthPassing) {
  const Walk w = walk(
      800, 1, [](std::size_t) { return 0.01; }, as_ever, even);
  EXPECT_NEAR(static_cast<double>(w.read.size()), 100, 6);
  EXPECT_LT(w.worst_mm, 1e-8);
}

TEST(ReadingPace, TheErrorOfACurvedCourseStaysNearTheAllowedOne) {
  const auto course = [](std::size_t k) { return 0.02 * std::sin(static_cast<double>(k) / 30); };
  const Walk w = walk(2000, 1, course, as_ever, even);
  EXPECT_LT(w.read.size(), 1200u);
  EXPECT_LT(w.worst_mm, 3e-3 * kAllowed_um);
  EXPECT_LT(w.errors.max_um, 4 * kAllowed_um);
  EXPECT_GT(w.errors.count, 100u);
}

TEST(ReadingPace, ACourseThatJittersIsReadNearlyEveryTime) {
  const auto course = [](std::size_t k) { return 0.01 + (k * 7919 % 13 < 6 ? 0.0005 : -0.0005); };
  EXPECT_GT(walk(400, 1, course, as_ever, even).read.size(), 250u);
}

TEST(ReadingPace, MoreMaterialIsReadAtOnce) {
  const auto course = [](std::size_t k) { return k < 203 ? 0.01 : 0.02; };
  const auto glance = [](std::size_t k) { return k < 203 ? 5.0 : 6.0; };
  const Walk w = walk(400, 1, course, glance, even);
  EXPECT_TRUE(std::ranges::count(w.read, 203u));
  EXPECT_LT(w.worst_mm, 1e-8);
}

TEST(ReadingPace, AnotherMotionAndANewCutAreReadAtOnce) {
  const auto course = [](std::size_t k) { return k < 101 ? 0.01 : k < 202 ? 0.02 : 0.03; };
  const auto stamp = [](std::size_t k) { return stamp_with(k < 101 ? 0.1 : 0.12, k == 0 || k == 202); };
  const Walk w = walk(300, 1, course, as_ever, stamp);
  for (const std::size_t k : {101u, 202u, 203u}) EXPECT_TRUE(std::ranges::count(w.read, k)) << k;
  EXPECT_LT(w.worst_mm, 1e-8);
}

TEST(ReadingPace, TeethThatDifferHaveALineEach) {
  const auto course = [](std::size_t k) { return k % 3 == 0 ? 0.01 : k % 3 == 1 ? 0.02 : 0.005; };
  const Walk w = walk(2400, 3, course, as_ever, even);
  EXPECT_LT(w.read.size(), 400u);
  EXPECT_LT(w.worst_mm, 1e-8);
}

}  // namespace
}  // namespace camber::deflection
