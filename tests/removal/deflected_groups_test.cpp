// Stamps of a deflected cutter that are carved or glanced at together, against the same ones by one.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "removal/engagement.h"

namespace camber::removal {
namespace {

constexpr int kStampsOfARow = 80;

machine::Tool tool_of(machine::ToolType type) {
  machine::Tool tool;
  tool.type = type;
  tool.diameter_mm = 4;
  tool.corner_radius_mm = type == machine::ToolType::bull ? 1 : 0;
  tool.flutes = 2;
  tool.helix_rad = 0.5;
  tool.overhang_mm = 20;
  return tool;
}

/// Rows beside each other, there and back, up and down.
std::vector<Stamp> rows() {
  std::vector<Stamp> out;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < kStampsOfARow; ++i) {
      const double x = -1 + 0.12 * (row % 2 ? kStampsOfARow - 1 - i : i);
      Stamp s;
      s.pose.tip_mm = {x, 0.5 * row + 0.2 * std::sin(x), -1.0 + 0.2 * std::sin(0.9 * x)};
      s.first = i == 0;
      s.feed_per_tooth_mm = s.first ? Vec3(row % 2 ? -0.12 : 0.12, 0, 0) : Vec3(s.pose.tip_mm - out.back().pose.tip_mm);
      out.push_back(s);
    }
  return out;
}

/// Deflections of up to 30 um that change from stamp to stamp and from step to step.
DeflectionTable deflections_of(const std::vector<Stamp>& stamps, const EnvelopeGrid& envelope) {
  DeflectionTable out(stamps.size(), envelope.steps_per_pitch, {0.0, 2.0}, true);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const std::span<float> row(out.row(static_cast<std::ptrdiff_t>(k)), out.row_size());
    for (int m = 0; m < out.steps; ++m) {
      const double phase = 2 * kPi * m / out.steps, slowly = 0.05 * static_cast<double>(k);
      const auto step = static_cast<std::size_t>(m), steps = static_cast<std::size_t>(out.steps);
      for (std::size_t node = 0; node < 2; ++node) {
        const double at_node = node == 0 ? 0.03 : 0.025;
        row[2 * (node * steps + step)] = static_cast<float>(at_node * std::sin(phase + slowly));
        row[2 * (node * steps + step) + 1] = static_cast<float>(at_node * std::cos(phase) * std::cos(slowly));
      }
      AxialRow(row.subspan(out.lateral_size())).set(step, 0.004 * std::sin(phase));
    }
  }
  return out;
}

/// Every point leans the same way, farther than the tool moves from stamp to stamp.
const Vec3 kLean_mm(-0.15, 0.05, 0);

DeflectionTable leaning(const std::vector<Stamp>& stamps, const EnvelopeGrid& envelope) {
  DeflectionTable out(stamps.size(), envelope.steps_per_pitch, {0.0, 2.0}, false);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const std::span<float> row(out.row(static_cast<std::ptrdiff_t>(k)), out.row_size());
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<float>(kLean_mm[static_cast<int>(i % 2)]);
  }
  return out;
}

Stock box() {
  const Vec3 lo(0, -4, -3), hi(8, 4, 0);
  return {[=](const Vec3& p) { return box_distance_mm(p, lo, hi); }, lo, hi, 0.1, 5};
}

