// Loads of a path that is made while it is cut, against the same path cut at once.
#include "simulate/load_probe.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "base/diagnostics.h"
#include "simulate/cut.h"
#include "tests/support/cutting.h"
#include "tests/support/temp_folder.h"

namespace camber::simulate {

using removal::Stamp;
using removal::Stock;
using removal::TipBox;

namespace {

using machine::ToolType;

machine::Material steel() { return {1800, 600, 300, 20, 25, 2}; }

machine::Tool tool_of(ToolType type) {
  machine::Tool tool = testing::make_tool(type, 6, 3, 30);
  tool.corner_radius_mm = type == ToolType::bull ? 1 : type == ToolType::ball ? 3 : 0;
  return tool;
}

constexpr double kVoxel = 0.15;
Stock block() { return testing::make_box({0, -8, -6}, {10, 3, 0}, kVoxel); }

/// Levels with rows to and fro, with steps in between that leave and enter the material, and a slope.
std::vector<Stamp> rows() {
  std::vector<Stamp> out;
  for (const double z : {-1.5, -3.0})
    for (int row = 0; row < 2; ++row) {
      const double y = -4 + 1.7 * row;
      const Vec3 a(-4, y, z), b(13, y, z - 0.6);
      testing::add_row(out, row % 2 ? b : a, row % 2 ? a : b, 0.17);
    }
  return out;
}

TipBox box_of(std::span<const Stamp> stamps) {
  TipBox box{stamps[0].pose.tip_mm, stamps[0].pose.tip_mm};
  for (const Stamp& s : stamps) {
    box.min_mm = box.min_mm.cwiseMin(s.pose.tip_mm);
    box.max_mm = box.max_mm.cwiseMax(s.pose.tip_mm);
  }
  return box;
}

std::vector<ProbedLoad> append_in_parts(LoadProbe& probe, std::span<const Stamp> stamps, std::size_t part) {
  std::vector<ProbedLoad> out;
  for (std::size_t from = 0; from < stamps.size(); from += part) {
    const auto loads = probe.append(stamps.subspan(from, std::min(part, stamps.size() - from)));
    out.insert(out.end(), loads.begin(), loads.end());
  }
  return out;
}

bool same_bytes(const Stock& a, const Stock& b) {
  const tests::TempFolder folder;
  a.save(folder / "a.vdb"), b.save(folder / "b.vdb");
  return tests::file_text(folder / "a.vdb") == tests::file_text(folder / "b.vdb");
}

/// Largest difference of voxels, mm. Cut in batches a voxel is set by another of two stamps that are as near.
double difference_mm(const Stock& a, const Stock& b) {
  const double voxel = a.voxel_mm();
  const Vec3 lo = (a.min_mm() / voxel).array().floor() - 6, hi = (a.max_mm() / voxel).array().ceil() + 6;
  float largest = 0;
  for (int i = static_cast<int>(lo.x()); i <= static_cast<int>(hi.x()); ++i)
    for (int j = static_cast<int>(lo.y()); j <= static_cast<int>(hi.y()); ++j)
      for (int k = static_cast<int>(lo.z()); k <= static_cast<int>(hi.z()); ++k)
        largest = std::max(largest, std::abs(a.voxel({i, j, k}) - b.voxel({i, j, k})));
  return static_cast<double>(largest);
}

StampLoad greatest(std::span<const StampLoad> loads) {
  StampLoad out;
  for (const StampLoad& load : loads) {
    out.lateral_max_N = std::max(out.lateral_max_N, load.lateral_max_N);
    out.torque_mean_Nmm = std::max(out.torque_mean_Nmm, load.torque_mean_Nmm);
    out.deflection_max_mm = std::max(out.deflection_max_mm, load.deflection_max_mm);
  }
  return out;
}

class LoadProbeOfTool : public ::testing::TestWithParam<ToolType> {};

}  // namespace

TEST_P(LoadProbeOfTool, LoadsAndStockAreThoseOfThePathCutAtOnce) {
  const machine::Tool tool = tool_of(GetParam());
  const std::vector<Stamp> stamps = rows();
  Stock at_once = block(), step_by_step = block();
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  options.longest_gap = 1;           // every passing is read ...
  options.rigid_stretch_stamps = 1;  // ... from what the ones before it left
  const CutResult expected = cut(at_once, tool, steel(), stamps, {}, 0, options);
  LoadProbe probe(step_by_step, tool, steel(), box_of(stamps), {});
  const std::vector<ProbedLoad> found = append_in_parts(probe, stamps, 7);
  const double removed = probe.flush();
  EXPECT_NEAR(removed, expected.stock_mm3, 1e-6 * removed);
  EXPECT_TRUE(same_bytes(at_once, step_by_step));
  ASSERT_EQ(found.size(), expected.loads.size());
  const StampLoad most = greatest(expected.loads);
  ASSERT_GT(most.lateral_max_N, 50);
  for (std::size_t k = 0; k < found.size(); ++k) {
    const StampLoad &is = found[k].felt, &was = expected.loads[k];
    ASSERT_NEAR(is.lateral_max_N, was.lateral_max_N, 5e-4 * most.lateral_max_N) << k;
    ASSERT_NEAR(is.torque_mean_Nmm, was.torque_mean_Nmm, 5e-5 * most.torque_mean_Nmm) << k;
    ASSERT_NEAR(is.deflection_max_mm, was.deflection_max_mm, 5e-4 * most.deflection_max_mm) << k;
    ASSERT_NEAR(is.chip_mm3, was.chip_mm3, 1e-6) << k;
    ASSERT_NEAR(is.chip_max_mm, was.chip_max_mm, 1e-6) << k;
  }
}

TEST_P(LoadProbeOfTool, TheStockAndTheMeanLoadAreThoseOfBatches) {
  const machine::Tool tool = tool_of(GetParam());
  const std::vector<Stamp> stamps = rows();
  Stock in_batches = block(), step_by_step = block();
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  const CutResult expected = cut(in_batches, tool, steel(), stamps, {}, 0, options);
  LoadProbe probe(step_by_step, tool, steel(), box_of(stamps), {});
  double is = 0, was = 0;
  for (const ProbedLoad& load : append_in_parts(probe, stamps, 100)) is += load.felt.torque_mean_Nmm;
  for (const StampLoad& load : expected.loads) was += load.torque_mean_Nmm;
  probe.flush();
  EXPECT_NEAR(is / was, 1, 1e-3);
  EXPECT_LT(difference_mm(in_batches, step_by_step), 2e-6);
}

TEST_P(LoadProbeOfTool, ResultsDoNotDependOnHowStampsAreDivided) {
  const machine::Tool tool = tool_of(GetParam());
  const std::vector<Stamp> stamps = rows();
  Stock one_by_one = block(), all = block();
  LoadProbe a(one_by_one, tool, steel(), box_of(stamps), {}), b(all, tool, steel(), box_of(stamps), {});
  std::vector<ProbedLoad> of_a;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    if (k % 5 == 0) a.look(stamps[std::min(k + 9, stamps.size() - 1)]);  // a look changes nothing
    if (k % 400 == 399) a.flush();
    of_a.push_back(a.append({&stamps[k], 1})[0]);
  }
  const std::vector<ProbedLoad> of_b = append_in_parts(b, stamps, stamps.size());
  a.flush(), b.flush();
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    ASSERT_EQ(of_a[k].felt.lateral_max_N, of_b[k].felt.lateral_max_N) << k;
    ASSERT_EQ(of_a[k].felt.force_mean_N, of_b[k].felt.force_mean_N) << k;
    ASSERT_EQ(of_a[k].felt.chip_mm3, of_b[k].felt.chip_mm3) << k;
  }
  EXPECT_TRUE(same_bytes(one_by_one, all));
}

