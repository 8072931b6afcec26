// Chips read in blocks against those read patch by patch, one stamp at a time.
#include "removal/engagement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "removal/field/upright/tile_arena.h"
#include "removal/simd/upright_block_kernels.h"

namespace camber::removal {

using namespace upright;

namespace {

machine::Tool tool_of(machine::ToolType type) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = 4;
  tool.corner_radius_mm = type == machine::ToolType::bull ? 1 : 0;
  tool.flutes = 3;
  tool.helix_rad = 0.5;
  tool.overhang_mm = 20;
  return tool;
}

/// Two wavy rows side by side, out and back: corners and thin chips as well.
std::vector<Stamp> wavy_rows() {
  std::vector<Stamp> out;
  for (int row = 0; row < 2; ++row)
    for (int i = 0; i <= 60; ++i) {
      const double x = -1 + 0.15 * (row % 2 ? 60 - i : i);
      Stamp s;
      s.pose.tip_mm = {x, 0.4 * row + 0.2 * std::sin(x), -1.0 + 0.3 * std::sin(0.9 * x)};
      s.first = out.empty();
      s.feed_per_tooth_mm = out.empty() ? Vec3(0.15, 0, 0) : Vec3(s.pose.tip_mm - out.back().pose.tip_mm);
      out.push_back(s);
    }
  return out;
}

Stock box() {
  const Vec3 lo(0, -4, -3), hi(7, 4, 0);
  return {[=](const Vec3& p) { return box_distance_mm(p, lo, hi); }, lo, hi, 0.1, 5};
}

void expect_the_chips_of_stamps_one_by_one(machine::ToolType type) {
  EnvelopeGrid envelope = make_envelope(tool_of(type), 2.0, 0.1, kPi / 90);
  make_patches(envelope, 0.24);
  const std::vector<Stamp> stamps = wavy_rows();
  const Stock blank = box();
  Stock one_by_one = box(), in_batches = box();
  // Cutters that are deflected by nothing take the other way through the code.
  const DeflectionTable none(stamps.size(), envelope.steps_per_pitch, {0.0, 2.0});
  DeflectedEngager slow(one_by_one, blank, envelope, stamps, 0);
  slow.start(0, stamps.size(), none);
  std::vector<std::vector<ChipSample>> expected(stamps.size());
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    for (const DeflectedChipSample& c : slow.read(k)) {
      if (!(c.chip.thickness_mm > 0)) continue;
      // Undeflected, the smaller of the depth and what the motion allows counts; deflected, the depth well beyond that.
      const float cap_mm = c.depth_mm <= c.cap_mm ? c.cap_mm / kBeyondCap : c.cap_mm;
      expected[k].push_back(c.chip);
      expected[k].back().thickness_mm = std::min(c.chip.thickness_mm, cap_mm);
    }
    slow.cut(k);
  }
  RigidEngager fast(in_batches, blank, envelope, stamps, 0);
  std::vector<std::vector<ChipSample>> found(stamps.size());
  fast.engage(0, stamps.size(), [&](std::size_t k, std::span<const ChipBlock> chips) {
    found[k] = chips_of(fast.blocks(), chips);
    EXPECT_NEAR(chip_volume_mm3(envelope, fast.blocks(), chips), chip_volume_mm3(envelope, found[k]), 1e-9);
  });
  double volume = 0, expected_volume = 0, difference = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    std::map<std::uint32_t, float> there;
    for (const ChipSample& c : expected[k]) there[c.point] = c.thickness_mm;
    for (const ChipSample& c : found[k]) {
      const auto other = there.find(c.point);
      difference += std::abs(c.thickness_mm - (other == there.end() ? 0.0f : other->second));
      ++count;
    }
    volume += chip_volume_mm3(envelope, found[k]);
    expected_volume += chip_volume_mm3(envelope, expected[k]);
  }
  ASSERT_GT(count, 10000u);
  EXPECT_NEAR(volume / expected_volume, 1, 1e-3);
  EXPECT_LT(difference / static_cast<double>(count), 2e-4);  // of chips of 0.05 to 0.15 mm
  EXPECT_NEAR(fast.commit() / slow.commit(), 1, 1e-5);
  for (int x = -3; x < 75; x += 2)
    for (int y = -42; y < 42; y += 3)
      for (int z = -20; z < 3; ++z)
        ASSERT_NEAR(one_by_one.voxel({x, y, z}), in_batches.voxel({x, y, z}), 2e-6) << x << ' ' << y << ' ' << z;
}

}  // namespace

