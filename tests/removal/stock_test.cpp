#include "removal/stock.h"

#include <algorithm>
#include <cmath>
#include <csignal>

#include <sys/resource.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "base/diagnostics.h"
#include "removal/engagement.h"
#include "removal/form_error.h"
#include "tests/support/cutting.h"
#include "tests/support/engage_all.h"
#include "tests/support/temp_folder.h"

namespace camber::removal {
namespace {

using testing::add_row;
using testing::AllChips;
using testing::engage_all;
using testing::make_box;
using testing::make_tool;

EnvelopeGrid ball_envelope() { return make_envelope(make_tool(machine::ToolType::ball, 6, 2, 30), 3, 0.1, kPi / 90); }

double carve_row(Stock& stock, const EnvelopeGrid& envelope, const std::vector<Stamp>& stamps) {
  return sweep(stock, envelope.shape, stamps, {});
}

TEST(Stock, KnowsTheVolumeAndDistanceOfABox) {
  const Stock stock = make_box({0, 0, 0}, {8, 6, 4}, 0.1);
  EXPECT_NEAR(stock.volume_mm3(), 192, 192 * 0.001);
  EXPECT_NEAR(stock.distance_mm({4, 3, 3.83}), -0.17, 1e-5);
  EXPECT_NEAR(stock.distance_mm({4, 3, 4.21}), 0.21, 1e-5);
  EXPECT_NEAR(stock.distance_mm({4, 3, 2}), -stock.band_mm(), 1e-6) << "deep inside the value is cut off at the band";
}

TEST(Stock, ZeroLevelAfterABallIsTheBall) {
  Stock stock = make_box({-6, -6, -4}, {6, 6, 0}, 0.1);
  const EnvelopeGrid envelope = ball_envelope();
  std::vector<Stamp> one(1);
  one[0].pose.tip_mm = {0.03, -0.02, -2};
  carve_row(stock, envelope, one);
  // Measured: 0.07 um rms and 0.35 um worst for R5 at 0.1 mm; R3 curves more.
  constexpr double kWorst_mm = 0.001;
  for (double a = 0; a < 6.28; a += 0.1)
    for (double k = 0.05; k < 1.1; k += 0.1) {
      const Vec3 n(std::sin(k) * std::cos(a), std::sin(k) * std::sin(a), -std::cos(k));
      EXPECT_NEAR(stock.distance_mm(one[0].pose.tip_mm + Vec3(0, 0, 3) + 3 * n), 0, kWorst_mm);
    }
}

TEST(Stock, LosesTheVolumeOfAGroove) {
  Stock stock = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  const double before = stock.volume_mm3();
  const EnvelopeGrid envelope = ball_envelope();
  std::vector<Stamp> stamps;
  add_row(stamps, {-4, 0, -1}, {14, 0, -1}, 0.02);
  const double removed = carve_row(stock, envelope, stamps);
  // Circular segment of depth 1 of R3, all along.
  const double half = std::acos(2.0 / 3.0), area = 9 * half - 2 * std::sqrt(5.0);
  EXPECT_NEAR(removed, 10 * area, 10 * area * 0.003);
  EXPECT_NEAR(before - stock.volume_mm3(), removed, 1e-6 * before);
}

TEST(RigidEngager, GivesTheSameBytesOnOneAndTwoThreads) {
  const auto run = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Stock stock = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
    const Stock blank(stock);
    EnvelopeGrid envelope = ball_envelope();
    make_patches(envelope, 0.24);
    std::vector<Stamp> stamps;
    add_row(stamps, {-4, 0, -1}, {14, 0, -1}, 0.15);
    add_row(stamps, {14, 0.4, -1}, {-4, 0.4, -1}, 0.15);
    AllChips e = engage_all(stock, blank, envelope, stamps);
    return std::pair(std::move(e), std::move(stock));
  };
  const auto [e1, stock1] = run(1);
  const auto [e2, stock2] = run(2);
  EXPECT_EQ(e1.removed_mm3, e2.removed_mm3);
  ASSERT_EQ(e1.chips.size(), e2.chips.size());
  for (std::size_t i = 0; i < e1.chips.size(); ++i) {
    ASSERT_EQ(e1.chips[i].point, e2.chips[i].point);
    ASSERT_EQ(e1.chips[i].thickness_mm, e2.chips[i].thickness_mm);
  }
  for (int x = -10; x < 110; x += 3)
    for (int y = -55; y < 55; y += 2)
      for (int z = -30; z < 5; ++z) ASSERT_EQ(stock1.voxel({x, y, z}), stock2.voxel({x, y, z}));
}

TEST(RigidEngager, ChipVolumeIsTheVolumeThatTheStockLoses) {
  Stock stock = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  const Stock blank(stock);
  EnvelopeGrid envelope = ball_envelope();
  make_patches(envelope, 0.24);
  std::vector<Stamp> stamps;
  for (int row = 0; row < 3; ++row) add_row(stamps, {14, 0.5 * row, -1}, {-4, 0.5 * row, -1}, 0.15);
  const AllChips e = engage_all(stock, blank, envelope, stamps);
  double chips = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) chips += chip_volume_mm3(envelope, e.of(k));
  EXPECT_NEAR(chips / e.removed_mm3, 1.0, 0.01);
}