TEST_P(LoadProbeOfTool, ResultsDoNotDependOnWhatWasReadBeforehand) {
  const machine::Tool tool = tool_of(GetParam());
  const std::vector<Stamp> stamps = rows();
  Stock when_met = block(), beforehand = block();
  LoadProbe a(when_met, tool, steel(), box_of(stamps), {}), b(beforehand, tool, steel(), box_of(stamps), {});
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    // Some tiles come with their edges, some are met with none or a few of them.
    const Vec3& ahead = stamps[std::min(k + 12, stamps.size() - 1)].pose.tip_mm;
    if (k % 3 != 0) b.approach(ahead, static_cast<int>(k % 3));
    if (k % 100 == 0) b.approach(ahead, removal::StepEngager::kAll);
    const ProbedLoad is = b.append({&stamps[k], 1})[0], was = a.append({&stamps[k], 1})[0];
    ASSERT_EQ(is.felt.lateral_max_N, was.felt.lateral_max_N) << k;
    ASSERT_EQ(is.felt.force_mean_N, was.felt.force_mean_N) << k;
    ASSERT_EQ(is.felt.chip_mm3, was.felt.chip_mm3) << k;
  }
  EXPECT_NEAR(a.flush(), b.flush(), 1e-6);
  EXPECT_TRUE(same_bytes(when_met, beforehand));
}

