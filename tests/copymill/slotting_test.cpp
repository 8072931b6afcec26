// Trochoids instead of full cuts, in a slot of 12 mm (48 x 12 x 6) with a cutter of 8 mm.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "copymill/copy_milling.h"
#include "copymill/slotting.h"
#include "tests/copymill/small_copy.h"
#include "tests/support/height_map_judge.h"

namespace camber::copymill {
namespace {

constexpr double kRadius = 4, kRadial = 1.6, kDeep = -6;

std::string loops(const std::string& keys) {
  return "[[copy]]\ntool = 1\nmode = \"contour-line\"\nspindle_rpm = 2000\nfeed_mm_per_min = 600\nradial_depth_mm = "
         "1.6\n"
         "axial_depth_mm = 6\n" +
         keys;
}

struct Slotted {
  CopyResult result;
  std::vector<Tick> ticks;
};

Slotted slot(const std::string& operations, std::optional<double> stop_after_s = {}) {
  const tests::TempFolder folder;
  const tests::ReadCopy read = tests::read_copy(
      folder, {.part = "slot", .stock = "box_mm = [[0, 0, -12], [60, 30, 0]]", .operations = operations});
  Slotted out;
  Diagnostics diagnostics;
  CopyOptions options;
  options.stop_after_s = stop_after_s;
  options.stream = [&](const Tick& t) { out.ticks.push_back(t); };
  out.result = copy(read.job, read.operations, options, diagnostics);
  return out;
}

std::vector<Cause> slot_causes(const CopyResult& r) {
  std::vector<Cause> out;
  for (const Change& c : r.operations.at(0).changes)
    if (c.what == Quantity::radial_engagement) out.push_back(c.cause);
  return out;
}

/// A map of heights, from which discs are taken at the stream's places: where the cutter's leading half circumference
/// meets material of more than 0.3 mm above its tip, in degrees, 0.3 mm apart. Places on the slot's own
/// border and near its ends, where loops go into corners, are left out, and with `on_floor` the helix.
std::vector<int> engagements_deg(const std::vector<Tick>& ticks, bool on_floor) {
  // What was cut one place before reaches asin(0.03 / 0.3) = 6 degrees around the circumference that is looked at.
  constexpr double kCell = 0.04, kApart = 0.3, kInside = 0.03;
  constexpr int kNx = 1500, kNy = 750;
  std::vector<float> top(static_cast<std::size_t>(kNx) * kNy, 0);
  const auto take = [&](const Vec3& tip) {
    const int j0 = static_cast<int>((tip.y() - kRadius) / kCell), j1 = static_cast<int>((tip.y() + kRadius) / kCell);
    for (int j = std::max(0, j0); j <= std::min(kNy - 1, j1); ++j) {
      const double dy = j * kCell - tip.y(), half = kRadius * kRadius - dy * dy;
      if (half <= 0) continue;
      const int i0 = std::max(0, static_cast<int>(std::ceil((tip.x() - std::sqrt(half)) / kCell)));
      const int i1 = std::min(kNx - 1, static_cast<int>((tip.x() + std::sqrt(half)) / kCell));
      for (int i = i0; i <= i1; ++i) {
        float& height = top[static_cast<std::size_t>(j) * kNx + static_cast<std::size_t>(i)];
        height = std::min(height, static_cast<float>(tip.z()));
      }
    }
  };
  const auto stands = [&](const Vec2& p, double z) {
    const auto i = std::lround(p.x() / kCell), j = std::lround(p.y() / kCell);
    return i >= 0 && j >= 0 && i < kNx && j < kNy &&
           top[static_cast<std::size_t>(j) * kNx + static_cast<std::size_t>(i)] > z + 0.3;
  };
  std::vector<int> out;
  Vec3 before = ticks.front().tip_mm;
  for (const Tick& t : ticks) {
    const Vec2 way = (t.tip_mm - before).head<2>();
    if (way.norm() < kApart) continue;
    const Vec2 at = t.tip_mm.head<2>(), along = way.normalized();
    const bool border = at.y() < 13.01 || at.y() > 16.99 || at.x() < 15 || at.x() > 45;
    const bool floor = std::abs(t.tip_mm.z() - kDeep) < 1e-6 && std::abs(before.z() - kDeep) < 1e-6;
    if (t.tip_mm.z() < 0 && (floor || !on_floor) && !border) {
      int engaged = 0;
      for (int d = -90; d < 90; ++d) {
        const double a = std::atan2(along.y(), along.x()) + (d + 0.5) * kPi / 180;
        engaged += stands(at + (kRadius - kInside) * Vec2(std::cos(a), std::sin(a)), t.tip_mm.z()) ? 1 : 0;
      }
      out.push_back(engaged);
    }
    if (t.tip_mm.z() < 0) take(t.tip_mm);
    before = t.tip_mm;
  }
  return out;
}

TEST(Slotting, TrochoidsStayWithinTheEngagementOfTheRadialDepth) {
  const Slotted full = slot(loops("slotting = \"full-width\"\n")), loop = slot(loops("slotting = \"trochoidal\"\n"));
  EXPECT_EQ(full.result.operations.at(0).trochoid_circles, 0u);
  EXPECT_GT(loop.result.operations.at(0).trochoid_circles, 20u);
  const double limit = engagement_angle_rad(kRadius, kRadial) * 180 / kPi;
  EXPECT_NEAR(limit, 53.1, 0.1);
  const std::vector<int> of_full = engagements_deg(full.ticks, false), of_loop = engagements_deg(loop.ticks, true);
  EXPECT_GE(*std::ranges::max_element(of_full), 165);
  ASSERT_GT(of_loop.size(), 500u);
  EXPECT_LE(*std::ranges::max_element(of_loop), limit + 5);
  EXPECT_GE(*std::ranges::max_element(of_loop), limit - 12);
  EXPECT_EQ(slot_causes(loop.result), std::vector<Cause>{Cause::trochoids_asked_for});
}

/// By the judge that shares no code, and by the closed form of what a cutter of 4 mm radius takes out of the slot.
TEST(Slotting, TrochoidsLeaveTheSlot) {
  for (const std::string mode : {"contour-line", "scanning-line"}) {
    const std::string operation = loops("slotting = \"trochoidal\"\n");
    const Slotted run = slot(std::string(operation).replace(operation.find("contour-line"), 12, mode));
    EXPECT_GT(run.result.operations.at(0).trochoid_circles, 20u) << mode;
    const double closed_mm3 = (48 * 12 - (4 - kPi) * 16) * 6;
    EXPECT_NEAR(run.result.removed_mm3 / closed_mm3, 1, 0.002) << mode;
    EXPECT_LT(run.result.path_depth_um, 5) << mode;
    judge::Question q{{0, 0, -12}, {60, 30, 0}};
    q.cell = 0.2;
    q.cutters[1] = {.diameter = 8};
    const judge::Verdict v =
        judge::judge(judge::ProgramReader().read(run.result.text),
                     judge::PartMesh(judge::read_stl(CAMBER_SOURCE_DIR "/samples/14-copy-milling/slot.stl")), q);
    EXPECT_LT(v.gouge.depth, 0.01) << mode;
    EXPECT_LT(v.left_reachable.depth, 0.02) << mode;
    EXPECT_EQ(v.rapid.depth, 0) << mode;
  }
}

TEST(Slotting, ByLoadWhereFeedAndDepthsCannotHoldAFullCut) {
  const CopyResult high = slot(loops("force_N = 300\n")).result;
  EXPECT_EQ(high.operations.at(0).trochoid_circles, 0u);
  const std::vector<Cause> causes = slot_causes(high);
  ASSERT_FALSE(causes.empty());
  EXPECT_TRUE(std::ranges::all_of(causes, [](Cause c) { return c == Cause::full_cut_within_limit; }));
  const CopyResult low = slot(loops("force_N = 30\n"), 30).result;
  EXPECT_GT(low.operations.at(0).trochoid_circles, 5u);
  EXPECT_EQ(slot_causes(low).front(), Cause::full_cut_over_limit);
}

/// A target that the circles can hold: all of their tooth passings stay within 105 % of it.
TEST(Slotting, TrochoidsFollowTheLoad) {
  const Slotted run = slot(loops("slotting = \"trochoidal\"\nforce_N = 400\n"), 60);
  EXPECT_GT(run.result.operations.at(0).trochoid_circles, 20u);
  double greatest = 0;
  for (const Tick& t : run.ticks) greatest = std::max(greatest, t.load_N);
  EXPECT_LT(greatest, 1.05 * 400);
  EXPECT_GT(greatest, 0.5 * 400);
}

TEST(Slotting, WithoutATargetNothingChanges) {
  EXPECT_EQ(slot(loops("")).result.text, slot(loops("slotting = \"full-width\"\n")).result.text);
}

/// Circles would have a radius of 0.25 mm, where 0.4 mm is the least.
TEST(Slotting, SaysWhereASlotIsTooNarrow) {
  const CopyResult r = slot(loops("slotting = \"trochoidal\"\nallowance_mm = 1.75\n")).result;
  EXPECT_EQ(r.operations.at(0).trochoid_circles, 0u);
  const std::vector<Cause> causes = slot_causes(r);
  ASSERT_FALSE(causes.empty());
  EXPECT_TRUE(std::ranges::all_of(causes, [](Cause c) { return c == Cause::slot_too_narrow; }));
  EXPECT_EQ(text_of(Cause::slot_too_narrow), "full cut; the slot is too narrow for trochoids");
  EXPECT_GT(r.removed_mm3, 0);
}

}  // namespace
}  // namespace camber::copymill