TEST(RigidEngager, ABallsChipsAreThoseOfStampsOneByOne) {
  expect_the_chips_of_stamps_one_by_one(machine::ToolType::ball);
}

TEST(RigidEngager, ABullNosesChipsAreThoseOfStampsOneByOne) {
  expect_the_chips_of_stamps_one_by_one(machine::ToolType::bull);
}

TEST(RigidEngager, TilesThatStayFromStretchToStretchHoldWhatTheStockWould) {
  EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::bull), 2.0, 0.1, kPi / 90);
  const std::vector<Stamp> stamps = wavy_rows();
  const Stock blank = box();
  Stock kept = box(), stored = box();
  RigidEngager once(kept, blank, envelope, stamps, 0), each_time(stored, blank, envelope, stamps, 0);
  std::vector<double> of_once(stamps.size()), of_each(stamps.size());
  const auto volumes = [&](std::vector<double>& out, const RigidEngager& engager) {
    return [&](std::size_t k, std::span<const ChipBlock> chips) {
      out[k] = chip_volume_mm3(envelope, engager.blocks(), chips);
    };
  };
  double taken = 0;
  constexpr std::size_t kStretch = 17;
  for (std::size_t from = 0; from < stamps.size(); from += kStretch) {
    const std::size_t count = std::min(kStretch, stamps.size() - from);
    once.engage(from, count, [&, sink = volumes(of_once, once)](std::size_t k, auto chips) { sink(from + k, chips); });
    each_time.engage(from, count,
                     [&, sink = volumes(of_each, each_time)](std::size_t k, auto chips) { sink(from + k, chips); });
    taken += each_time.commit();
  }
  ASSERT_GT(taken, 5);
  EXPECT_NEAR(once.commit(), taken, 1e-9 * taken);
  for (std::size_t k = 0; k < stamps.size(); ++k) EXPECT_NEAR(of_once[k], of_each[k], 1e-5) << k;
  for (int x = -3; x < 75; ++x)
    for (int y = -42; y < 42; ++y)
      for (int z = -32; z < 3; ++z)
        ASSERT_NEAR(kept.voxel({x, y, z}), stored.voxel({x, y, z}), 1e-6) << x << ' ' << y << ' ' << z;
}

/// Stamps 0.05 mm apart along a slot, with a rib of 0.3 mm beyond the end of the material.
TEST(RigidEngager, StampsThatAreLeftOutLieOnTheLineAndChangeNothingOfTheStock) {
  EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::ball), 2.0, 0.1, kPi / 90);
  const auto slot_and_rib = [] {
    return Stock(
        [](const Vec3& p) {
          return std::min(box_distance_mm(p, {0, -4, -3}, {7, 4, 0}), box_distance_mm(p, {11, -4, -3}, {11.3, 4, 0}));
        },
        {0, -4, -3}, {11.3, 4, 0}, 0.1, 5);
  };
  std::vector<Stamp> stamps(300);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    stamps[k].pose.tip_mm = {-2.5 + 0.05 * static_cast<double>(k), 0, -1};
    stamps[k].first = k == 0;
    stamps[k].feed_per_tooth_mm = {0.05, 0, 0};
  }
  const Stock blank = slot_and_rib();
  Stock all_read = slot_and_rib(), some_read = slot_and_rib();
  RigidEngager all(all_read, blank, envelope, stamps, 0), some(some_read, blank, envelope, stamps, 0);
  std::vector<double> wanted(stamps.size()), volume(stamps.size(), -1);
  all.engage(0, stamps.size(), [&](std::size_t k, std::span<const ChipBlock> chips) {
    wanted[k] = chip_volume_mm3(envelope, all.blocks(), chips);
  });
  std::vector<int> read(stamps.size(), 0), between(stamps.size(), 0);
  const auto line = [&](std::size_t a, std::size_t k, std::size_t b) {
    return volume[a] + (volume[b] - volume[a]) * static_cast<double>(k - a) / static_cast<double>(b - a);
  };
  some.engage(
      0, stamps.size(),
      {.read =
           [&](std::size_t k, std::span<const ChipBlock> chips) {
             ++read[k];
             volume[k] = chip_volume_mm3(envelope, some.blocks(), chips);
           },
       .must_read = [](std::size_t k) { return k == 100; },
       .on_line =
           [&](std::size_t a, std::size_t k, std::size_t b) {
             return volume[a] > 0 && volume[b] > 0 && std::abs(volume[k] - line(a, k, b)) < 0.02 * volume[k];
           },
       .between = [&](std::size_t a, std::size_t k, std::size_t b) { ++between[k], volume[k] = line(a, k, b); }});
  EXPECT_EQ(all.commit(), some.commit());
  EXPECT_EQ(read[100], 1);
  double sum = 0, sum_wanted = 0, largest = 0;
  std::size_t left_out = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    ASSERT_EQ(read[k] + between[k], 1) << k;
    left_out += static_cast<std::size_t>(between[k]);
    sum += volume[k], sum_wanted += wanted[k], largest = std::max(largest, wanted[k]);
  }
  constexpr double kOfLargest = 0.06;  // what the glance lets pass
  for (std::size_t k = 0; k < stamps.size(); ++k) EXPECT_NEAR(volume[k], wanted[k], kOfLargest * largest) << k;
  EXPECT_NEAR(sum, sum_wanted, 0.003 * sum_wanted);
  EXPECT_GT(left_out, stamps.size() / 4);
  for (int x = 0; x < 113; ++x)
    for (int y = -25; y < 25; ++y)
      for (int z = -15; z < 1; ++z)
        ASSERT_EQ(all_read.voxel({x, y, z}), some_read.voxel({x, y, z})) << x << ' ' << y << ' ' << z;
}