INSTANTIATE_TEST_SUITE_P(Tools, LoadProbeOfTool, ::testing::Values(ToolType::flat, ToolType::ball, ToolType::bull),
                         [](const auto& info) {
                           return info.param == ToolType::flat   ? "Flat"
                                  : info.param == ToolType::ball ? "Ball"
                                                                 : "Bull";
                         });

TEST(LoadProbe, ALookTellsWhatTheNextPassingIsExpectedToTell) {
  const machine::Tool tool = tool_of(ToolType::bull);
  const std::vector<Stamp> stamps = rows();
  Stock stock = block();
  LoadProbe probe(stock, tool, steel(), box_of(stamps), {});
  double ahead = 0, felt = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const StampLoad look = probe.look(stamps[k]);
    constexpr std::size_t kAhead = 6;
    if (k + kAhead < stamps.size() && k % 10 == 0) ahead += probe.look(stamps[k + kAhead]).torque_mean_Nmm;
    const ProbedLoad load = probe.append({&stamps[k], 1})[0];
    ASSERT_EQ(look.lateral_max_N, load.expected.lateral_max_N) << k;
    ASSERT_EQ(look.chip_mm3, load.expected.chip_mm3) << k;
    if (k >= kAhead && k % 10 == kAhead) felt += load.expected.torque_mean_Nmm;
  }
  // What lies six passings ahead is told within a few percent: the stamps between take nothing of it on straight rows.
  EXPECT_NEAR(ahead / felt, 1, 0.03);
}

TEST(LoadProbe, ALookAtTwoFeedsIsTwoLooks) {
  const machine::Tool tool = tool_of(ToolType::flat);
  std::vector<Stamp> stamps;
  testing::add_row(stamps, {-4, -3, -2}, {12, -3, -2}, 0.2);  // a slot
  Stock stock = block();
  LoadProbe probe(stock, tool, steel(), box_of(stamps), {}),
      quick(stock, tool, steel(), box_of(stamps), {.deflections = false});
  for (const Stamp& stamp : stamps) {
    const LoadProbe::Look both = probe.look_at_two_feeds(stamp);
    Stamp half = stamp;
    half.feed_per_tooth_mm *= 0.5;
    ASSERT_EQ(both.at_feed.lateral_max_N, probe.look(stamp).lateral_max_N);
    ASSERT_EQ(both.at_half.lateral_max_N, probe.look(half).lateral_max_N);
    ASSERT_EQ(both.at_feed.lateral_max_N, quick.look(stamp).lateral_max_N);
    const ProbedLoad load = probe.append({&stamp, 1})[0];
    quick.append({&stamp, 1});
    EXPECT_EQ(load.chips_at_mm, both.chips_at_mm);
    // The middle of half a circle, by thickness R sin(phi): pi / 4 of the radius ahead.
    const double x = stamp.pose.tip_mm.x();
    if (x > 4 && x < 6) {
      EXPECT_NEAR((load.chips_at_mm.head<2>() - Vec2(x + kPi / 4 * 3, -3)).norm(), 0, 0.2) << x;
    }
  }
}