TEST(Surface, ReportsMaterialLeftAsPositive) {
  Stock target = make_box({0, -5, -3}, {10, 5, 0}, 0.1), machined(target);
  const EnvelopeGrid envelope = ball_envelope();
  std::vector<Stamp> deep, shallow;
  add_row(deep, {-4, 0, -1}, {14, 0, -1}, 0.05);
  add_row(shallow, {-4, 0, -0.98}, {14, 0, -0.98}, 0.05);
  carve_row(target, envelope, deep);
  carve_row(machined, envelope, shallow);
  const auto points = compare_surfaces(machined, target);
  ASSERT_GT(points.size(), 1000u);
  for (const auto& p : points) EXPECT_NEAR(p.error_mm, 0.02 * p.normal.z(), 0.0005) << p.place_mm.transpose();
}

TEST(Surface, PointsStandForTheWholeArea) {
  Stock target = make_box({-6, -6, -4}, {6, 6, 0}, 0.1);
  const EnvelopeGrid envelope = ball_envelope();
  std::vector<Stamp> one(1);
  one[0].pose.tip_mm = {0.03, -0.02, -2};
  carve_row(target, envelope, one);
  double area = 0;
  for (const auto& p : compare_surfaces(target, target))
    if (p.place_mm.z() < -0.45) area += p.area_mm2;
  // A spherical cap of height 1.55 of R3, cut off between two layers of voxels.
  EXPECT_NEAR(area, 2 * kPi * 3 * 1.55, 0.002 * 2 * kPi * 3 * 1.55);
}

TEST(Surface, PointsLieOnTheDeepestCutterAlsoOfStampsThatNoVoxelNames) {
  // Three stamps a voxel at most places: the voxels name every third.
  Stock target = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  std::vector<Stamp> stamps;
  add_row(stamps, {-4, 0.03, -1}, {14, 0.03, -1}, 0.035);
  carve_row(target, ball_envelope(), stamps);
  const CutterShape ball = shape_of(make_tool(machine::ToolType::ball, 6, 2, 30));
  CutterPlaces places;
  places.add(0, ball, stamps);
  std::size_t count = 0;
  for (const auto& part : surface_points(target, places))
    for (const auto& p : part) {
      double deepest = 1;
      for (const Stamp& s : stamps) deepest = std::min(deepest, ball.distance_mm(p.place_mm - s.pose.tip_mm));
      EXPECT_NEAR(deepest, 0, 1e-5) << p.place_mm.transpose();
      ++count;
    }
  EXPECT_GT(count, 1000u);
}

