// Cut stock against closed forms, 1 %, at feeds of a hundredth of the radius: engagement angles, mean forces at any
// immersion, area and cusps of ball passes, the deflection as an edge passes a wall.
#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "removal/engagement.h"
#include "removal/form_error.h"
#include "simulate/cut.h"
#include "tests/support/accuracy_figure.h"
#include "tests/support/cutting.h"
#include "tests/support/engage_all.h"

namespace camber::simulate {
namespace {

using tests::expect_figure;
using tests::LargestFigure;

using testing::add_row;
using testing::engage_all;
using testing::make_box;
using testing::make_tool;

constexpr machine::Material kSteel{2000, 700, 300, 15, 12, 5};
constexpr double kRadius = 5, kFeed = 0.05, kOnePercent = 0.01;

/// Thickness at phi from the feed: from our circle to that of the tooth before, along our radius. Exact.
double circular_chip_mm(double phi) {
  const double s = kFeed * std::sin(phi);
  return kRadius + kFeed * std::cos(phi) - std::sqrt(kRadius * kRadius - s * s);
}

struct Shoulder {
  double radial_mm = 2;
  bool up = true;
  /// Counter-clockwise from the feed: where a chip can be, from the work's side to a chip of nothing.
  double from() const { return up ? side() : -kPi / 2 - fade(); }
  double to() const { return up ? kPi / 2 + fade() : -side(); }