TEST(LoadProbe, TilesThatWereGivenUpHoldWhatWasCut) {
  // Tiles are 1.6 mm wide: a long strip has many times as many as the cutter touches.
  const auto strip = [] { return testing::make_box({0, -2, -2}, {60, 2, 0}, 0.1); };
  const machine::Tool tool = testing::make_tool(ToolType::flat, 2, 2, 30);
  std::vector<Stamp> stamps;
  for (const double z : {-0.5, -1.0}) {
    testing::add_row(stamps, {-1, 0.2, z}, {61, 0.2, z}, 0.2);
    testing::add_row(stamps, {61, -0.6, z}, {-1, -0.6, z}, 0.2);
  }
  Stock at_once = strip(), step_by_step = strip();
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  const CutResult expected = cut(at_once, tool, steel(), stamps, {}, 0, options);
  LoadProbe probe(step_by_step, tool, steel(), box_of(stamps), {});
  double chips = 0;
  for (const ProbedLoad& load : append_in_parts(probe, stamps, 3)) chips += load.felt.chip_mm3;
  EXPECT_NEAR(chips, expected.chip_mm3, 2e-3 * chips);
  const Vec3 on_floor(30, 0.2, -1.05);
  const double pending = probe.distance_mm(on_floor);
  EXPECT_NEAR(pending, -0.05, 1e-5);
  probe.flush();
  EXPECT_LT(difference_mm(at_once, step_by_step), 2e-6);
  EXPECT_NEAR(step_by_step.distance_mm(on_floor), pending, 1e-6);
}

TEST(LoadProbe, APathTakenUpFromASavedStockHasTheSameLoads) {
  const machine::Tool tool = tool_of(ToolType::flat);
  const std::vector<Stamp> stamps = rows();
  const std::size_t half = stamps.size() * 3 / 5;  // in the middle of a row
  Stock whole = block(), begun = block();
  LoadProbe through(whole, tool, steel(), box_of(stamps), {}), first(begun, tool, steel(), box_of(stamps), {});
  append_in_parts(through, std::span(stamps).first(half), 50);
  append_in_parts(first, std::span(stamps).first(half), 50);
  first.flush();
  const tests::TempFolder folder;
  begun.save(folder / "stock.vdb");
  Stock again = Stock::load(folder / "stock.vdb", kVoxel, whole.band_mm() / kVoxel);
  LoadProbe second(again, tool, steel(), box_of(stamps), {});
  double most = 0, of_second = 0, of_through = 0;
  std::vector<double> difference;
  for (std::size_t k = half; k < stamps.size(); ++k) {
    const double is = second.append({&stamps[k], 1})[0].felt.lateral_max_N,
                 was = through.append({&stamps[k], 1})[0].felt.lateral_max_N;
    most = std::max(most, was);
    of_second += is, of_through += was;
    difference.push_back(std::abs(is - was));
  }
  // The stamps before count as blank, whose ridges the field rounds: a few percent of a passing near one
  // (docs/copy.md).
  EXPECT_NEAR(of_second / of_through, 1, 0.01);
  EXPECT_LT(*std::ranges::max_element(difference) / most, 0.06);
  through.flush(), second.flush();
  EXPECT_LT(difference_mm(whole, again), 2e-6);
}

namespace {

/// A slot through the block, with regions.
std::vector<ProbedLoad> slot_loads(const ForceRegions& regions) {
  Stock stock = block();
  std::vector<Stamp> stamps;
  testing::add_row(stamps, {-4, -3, -2}, {12, -3, -2}, 0.2);
  LoadProbe probe(stock, tool_of(ToolType::flat), steel(), box_of(stamps), {.regions = &regions});
  return append_in_parts(probe, stamps, stamps.size());
}

}  // namespace