TEST(Surface, PointsCoverAnInclinedSurfaceOnceAtEveryPhaseOfTheGrid) {
  // Rows of a ball close enough for a plane at 45 degrees, which the grid meets every sqrt(2)/2 of a diagonal.
  Stock target = make_box({0, 0, -1}, {8, 8, 9}, 0.1);
  std::vector<Stamp> stamps;
  for (int r = -20; r < 140; ++r) {
    const Vec3 tip(-4, 0.05 * r - 3 * std::sqrt(0.5), 0.05 * r + 3 * std::sqrt(0.5) - 3 + 0.037);
    add_row(stamps, tip, tip + Vec3(16, 0, 0), 0.1);
  }
  carve_row(target, ball_envelope(), stamps);
  CutterPlaces places;
  places.add(0, shape_of(make_tool(machine::ToolType::ball, 6, 2, 30)), stamps);
  constexpr int kPhases = 8;
  std::array<double, kPhases> area{};
  double all = 0;
  const double period = 0.1 * std::sqrt(2.0), from = 15 * period, to = 55 * period;
  for (const auto& part : surface_points(target, places))
    for (const auto& p : part) {
      const double s = (p.place_mm.y() + p.place_mm.z()) / std::sqrt(2.0);
      if (p.place_mm.x() < 2 || p.place_mm.x() > 6 || s < from || s > to) continue;
      const double phase = s / period - std::floor(s / period);
      area[static_cast<std::size_t>(phase * kPhases)] += p.area_mm2;
      all += p.area_mm2;
    }
  EXPECT_NEAR(all, 4 * (to - from), 0.03 * 4 * (to - from));
  for (const double a : area) EXPECT_NEAR(a / all, 1.0 / kPhases, 0.15 / kPhases) << "400 points";
}

TEST(ErrorFigures, AreWeightedByArea) {
  const ErrorFigures f = error_figures({1, -3, 2}, {1, 1, 2});
  EXPECT_DOUBLE_EQ(f.mean, 0.5);
  EXPECT_DOUBLE_EQ(f.rms, std::sqrt((1 + 9 + 8) / 4.0));
  EXPECT_DOUBLE_EQ(f.p95, 3);
  EXPECT_DOUBLE_EQ(f.min, -3);
}

TEST(ErrorFigures, AnAreaHasTheValueThatASortedListHasThere) {
  std::vector<ValueOfArea> points;
  for (int i = 0; i < 500; ++i) points.push_back({static_cast<double>((i * 37) % 101), 0.01 * (1 + i % 7)});
  std::vector<ValueOfArea> sorted = points;
  std::ranges::stable_sort(sorted, {}, &ValueOfArea::value);
  double whole = 0;
  for (const ValueOfArea& p : points) whole += p.area_mm2;
  for (const double fraction : {0.0, 0.003, 0.31, 0.5, 0.95, 0.999, 1.0}) {
    double below = 0;
    std::size_t k = 0;
    while (k + 1 < sorted.size() && below + sorted[k].area_mm2 < fraction * whole * (1 - 1e-11))
      below += sorted[k++].area_mm2;
    EXPECT_EQ(value_at_area(points, fraction * whole), sorted[k].value) << fraction;
  }
  EXPECT_EQ(value_at_area(points, 2 * whole), 100);
  EXPECT_EQ(value_at_area({}, 1), 0);
  const std::vector<ValueOfArea> thirds{{3, 0.1}, {1, 0.1}, {2, 0.1}};
  EXPECT_EQ(value_at_area(thirds, 0.1 + 0.1), 2) << "0.1 of 0.30000000000000004 and 0.2 of it";
}

TEST(ErrorSpread, GivesPercentilesAndAHistogramByArea) {
  std::vector<double> error, area;
  for (int i = 0; i < 1000; ++i) {
    error.push_back(-5 + 0.02 * ((i * 37) % 1000));  // -5 ... 14.98, in no order
    area.push_back(0.5);
  }
  const ErrorSpread s = error_spread(error, area);
  EXPECT_NEAR(s.percentile[0], -4.82, 1e-9);  // the tenth of a thousand
  EXPECT_NEAR(s.percentile[4], 4.98, 1e-9);
  EXPECT_NEAR(s.percentile[8], 14.78, 1e-9);
  EXPECT_DOUBLE_EQ(s.bin_width, 1);
  EXPECT_DOUBLE_EQ(s.bin_from, -5);
  ASSERT_EQ(s.bin_area_mm2.size(), 20u);
  for (const double bin : s.bin_area_mm2) EXPECT_NEAR(bin, 25, 0.6) << "one value may round over an edge";
  EXPECT_TRUE(error_spread({}, {}).bin_area_mm2.empty());
}