/// A flat cutter that is displaced along its axis, by another amount at each step and each stamp, and leans: the floor
/// lies where the edges of the stamp passed that moved down most there.
void expect_floor_below_leaning_edges(const Vec3& lean_mm) {
  constexpr double kRounding_um = 0.1;
  EnvelopeGrid envelope = make_envelope(tool_of(machine::ToolType::flat), 2.0, 0.1, kPi / 90);
  make_patches(envelope, 0.24);
  std::vector<Stamp> stamps;
  for (int i = 0; i < kStampsOfARow; ++i) {
    Stamp s;
    s.pose.tip_mm = {-1 + 0.12 * i, 0.03, -1.013};
    s.first = i == 0;
    s.feed_per_tooth_mm = {0.12, 0, 0};
    stamps.push_back(s);
  }
  DeflectionTable table(stamps.size(), envelope.steps_per_pitch, {0.0, 2.0}, true);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const std::span<float> row(table.row(static_cast<std::ptrdiff_t>(k)), table.row_size());
    for (std::size_t i = 0; i < table.lateral_size(); ++i)
      row[i] = static_cast<float>(lean_mm[static_cast<int>(i % 2)]);
    for (int m = 0; m < table.steps; ++m)
      AxialRow(row.subspan(table.lateral_size()))
          .set(static_cast<std::size_t>(m),
               0.004 * std::sin(2 * kPi * m / table.steps + 0.4 * static_cast<double>(k)) - 0.001);
  }
  Stock stock = box(), blank = box();
  DeflectedEngager engager(stock, blank, envelope, stamps, 0);
  engager.start(0, stamps.size(), table);
  for (std::size_t k = 0; k < stamps.size(); k += 8) engager.cut(k, 8);
  engager.commit();
  int seen = 0;
  double deepest_um = 0;
  for (int x = 25; x < 50; ++x)
    for (int y = -10; y <= 10; ++y) {
      const double at_x = 0.1 * x, at_y = 0.1 * y;
      double floor_mm = 0;
      for (std::size_t k = 0; k < stamps.size(); ++k) {
        const Vec3& tip = stamps[k].pose.tip_mm;
        const double dx = at_x - tip.x() - lean_mm.x(), dy = at_y - tip.y() - lean_mm.y(), rho = std::hypot(dx, dy);
        if (rho > 1.4 || rho < 1e-6) continue;  // nearer to the wall it is the wall that a voxel tells of
        const double step = table.step_at(std::atan2(dy, dx), 0, envelope.lag_per_mm, envelope.flutes);
        floor_mm = std::min(floor_mm, tip.z() + table.at(table.row(static_cast<std::ptrdiff_t>(k)), 0, step).z());
      }
      int z = 0;
      while (z > -20 && stock.voxel({x, y, z - 1}) > 0) --z;
      const double left_mm = 0.1 * z - static_cast<double>(stock.voxel({x, y, z}));
      // Stamps near whose wall the place lies may have gone deeper.
      EXPECT_LT(1000 * (left_mm - floor_mm), kRounding_um) << x << ' ' << y;
      EXPECT_GT(1000 * (left_mm + 1.013), -5.1) << x << ' ' << y;
      deepest_um = std::max(deepest_um, -1000 * (left_mm + 1.013));
      ++seen;
    }
  EXPECT_EQ(seen, 25 * 21);
  EXPECT_GT(deepest_um, 4.4);
}

TEST(FlatBottoms, AreAsDeepAsTheEdgesThatMoveDownMost) { expect_floor_below_leaning_edges(Vec3::Zero()); }

/// Near the axis the edge that passes a place is that of another direction.
TEST(FlatBottoms, AreAsDeepWhereTheToolLeans) { expect_floor_below_leaning_edges({0.2, 0.1, 0}); }

class DeflectedGroups : public ::testing::TestWithParam<machine::ToolType> {
 protected:
  DeflectedGroups()
      : envelope_(make_envelope(tool_of(GetParam()), 2.0, 0.1, kPi / 90)), stamps_(rows()), blank_(box()) {
    make_patches(envelope_, 0.24);
    deflections_ = deflections_of(stamps_, envelope_);
  }

  EnvelopeGrid envelope_;
  std::vector<Stamp> stamps_;
  Stock blank_;
  DeflectionTable deflections_;
};

TEST_P(DeflectedGroups, LeaveTheStockOfStampsOneByOne) {
  Stock by_one = box(), by_eight = box();
  DeflectedEngager one(by_one, blank_, envelope_, stamps_, 0), eight(by_eight, blank_, envelope_, stamps_, 0);
  one.start(0, stamps_.size(), deflections_);
  eight.start(0, stamps_.size(), deflections_);
  for (std::size_t k = 0; k < stamps_.size(); ++k) one.cut(k);
  constexpr std::size_t kTogether = 8;
  static_assert(kStampsOfARow % kTogether == 0);
  for (std::size_t k = 0; k < stamps_.size(); k += kTogether) eight.cut(k, kTogether);
  const double volume_mm3 = one.commit();
  EXPECT_GT(volume_mm3, 10);
  EXPECT_NEAR(eight.commit() / volume_mm3, 1, 1e-6);
  double worst = 0;
  std::size_t changed = 0;
  for (int x = -3; x < 84; ++x)
    for (int y = -42; y < 42; ++y)
      for (int z = -20; z < 3; ++z) {
        const auto a = static_cast<double>(by_one.voxel({x, y, z})), b = static_cast<double>(by_eight.voxel({x, y, z}));
        // Farther from the surface than a voxel, a field only tells on which side it is.
        if (std::min(std::abs(a), std::abs(b)) < 0.1) worst = std::max(worst, std::abs(a - b));
        EXPECT_GT(a * b, -1e-6);
        changed += a != static_cast<double>(blank_.voxel({x, y, z}));
      }
  EXPECT_GT(changed, 10000u);
  EXPECT_LT(worst, 1e-3) << "voxels of 0.1 mm: the deflected surface is found to 0.05 um";
}