 private:
  double side() const {
    return radial_mm >= 2 * kRadius ? -kPi / 2 - fade() : std::asin(std::max(-1.0, 1 - radial_mm / kRadius));
  }
  static double fade() { return std::asin(kFeed / (2 * kRadius)); }
};

/// Force on the tool of an edge of unit length at phi; at the work's side the chip ends in the blank's face.
Vec3 edge_N(const Shoulder& shoulder, double phi) {
  const double s = std::sin(phi), c = std::cos(phi);
  const double inside = (shoulder.up ? s : -s) * kRadius - (kRadius - shoulder.radial_mm);
  const double face = shoulder.radial_mm < 2 * kRadius ? inside / std::max(1e-9, shoulder.up ? s : -s) : 1.0;
  const double h = std::abs(s) > 1e-3 && face > 0 ? std::min(face, circular_chip_mm(phi)) : circular_chip_mm(phi);
  const double ft = kSteel.ktc_MPa * h + kSteel.kte_N_per_mm, fr = kSteel.krc_MPa * h + kSteel.kre_N_per_mm;
  return {-ft * s - fr * c, ft * c - fr * s, -(kSteel.kac_MPa * h + kSteel.kae_N_per_mm)};
}

/// A row along +X through a block on its left (up milling) or right, 3 mm high, the cut `depth` deep.
struct Cut {
  std::vector<removal::Stamp> stamps;
  removal::Stock stock;
};
Cut row(const Shoulder& s, double depth) {
  const double inner = s.up ? kRadius - s.radial_mm : s.radial_mm - kRadius;
  const bool slot = s.radial_mm >= 2 * kRadius;
  const Vec3 lo(0, s.up && !slot ? inner : -kRadius - 1, -depth);
  const Vec3 hi(11.5, s.up || slot ? kRadius + 1 : inner, 0);
  Cut cut{{}, make_box(lo, hi, 0.1)};
  add_row(cut.stamps, {-kRadius - 0.2, 0.003, -depth - 0.5}, {6, 0.003, -depth - 0.5}, kFeed);
  return cut;
}

TEST(ClosedForms, EngagementAnglesOfShouldersAndSlots) {
  LargestFigure angles("engagement angle", kOnePercent);
  const auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 2, 0);
  for (const bool up : {true, false})
    for (const double radial : {0.5, 2.0, 5.0, 8.0, 10.0}) {
      const Shoulder s{radial, up};
      Cut cut = row(s, 1);
      const removal::Stock blank(cut.stock);
      removal::EnvelopeGrid envelope = removal::make_envelope(tool, 1.5, 0.2, rad_from_deg(0.2));
      removal::make_patches(envelope, 0.24);
      const auto engagement = engage_all(cut.stock, blank, envelope, cut.stamps);
      // A ring in the middle of the depth.
      std::size_t ring = 0;
      while (envelope.rings[ring].profile.height_mm < 1) ++ring;
      int points = 0;
      for (const auto& chip : engagement.of(cut.stamps.size() - 20))
        if (chip.point / static_cast<std::uint32_t>(envelope.steps) == ring) ++points;
      const double angle = points * 2 * kPi / envelope.steps;
      // The path runs 0.003 mm aside of the middle, towards +Y.
      const double aside = (up ? 0.003 : -0.003) / (kRadius * std::max(0.1, std::cos(s.up ? s.from() : s.to())));
      const double expected =
          radial < 2 * kRadius ? s.to() - s.from() - aside : kPi + 2 * std::asin(kFeed / 2 / kRadius);
      angles.expect(angle, expected, fmt::format("{} {}", radial, up ? "up" : "down"));
    }
}

TEST(ClosedForms, MeanForcesAtAnyImmersionWhateverTheHelix) {
  LargestFigure forces("mean force", kOnePercent);
  constexpr double kDepth = 2;
  constexpr int kNodes = 20000;
  for (const bool up : {true, false})
    for (const double radial : {0.5, 2.0, 6.0, 10.0}) {
      const Shoulder s{radial, up};
      Vec3 closed = Vec3::Zero();
      for (int i = 0; i < kNodes; ++i)
        closed += edge_N(s, s.from() + (i + 0.5) * (s.to() - s.from()) / kNodes) * (s.to() - s.from()) / kNodes;
      closed *= 3 * kDepth / (2 * kPi);
      for (const double helix : {0.0, 40.0}) {
        Cut cut = row(s, kDepth);
        for (auto& stamp : cut.stamps) stamp.pose.tip_mm.y() = 0;
        CutOptions options;
        options.coupling = machine::Coupling::rigid;
        options.envelope_step_mm = 0.05;
        options.rotation_step_rad = rad_from_deg(0.5);
        const auto result = simulate::cut(cut.stock, make_tool(machine::ToolType::flat, 2 * kRadius, 3, helix), kSteel,
                                          cut.stamps, {}, 0, options);
        Vec3 mean = Vec3::Zero();
        constexpr std::size_t kOver = 20;
        for (std::size_t k = cut.stamps.size() - kOver; k < cut.stamps.size(); ++k)
          mean += result.loads[k].force_mean_N / kOver;
        forces.expect_vector(mean, closed, fmt::format("{} {} helix {}", radial, up ? "up" : "down", helix));
      }
    }
}

/// Slots in a layer on a floor that an earlier pass has made: the force grows with the layer, not with whole rings.
TEST(ClosedForms, MeanForcesInALayerOfAnyThickness) {
  LargestFigure forces("mean force", kOnePercent);
  constexpr int kNodes = 20000;
  const Shoulder slot{2 * kRadius, true};
  Vec3 closed = Vec3::Zero();
  for (int i = 0; i < kNodes; ++i)
    closed +=
        edge_N(slot, slot.from() + (i + 0.5) * (slot.to() - slot.from()) / kNodes) * (slot.to() - slot.from()) / kNodes;
  closed *= 3 / (2 * kPi);
  auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, 3, 30);
  tool.overhang_mm = 5;  // hardly bends
  for (const auto coupling : {machine::Coupling::rigid, machine::Coupling::static_})
    for (const double layer : {0.1, 0.13, 0.17, 0.22}) {
      auto stock = make_box({-0.5, -kRadius - 1, -2}, {8, kRadius + 1, 0}, 0.1);
      std::vector<removal::Stamp> stamps;
      add_row(stamps, {-2, 0, -1.013}, {6, 0, -1.013}, 0.5);
      CutOptions options;
      options.coupling = coupling;
      options.envelope_step_mm = 0.06;
      simulate::cut(stock, tool, kSteel, stamps, {}, 0, options);
      stock.clear_stamps();
      stamps.clear();
      add_row(stamps, {-2, 0, -1.013 - layer}, {-0.5, 0, -1.013 - layer}, kFeed);
      const auto result = simulate::cut(stock, tool, kSteel, stamps, {}, 0, options);
      Vec3 mean = Vec3::Zero();
      constexpr std::size_t kOver = 6;
      for (std::size_t k = stamps.size() - kOver; k < stamps.size(); ++k) mean += result.loads[k].force_mean_N / kOver;
      forces.expect_vector(mean, Vec3(layer * closed), fmt::format("{} mm", layer));
    }
}