/// Two stocks made from one blank: shared layers in one case, copies in the other.
struct Family {
  Stock blank, first, second;
};
Family family(bool shared) {
  Stock blank = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  if (shared) blank.share();
  std::vector<Stamp> allowance, row, other;
  add_row(allowance, {-4, 0, -1}, {14, 0, -1}, 0.15);
  add_row(row, {-4, 0.5, -1.4}, {14, 0.5, -1.4}, 0.15);
  add_row(other, {5, -9, -2}, {5, 9, -2}, 0.15);
  carve_row(blank, ball_envelope(), allowance);
  blank.clear_stamps();
  if (shared) blank.share();
  Stock first(blank), second(blank);
  carve_row(first, ball_envelope(), row);
  carve_row(second, ball_envelope(), other);
  return {std::move(blank), std::move(first), std::move(second)};
}

void expect_same(const Stock& a, const Stock& b, const tests::TempFolder& folder) {
  EXPECT_EQ(a.surface_tiles(), b.surface_tiles());
  EXPECT_EQ(a.volume_mm3(), b.volume_mm3());
  constexpr int kSide = 48;
  std::vector<float> distance_a(kSide * kSide * kSide), distance_b(distance_a);
  std::vector<std::int32_t> stamp_a(distance_a.size()), stamp_b(distance_a.size());
  for (const Index3& first : {Index3{-9, -60, -40}, {31, -20, -39}, {70, 10, -41}}) {
    a.read(first, kSide, distance_a.data(), stamp_a.data());
    b.read(first, kSide, distance_b.data(), stamp_b.data());
    EXPECT_EQ(distance_a, distance_b);
    EXPECT_EQ(stamp_a, stamp_b);
  }
  for (int tile = -3; tile < 7; ++tile) {
    EXPECT_EQ(a.is_air({tile, 0, -1}), b.is_air({tile, 0, -1}));
    EXPECT_EQ(a.is_solid({tile, 1, -2}), b.is_solid({tile, 1, -2}));
    EXPECT_EQ(a.distance_mm({1.6 * tile, 0.31, -1.2}), b.distance_mm({1.6 * tile, 0.31, -1.2}));
  }
  a.save(folder / "a.vdb");
  b.save(folder / "b.vdb");
  EXPECT_EQ(tests::file_text(folder / "a.vdb"), tests::file_text(folder / "b.vdb"));
}

TEST(Stock, CopiesOfASharedOneAreCutAsOthersAre) {
  const tests::TempFolder folder;
  Family shared = family(true);
  const Family copied = family(false);
  expect_same(shared.blank, copied.blank, folder);
  expect_same(shared.first, copied.first, folder);
  expect_same(shared.second, copied.second, folder);
  // The layers are taken over where nobody else has them, and copied where the blank still does.
  shared.second.unshare();
  expect_same(shared.second, copied.second, folder);
  expect_same(shared.first, copied.first, folder);
  shared.second.clear();
  shared.blank.clear();
  EXPECT_TRUE(shared.blank.is_air({0, 0, -1}));
  expect_same(shared.first, copied.first, folder);
  shared.first.unshare();
  expect_same(shared.first, copied.first, folder);
}

TEST(Stock, ACopyOfASharedOneHasOnlyWhatItChanges) {
  Stock blank = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  const std::size_t whole = blank.memory_bytes();
  blank.share();
  const Stock copy(blank);
  EXPECT_LT(copy.memory_bytes(), whole + whole / 100);
}

TEST(Stock, FlatFacesOfASharedOneAreKeptOnce) {
  const tests::TempFolder folder;
  const Stock plain = make_box({0.03, -20, -10}, {40, 20.1, 0.07}, 0.1);
  Stock shared(plain);
  shared.share();
  // What is left are the tree's inner nodes, of 128 voxels side.
  EXPECT_LT(shared.memory_bytes(), plain.memory_bytes() / 4);
  expect_same(shared, plain, folder);
  Stock cut_shared(shared), cut_plain(plain);
  std::vector<Stamp> row;
  add_row(row, {-4, 3, -1.4}, {44, 3, -1.4}, 0.15);
  EXPECT_EQ(carve_row(cut_shared, ball_envelope(), row), carve_row(cut_plain, ball_envelope(), row));
  expect_same(cut_shared, cut_plain, folder);
  cut_shared.unshare();
  expect_same(cut_shared, cut_plain, folder);
  expect_same(shared, plain, folder);
}