TEST(RigidEngager, StampsAwayFromTheStockTakeNothing) {
  EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::ball), 2.0, 0.1, kPi / 90);
  make_patches(envelope, 0.24);
  std::vector<Stamp> stamps = wavy_rows();
  for (Stamp& s : stamps) s.pose.tip_mm.y() += 40;
  const Stock blank = box();
  Stock stock = box();
  RigidEngager engager(stock, blank, envelope, stamps, 0);
  std::size_t chips_found = 0;
  engager.engage(0, stamps.size(), [&](std::size_t, std::span<const ChipBlock> chips) { chips_found += chips.size(); });
  EXPECT_EQ(chips_found, 0u);
  EXPECT_EQ(engager.commit(), 0);
}

TEST(TopMap, SquaresKnowTheHighestColumnAround) {
  // A tile of air above y = 5 voxels, and on one column of it a pillar; the tile beside it along y is not there.
  constexpr int kFloor = 6, kPillar = 11;
  constexpr double kVoxel_mm = 0.1, kBand_mm = 0.4;
  Tile tile;
  tile.stamp.fill(Stock::kUncut);
  for (int i = 0; i < Tile::kSide; ++i)
    for (int j = 0; j < Tile::kSide; ++j)
      for (int k = 0; k < Tile::kSide; ++k)
        tile.distance[static_cast<std::size_t>(Tile::offset(i, j, k))] =
            k < (i == 9 && j == 2 ? kPillar : kFloor) ? -0.1f : static_cast<float>(kBand_mm);
  SlotMap slots;
  slots.reset({3, 5, -2}, {3, 6, -1});
  const ColumnCover cover(tile, {3, 5, -1}, kVoxel_mm, kBand_mm, shape_of(tool_of(machine::ToolType::ball)),
                          [](std::int32_t, Vec3&, double&) { return false; });
  const auto cover_of = [&](std::size_t place) { return place == slots.place(3, 5, -1) ? &cover : nullptr; };
  TopMap map;
  constexpr int kSquares = 2 * TopMap::kOfTile;  // along y
  map.reset(slots);
  EXPECT_EQ(map.heights(), std::vector<std::int32_t>(TopMap::kOfTile * kSquares, 3 * Tile::kCore));
  for (const int reach : {0, 3, 8}) {
    map.read(slots, reach, cover_of);
    const int around = (reach + TopMap::kCell - 1) / TopMap::kCell;
    for (int i = 0; i < TopMap::kOfTile; ++i)
      for (int j = 0; j < kSquares; ++j) {
        const bool pillar = std::abs(i - 2) <= around && j <= around;
        const bool floor = j < TopMap::kOfTile + around;
        EXPECT_EQ(map.heights()[static_cast<std::size_t>(i * kSquares + j)],
                  floor ? Tile::kCore + (pillar ? kPillar : kFloor) : 0)
            << reach << ' ' << i << ' ' << j;
      }
  }
}