TEST(LoadProbe, AHardPartIsFeltChipByChip) {
  const std::vector<ProbedLoad> soft = slot_loads({}),
                                hard = slot_loads(ForceRegions({{{-1, -20, -10}, {20, 20, 10}, 1.4}})),
                                half = slot_loads(ForceRegions({{{5, -20, -10}, {20, 20, 10}, 1.4}}));
  double before = 1;
  int rising = 0;
  for (std::size_t k = 0; k < soft.size(); ++k) {
    const double tip_x = -4 + 0.2 * static_cast<double>(k), is = soft[k].felt.torque_mean_Nmm;
    EXPECT_EQ(soft[k].felt.torque_mean_Nmm, soft[k].expected.torque_mean_Nmm);
    EXPECT_EQ(hard[k].expected.torque_mean_Nmm, is);
    EXPECT_NEAR(hard[k].felt.torque_mean_Nmm, 1.4 * is, 1e-9 * is);
    EXPECT_NEAR(hard[k].felt.lateral_max_N, 1.4 * soft[k].felt.lateral_max_N, 1e-9 * is);
    if (is == 0) continue;
    const double factor = half[k].felt.torque_mean_Nmm / is;
    // The front of the cutter, of radius 3, meets the part at 2 mm, and its whole front half is in it at 5 mm.
    if (tip_x < 1.9) {
      EXPECT_NEAR(factor, 1, 1e-9) << tip_x;
    } else if (tip_x > 5.2) {
      EXPECT_NEAR(factor, 1.4, 1e-9) << tip_x;
    } else if (tip_x > 2 && tip_x < 5) {
      EXPECT_GT(factor, before - 1e-3) << tip_x;
      before = factor, ++rising;
    }
  }
  EXPECT_GT(rising, 10);
}

TEST(ForceRegions, TheLaterOfOverlappingBoxesCounts) {
  const tests::TempFolder folder;
  const ForceRegions regions = read_force_regions(folder.write("regions.csv",
                                                               "x_min,y_min,z_min,x_max,y_max,z_max,factor\n"
                                                               "0,0,0,10,10,10,1.4\n\n"
                                                               " 5, 0,0,10,10,10, 0.8\r\n"));
  EXPECT_EQ(regions.factor_at({1, 1, 1}), 1.4);
  EXPECT_EQ(regions.factor_at({7, 1, 1}), 0.8);
  EXPECT_EQ(regions.factor_at({7, 1, 11}), 1);
  EXPECT_TRUE(regions.meet({-5, 2, 2}, {0, 3, 3}));
  EXPECT_FALSE(regions.meet({-5, 2, 2}, {-1, 3, 3}));
}

TEST(ForceRegions, MistakesAreToldWithTheirPlace) {
  const tests::TempFolder folder;
  const auto message = [&](std::string_view text) {
    const std::string path = folder.write("r.csv", text);
    try {
      read_force_regions(path);
    } catch (const InputError& e) {
      return tests::replaced(e.what(), path, "r.csv");
    }
    return std::string("no error");
  };
  const std::string header = "x_min,y_min,z_min,x_max,y_max,z_max,factor\n";
  EXPECT_EQ(message("x,y\n1,2\n"),
            "r.csv:1:1: error: the header x_min,y_min,z_min,x_max,y_max,z_max,factor was expected [regions-column]\n"
            "    x,y\n    ^");
  EXPECT_EQ(message(header), "r.csv: error: has no row below its header; a box was expected [regions-empty]");
  EXPECT_EQ(message(header + "0,0,0,1,1,1\n"),
            "r.csv:2:1: error: the row has 6 columns; 7 were expected [regions-column]\n    0,0,0,1,1,1\n    ^");
  EXPECT_EQ(message(header + "0,0,0,1,one,1,1.4\n"),
            "r.csv:2:9: error: y_max is \"one\"; a number was expected [regions-number]\n"
            "    0,0,0,1,one,1,1.4\n            ^");
  EXPECT_EQ(message(header + "0,0,0,1,0,1,14\n"),
            "r.csv:2:9: error: y_min is 0, y_max is 0; the second must be greater [regions-box]\n"
            "    0,0,0,1,0,1,14\n            ^\n"
            "r.csv:2:13: error: factor is 14; 0.1 to 10 was expected [regions-factor]\n"
            "    0,0,0,1,0,1,14\n                ^");
}

}  // namespace camber::simulate