TEST(Stock, LayersOfASharedOneBecomeOneLayer) {
  const tests::TempFolder folder;
  const Family copied = family(false);
  Family shared = family(true);
  const std::size_t before = shared.first.memory_bytes();
  shared.first.share_as_one();  // the others keep theirs
  expect_same(shared.first, copied.first, folder);
  expect_same(shared.second, copied.second, folder);
  shared.second.clear();
  shared.blank.clear();
  Stock cut(shared.first), cut_copied(copied.first);
  std::vector<Stamp> row;
  add_row(row, {-4, 2, -1.4}, {14, 2, -1.4}, 0.15);
  EXPECT_EQ(carve_row(cut, ball_envelope(), row), carve_row(cut_copied, ball_envelope(), row));
  expect_same(cut, cut_copied, folder);
  EXPECT_LT(shared.first.memory_bytes(), before) << "what is hidden is gone";
}

TEST(Stock, ACopyWithinABoxIsCutThereAsTheWholeIs) {
  const Family shared = family(true);
  const Vec3 lo(1, -3, -3), hi(8, 4, 1e9);
  std::vector<Stamp> row;
  add_row(row, {4.2, 0.5, -1.8}, {4.8, 0.5, -1.8}, 0.15);  // in the box with all of the cutter
  for (const Stock* cut : {&shared.first, &shared.second, &shared.blank}) {
    Stock whole(*cut), part = cut->copy_within(lo, hi);
    EXPECT_LE(part.memory_bytes(), whole.memory_bytes());
    for (const bool again : {false, true}) {
      for (const Index3& first : {Index3{20, -30, -31}, Index3{23, -14, -25}}) {
        constexpr int kSide = 33;
        std::vector<float> distance(kSide * kSide * kSide), expected(distance);
        std::vector<std::int32_t> stamp(distance.size()), expected_stamp(stamp);
        part.read(first, kSide, distance.data(), stamp.data());
        whole.read(first, kSide, expected.data(), expected_stamp.data());
        EXPECT_EQ(distance, expected);
        EXPECT_EQ(stamp, expected_stamp);
      }
      if (again) break;
      const double of_whole = carve_row(whole, ball_envelope(), row), of_part = carve_row(part, ball_envelope(), row);
      EXPECT_EQ(of_part, of_whole);
      EXPECT_GT(of_part, 0.1);
    }
  }
  // Elsewhere it has what was shared alone.
  const Stock part = shared.first.copy_within({8, -3, -3}, {9, 3, 1e9});
  EXPECT_LT(part.memory_bytes(), shared.first.memory_bytes());
  EXPECT_NE(shared.first.distance_mm({2, 0.5, -1.2}), shared.blank.distance_mm({2, 0.5, -1.2}));
  EXPECT_EQ(part.distance_mm({2, 0.5, -1.2}), shared.blank.distance_mm({2, 0.5, -1.2}));

  // A stock that shares nothing is copied whole; a box beside it holds nothing.
  const Family copied = family(false);
  EXPECT_EQ(copied.first.copy_within(lo, hi).volume_mm3(), copied.first.volume_mm3());
  EXPECT_EQ(shared.first.copy_within({50, 50, 0}, {60, 60, 1}).volume_mm3(), shared.blank.volume_mm3());
}

TEST(Stock, ComesBackFromItsFile) {
  const tests::TempFolder folder;
  Stock stock = make_box({0, -5, -3}, {10, 5, 0}, 0.1);
  std::vector<Stamp> stamps;
  add_row(stamps, {-4, 0, -1}, {14, 0, -1}, 0.15);
  carve_row(stock, ball_envelope(), stamps);
  stock.save(folder / "s.vdb");
  for (const double band : {3.0, 4.0, 6.0}) {
    const Stock back = Stock::load(folder / "s.vdb", 0.1, band);
    EXPECT_NEAR(back.volume_mm3(), stock.volume_mm3(), 1e-9);
    EXPECT_NEAR(back.band_mm(), 0.1 * band, 1e-6);
    EXPECT_NEAR((back.min_mm() - stock.min_mm()).norm(), 0, 0.4);
    EXPECT_NEAR((back.max_mm() - stock.max_mm()).norm(), 0, 0.4);
    for (int x = -5; x < 105; x += 3)
      for (int y = -55; y < 55; y += 2)
        for (int z = -33; z < 5; ++z) {
          const float was = stock.voxel({x, y, z}), is = back.voxel({x, y, z});
          ASSERT_TRUE(is == was || std::abs(was) >= 0.299f);
          ASSERT_EQ(is < 0, was < 0);
        }
  }
  try {
    Stock::load(folder / "s.vdb", 0.2, 4);
    FAIL() << "other voxels must be refused";
  } catch (const InputError& e) {
    EXPECT_EQ(to_string(e.diagnostics().front()),
              folder / "s.vdb" + std::string(": error: its voxels are 0.1 mm wide; 0.2 mm (voxel_mm of the job), from "
                                             "zero, were expected [vdb-voxel]"));
  }
}