TEST(ClosedForms, BallPassTakesItsAreaAndLeavesItsCusps) {
  // Rows p apart on a level plane, d below the blank: p d in the steady state; cusps of R - sqrt(R^2 - p^2 / 4).
  constexpr double kRow = 1, kDepth = 0.3, kBall = 3, kStep = 0.03;
  const auto tool = make_tool(machine::ToolType::ball, 2 * kBall, 2, 30);
  removal::Stock stock = make_box({0, -1, -1.5}, {6, 8, 0}, 0.1);
  removal::Stock target(stock);
  std::vector<removal::Stamp> stamps;
  for (int r = -1; r <= 6; ++r) add_row(stamps, {-2, r * kRow, -kDepth}, {8, r * kRow, -kDepth}, kStep);
  sweep(target, tool, stamps, 0, 0);
  removal::CutterPlaces places;
  places.add(0, removal::shape_of(tool), stamps);
  removal::SurfaceMap map(target, places, stock);
  CutOptions options;
  options.coupling = machine::Coupling::rigid;
  options.envelope_step_mm = 0.03;
  const auto result = cut(stock, tool, kSteel, stamps, {}, 0, options);
  double chips = 0, count = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (stamps[k].pose.tip_mm.y() == 5 * kRow && stamps[k].pose.tip_mm.x() > 2 && stamps[k].pose.tip_mm.x() < 4) {
      chips += result.loads[k].chip_mm3;
      ++count;
    }
  // Between cusps the row before has taken more: the area is that between two circles' paths, p apart, under the blank.
  double area = 0;
  constexpr int kSlices = 200000;
  for (int i = 0; i < kSlices; ++i) {
    const double y = -3 + 6 * (i + 0.5) / kSlices;
    const auto floor = [&](double from_row) {
      const double d = y - from_row;
      return std::abs(d) < kBall ? kBall - kDepth - std::sqrt(kBall * kBall - d * d) : 0.0;
    };
    double before = 0;
    for (int r = 1; r <= 5; ++r) before = std::min(before, floor(-r * kRow));
    area += std::max(0.0, before - floor(0)) * 6 / kSlices;
  }
  EXPECT_NEAR(area, kRow * kDepth, 0.05 * area);  // less the cusps' own
  expect_figure("area of the chips", chips / count / kStep, area, kOnePercent);

  double lowest = 1, highest = -1;
  for (const auto& p : map.take())
    if (p.place_mm.x() > 1 && p.place_mm.x() < 5 && p.place_mm.y() > 2 && p.place_mm.y() < 4) {
      lowest = std::min(lowest, p.place_mm.z());
      highest = std::max(highest, p.place_mm.z());
    }
  const double cusp = kBall - std::sqrt(kBall * kBall - kRow * kRow / 4);
  expect_figure("height of the cusps", highest - lowest, cusp, kOnePercent);
}

TEST(ClosedForms, DeflectionAsAnEdgePassesTheWall) {
  LargestFigure deflections("deflection", kOnePercent);
  // A stiff bar on a spring: at the instant at which the edge at height z stands at the wall, every edge element of all
  // teeth stands at the wall's angle plus its lag; delta = F / k.
  constexpr double kDepth = 5, kRoot = 8000;
  constexpr int kFlutes = 4;
  for (const double helix : {0.0, 35.0})
    for (const bool up : {true, false}) {
      const Shoulder s{helix == 0 ? 7.0 : 2.0, up};  // straight flutes: another tooth must be in the cut
      auto tool = make_tool(machine::ToolType::flat, 2 * kRadius, kFlutes, helix);
      tool.youngs_modulus_MPa = 1e15;
      tool.root_stiffness_N_per_mm = kRoot;
      Cut cut = row(s, kDepth);
      for (auto& stamp : cut.stamps) stamp.pose.tip_mm.y() = 0;
      const double lag = std::tan(rad_from_deg(helix)) / kRadius, wall = up ? kPi / 2 : -kPi / 2;
      const auto closed = [&](double z, double past) {
        constexpr int kSlices = 5000;
        Vec3 force = Vec3::Zero();
        for (int tooth = 0; tooth < kFlutes; ++tooth)
          for (int i = 0; i < kSlices; ++i) {
            const double height = 0.5 + (i + 0.5) * kDepth / kSlices;  // the tip runs 0.5 mm below the block
            const double phi = std::remainder(wall + past + (height - z) * lag + 2 * kPi * tooth / kFlutes, 2 * kPi);
            if (phi > s.from() && phi < s.to()) force += edge_N(s, phi) * kDepth / kSlices;
          }
        return Vec2(force.head<2>() / kRoot);
      };
      // Straight edges meet the wall all at once, just where their own chip ends: there, a little past it.
      const double past = helix > 0 ? 0 : (up ? 1 : -1) * rad_from_deg(3);
      const std::vector<double> heights{1.0, 2.0, 3.0, 4.0, 5.0};
      std::vector<Contact> contacts(cut.stamps.size());
      const auto stamp_of = [&](std::size_t i) { return cut.stamps.size() - 3 - i; };
      for (std::size_t i = 0; i < heights.size(); ++i) contacts[stamp_of(i)] = {heights[i], wall + past};
      CutOptions options;
      options.coupling = machine::Coupling::rigid;
      options.envelope_step_mm = 0.05;
      options.rotation_step_rad = rad_from_deg(0.25);
      const auto result = simulate::cut(cut.stock, tool, kSteel, cut.stamps, contacts, 0, options);
      double largest = 0;
      for (const double z : heights) largest = std::max(largest, closed(z, past).norm());
      ASSERT_GT(largest, 0.001);
      for (std::size_t i = 0; i < heights.size(); ++i) {
        const Vec2 got = result.loads[stamp_of(i)].contact_deflection_mm.head<2>(), want = closed(heights[i], past);
        deflections.expect_vector(got, want, fmt::format("helix {} {} at {} mm", helix, up ? "up" : "down", heights[i]),
                                  largest);
      }
    }
}

}  // namespace
}  // namespace camber::simulate
