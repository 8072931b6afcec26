// Where lines are split, and the path that has only the splits' freedom.
#include "compensate/splits.h"

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

/// Two lines of 10 mm along X and, after a rapid, a third.
nc::Interpretation three_lines() {
  nc::Interpretation p;
  p.states.emplace_back();
  const auto add = [&](nc::MoveKind kind, double from, double to, double y) {
    nc::Move m;
    m.kind = kind;
    m.start_mm = {from, y, 0};
    m.end_mm = {to, y, 0};
    m.feed_mm_per_s = 10;
    m.block = static_cast<std::uint32_t>(p.moves.size());
    p.moves.push_back(m);
  };
  add(nc::MoveKind::linear, 0, 10, 0);
  add(nc::MoveKind::linear, 10, 20, 0);
  add(nc::MoveKind::rapid, 20, 0, 1);
  add(nc::MoveKind::linear, 0, 10, 1);
  return p;
}

struct Lines {
  nc::Interpretation program = three_lines();
  ShiftPath path{program, {true, true, false, true}, 1.0};

  std::size_t at(std::uint32_t move, double fraction) const {
    const auto place = path.find(move, fraction);
    return place.lower + (place.upper_fraction > 0.5 ? 1 : 0);
  }
};

TEST(Splits, AreTheEndsOfMovesUntilTheShiftStrays) {
  Lines lines;
  Splits splits(lines.path);
  EXPECT_EQ(std::count(splits.kept().begin(), splits.kept().end(), true), 5) << "two chains: three ends and two";
  for (auto& p : lines.path.points()) p.shift_mm.z() = 0.001 * p.place_mm.x();
  EXPECT_EQ(splits.add_strays(lines.path, 0.0005), 0u) << "a shift that grows evenly";
  const std::size_t bump = lines.at(1, 0.4);
  lines.path.points()[bump].shift_mm.z() += 0.003;
  EXPECT_EQ(splits.add_strays(lines.path, 0.005), 0u) << "not worth it";
  EXPECT_GT(splits.add_strays(lines.path, 0.0005), 0u);
  EXPECT_TRUE(splits.kept()[bump]);
}

TEST(Splits, StayWhenTheShiftThatAskedForThemIsGone) {
  Lines lines;
  Splits splits(lines.path);
  lines.path.points()[lines.at(0, 0.5)].shift_mm.z() = 0.01;
  splits.add_strays(lines.path, 0.0005);
  const auto kept = splits.kept();
  for (auto& p : lines.path.points()) p.shift_mm = Vec3::Zero();
  EXPECT_EQ(splits.add_strays(lines.path, 0.0005), 0u);
  EXPECT_EQ(splits.kept(), kept);
  lines.path.points()[lines.at(0, 1)].shift_mm.z() = 0.001;  // or nothing is moved and nothing written
  const auto edits = lines.path.edits(splits.kept(), 0.0005);
  ASSERT_FALSE(edits.empty());
  EXPECT_EQ(edits[0].via.size(), 3u) << "the place and its neighbours, where the bump began and ended";
}

TEST(ThinPath, MovesAndBackKeepsWhatTheSplitsCanShow) {
  Lines lines;
  Splits splits(lines.path);
  lines.path.points()[lines.at(0, 0.3)].shift_mm.z() = 0.01;
  splits.add_strays(lines.path, 0.0005);
  ThinPath thin(lines.path, splits.kept());
  const std::size_t kept = static_cast<std::size_t>(std::count(splits.kept().begin(), splits.kept().end(), true));
  ASSERT_EQ(thin.path().points().size(), kept);
  ASSERT_EQ(thin.path().chains().size(), 2u);

  const auto shift = [](const Vec3& p) { return Vec3(0, 0.002 * p.y(), 0.001 * p.x()); };
  for (auto& p : lines.path.points()) p.shift_mm = shift(p.place_mm);
  thin.take_shifts(lines.path);
  ShiftPath back(lines.program, {true, true, false, true}, 1.0);
  thin.give_shifts(back);
  for (std::size_t i = 0; i < back.points().size(); ++i)
    EXPECT_TRUE(back.points()[i].shift_mm.isApprox(lines.path.points()[i].shift_mm, 1e-12)) << i;

  // A place means the same on both paths.
  for (const std::uint32_t move : {0u, 1u, 3u})
    for (double u = 0; u <= 1; u += 0.07) {
      const Observation o{.place = lines.path.find(move, u)};
      const Observation t = thin.places_of(std::vector{o})[0];
      EXPECT_NEAR((thin.path().shift_at(t.place) - lines.path.shift_at(o.place)).norm(), 0, 1e-12) << move << " " << u;
      EXPECT_LT(t.place.lower + 1, thin.path().points().size());
    }
}

TEST(ThinPath, TakesTheGreatestStiffnessBetweenItsPoints) {
  Lines lines;
  ThinPath thin(lines.path, Splits(lines.path).kept());
  std::vector<double> stiffness(lines.path.points().size(), 1.0);
  stiffness[lines.at(1, 0.5)] = 7;
  EXPECT_EQ(thin.greatest_of(stiffness), (std::vector<double>{1, 7, 1, 1, 1}));
}

}  // namespace
}  // namespace camber::compensate