TEST(Stock, IsNotSavedHalfWhenTheDiskIsFull) {
  const tests::TempFolder folder;
  const std::string path = folder.write("s.vdb", "OLD");
  const Stock stock = make_box({0, 0, 0}, {8, 6, 4}, 0.1);
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{20000, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  std::string said;
  try {
    stock.save(path);
  } catch (const InputError& e) {
    said = e.what();
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(said, path + ": error: could not be written to its end (is the disk full?) [file-unwritable]");
  EXPECT_EQ(tests::file_text(path), "OLD");
  EXPECT_FALSE(std::filesystem::exists(path + ".part"));
}

TEST(StockShape, LiesOnTheFacesOfABoxAndOnWhatWasCut) {
  Stock stock = make_box({-6, -6, -4}, {6, 6, 0}, 0.1);
  const EnvelopeGrid envelope = ball_envelope();
  std::vector<Stamp> row;
  add_row(row, {-8, 0, -1}, {8, 0, -1}, 0.1);
  carve_row(stock, envelope, row);
  constexpr std::size_t kMax = 3000;
  const StockShape shape = stock_shape(stock, kMax);
  EXPECT_LE(shape.crossings.size(), kMax);
  EXPECT_GT(shape.crossings.size(), kMax / 3) << "no coarser than asked";
  constexpr double kFace_mm = 0.001;
  int cut = 0, below = 0;
  for (const StockCrossing& c : shape.crossings) {
    const Vec3 p = c.place_mm;
    int on_lines = 0;
    for (int a = 0; a < 3; ++a)
      if (std::abs(p[a] / shape.cell_mm - std::round(p[a] / shape.cell_mm)) < 1e-6) ++on_lines;
    EXPECT_GE(on_lines, 2) << p.transpose();
    EXPECT_NEAR(stock.distance_mm(p), 0, 0.01) << p.transpose();
    EXPECT_GT(stock.distance_mm(p + 0.05 * c.outward), 0) << p.transpose();
    const bool in_groove = std::abs(p.y()) < 2.2 && p.z() > -1.1 && std::abs(p.x()) < 5.9;
    if (in_groove) {  // radius 3, its axis at z = 2
      EXPECT_NEAR(std::hypot(p.y(), p.z() - 2), 3, 0.02) << p.transpose();
      ++cut;
    } else if (p.z() < -3.9) {
      EXPECT_NEAR(p.z(), -4, kFace_mm);
      ++below;
    }
  }
  EXPECT_GT(cut, 100);
  EXPECT_GT(below, 100);
}

TEST(Stl, SaysHowManyEdgesAreOpen) {
  const tests::TempFolder folder;
  const std::string path = folder.write("open.stl",
                                        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                        "vertex 0 1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\n"
                                        "vertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n");
  try {
    const MeshDistance mesh(path, 0.1, 0.4);
    FAIL() << "an open mesh must be refused";
  } catch (const InputError& e) {
    EXPECT_EQ(to_string(e.diagnostics().front()),
              path +
                  ": error: the mesh is not closed: 4 of its edges have no second triangle, so it has no inside "
                  "[stl-open]");
  }
}

TEST(Stock, KnowsTheVolumeOfACylinder) {
  const Vec3 base(1, 2, -3);
  const Stock stock([&](const Vec3& p) { return cylinder_distance_mm(p, base, 5, 4); }, {-4, -3, -3}, {6, 7, 1}, 0.1,
                    4);
  EXPECT_NEAR(stock.volume_mm3() / (kPi * 25 * 4), 1, 0.002);
  EXPECT_NEAR(cylinder_distance_mm({9, 2, 2}, base, 5, 4), std::hypot(3, 1), 1e-12);
  EXPECT_NEAR(cylinder_distance_mm({1, 2, 0.5}, base, 5, 4), -0.5, 1e-12);
}

}  // namespace
}  // namespace camber::removal