TEST(EnvelopeBlocks, HoldEveryPointOnce) {
  // 3 x 31 steps and an odd number of rings leave places over.
  const EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::bull), 1.5, 0.1, 2 * kPi / 93);
  const EnvelopeBlocks blocks(envelope, 0.1, 0.5);
  std::vector<int> seen(envelope.size());
  for (std::uint32_t b = 0; b < blocks.size(); ++b)
    for (int l = 0; l < EnvelopeBlocks::kLanes; ++l) {
      const std::uint32_t p = blocks.point(b, l);
      if (p == EnvelopeBlocks::kNoPoint) continue;
      ++seen[p];
      EXPECT_EQ(static_cast<int>(p) / envelope.steps, blocks.block(b).ring + l / EnvelopeBlocks::kSteps);
      EXPECT_EQ(static_cast<int>(p) % envelope.steps_per_pitch, blocks.block(b).step + l % EnvelopeBlocks::kSteps);
    }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size()));
  EXPECT_EQ(blocks.up_to(100), blocks.bounds().count);
}

TEST(BlockKernels, WideAndNarrowVectorsReadTheSame) {
  const EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::ball), 2.0, 0.1, kPi / 90);
  const EnvelopeBlocks blocks(envelope, 0.1, 0.5);
  const std::vector<Stamp> stamps = wavy_rows();
  const Stock stock = box();
  TileArena arena;
  arena.load(stock, &stock, envelope.shape, stamps, [](std::span<const std::size_t>) {});
  // Voxels as if stamps had cut them.
  std::mt19937 random(3);
  for (std::size_t t = 1; t < arena.size(); ++t)
    for (auto& id : arena[t].stamp) id = static_cast<std::int32_t>(random() % 8) - 2;
  const std::size_t room = blocks.size() + 8, k = 30;
  std::vector<std::int32_t> x(stamps.size()), y(stamps.size()), z(stamps.size());
  for (std::size_t s = 0; s < stamps.size(); ++s) {
    x[s] = static_cast<std::int32_t>(1e6 * stamps[s].pose.tip_mm.x());
    y[s] = static_cast<std::int32_t>(1e6 * stamps[s].pose.tip_mm.y());
    z[s] = static_cast<std::int32_t>(1e6 * stamps[s].pose.tip_mm.z());
  }
  struct Reading {
    std::vector<std::int32_t> found, lane, cell, hit;
    std::vector<std::uint32_t> block, deep;
    std::vector<float> thickness, cap, u, v, w, thin, under_blank;
    bool operator==(const Reading&) const = default;
  };
  const auto read = [&](const BlockKernels& kernels) {
    Reading r;
    r.found.resize(room), r.block.resize(room), r.deep.resize(room);
    for (auto* v : {&r.lane, &r.cell, &r.hit}) v->resize(8 * room);
    for (auto* v : {&r.thickness, &r.cap, &r.u, &r.v, &r.w, &r.thin}) v->resize(8 * room);
    const StampPlace place = arena.place_of(stamps[k], -0.01);
    const int found = kernels.find_blocks(blocks.bounds(), place, arena.view(), r.found.data());
    BlockHits hits{0, r.block.data(), r.deep.data(), r.thickness.data()};
    ShallowPoints shallow{0,           r.lane.data(), r.cell.data(), r.cap.data(), {r.u.data(), r.v.data(), r.w.data()},
                          r.hit.data()};
    kernels.read_blocks(blocks.points(), r.found.data(), found, place, arena.view(), 0.05f, hits, shallow);
    EXPECT_GT(hits.count, 30);
    EXPECT_GT(shallow.count, 30);
    shallow.count = shallow.count / 8 * 8;
    const FixedTips tips{x.data(), y.data(), z.data(), {x[k], y[k], z[k]}, 1e-6f, 0};
    kernels.thin_points(blocks.points(), shallow, arena.view(), tips, 0, 2, 0.05f, r.thin.data());
    // The stock as its own blank; tiles of the arena hold twice as many values as those of the blank.
    std::vector<std::int32_t> of_blank = r.cell;
    for (auto& cell : of_blank) cell -= cell / (2 * Tile::kVolume) * Tile::kVolume;
    r.under_blank = r.thin;
    kernels.thin_by_blank(blocks.points(), {shallow.count,
                                            arena.blanks(),
                                            r.lane.data(),
                                            of_blank.data(),
                                            {r.u.data(), r.v.data(), r.w.data()},
                                            0.1f,
                                            0.05f,
                                            r.under_blank.data()});
    EXPECT_NE(r.under_blank, r.thin);
    return r;
  };
  EXPECT_EQ(read(kBaseBlockKernels), read(block_kernels()));
}

}  // namespace camber::removal