TEST_P(DeflectedGroups, AGlanceAheadSeesWhatAGlanceAtItsTimeSees) {
  constexpr std::size_t kTogether = 8;
  Stock stock = box();
  DeflectedEngager engager(stock, blank_, envelope_, stamps_, 0);
  engager.start(0, stamps_.size(), deflections_);
  double seen = 0, apart2 = 0, seen2 = 0;
  for (std::size_t k = 0; k < stamps_.size(); k += kTogether) {
    const auto span = engager.glance(k, kTogether);
    const std::vector<double> ahead(span.begin(), span.end());
    for (std::size_t i = 0; i < kTogether; ++i) {
      const double at_its_time = engager.glance(k + i, 1).front();
      // A glance of read chips is the glance.
      EXPECT_NEAR(engager.glance_of(engager.read(k + i)), at_its_time, 1e-6 + 1e-6 * at_its_time);
      if (i == 0) {
        EXPECT_EQ(ahead[i], at_its_time);
      }
      if (k % kStampsOfARow != 0) {
        seen += at_its_time;
        apart2 += (ahead[i] - at_its_time) * (ahead[i] - at_its_time), seen2 += at_its_time * at_its_time;
      }
      engager.cut(k + i);
    }
  }
  EXPECT_GT(seen, 1);
  // 6 % more or less than foreseen is read (ReadingPace): what a glance ahead errs by may cost a reading.
  EXPECT_LT(std::sqrt(apart2 / seen2), 0.1);
}

TEST_P(DeflectedGroups, ThatLeanCutAsACutterThatStandsThere) {
  Stock by_leaning = box(), by_standing = box();
  std::vector<Stamp> moved = stamps_;
  for (Stamp& s : moved) s.pose.tip_mm += kLean_mm;
  const DeflectionTable lean = leaning(stamps_, envelope_);
  DeflectedEngager engager(by_leaning, blank_, envelope_, stamps_, 0);
  engager.start(0, stamps_.size(), lean);
  double ahead = 0, at_its_time = 0;
  constexpr std::size_t kTogether = 8;
  for (std::size_t k = 0; k < stamps_.size(); k += kTogether) {
    for (const double glance : engager.glance(k, kTogether)) ahead += glance;
    for (std::size_t i = 0; i < kTogether; ++i) {
      at_its_time += engager.glance(k + i, 1).front();
      engager.cut(k + i);
    }
  }
  EXPECT_NEAR(ahead / at_its_time, 1, 0.03) << "of chips that are less than half as thick as it leans";
  const double volume_mm3 = sweep(by_standing, envelope_.shape, moved, {});
  EXPECT_NEAR(engager.commit() / volume_mm3, 1, 1e-5);
  double worst = 0;
  for (int x = -3; x < 84; ++x)
    for (int y = -42; y < 42; ++y)
      for (int z = -20; z < 3; ++z) {
        const auto a = static_cast<double>(by_leaning.voxel({x, y, z})),
                   b = static_cast<double>(by_standing.voxel({x, y, z}));
        if (std::min(std::abs(a), std::abs(b)) < 0.1) worst = std::max(worst, std::abs(a - b));
      }
  EXPECT_LT(worst, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Cutters, DeflectedGroups,
                         ::testing::Values(machine::ToolType::ball, machine::ToolType::flat, machine::ToolType::bull),
                         [](const auto& info) {
                           return info.param == machine::ToolType::ball   ? "Ball"
                                  : info.param == machine::ToolType::flat ? "Flat"
                                                                          : "Bull";
                         });

}  // namespace
}  // namespace camber::removal
