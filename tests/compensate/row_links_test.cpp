// Rows that lie beside each other: who is linked to whom, and that noise from row to row makes no facets.
#include "compensate/row_links.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "compensate/fit_shift.h"
#include "compensate/path_quality.h"

namespace camber::compensate {
namespace {

constexpr double kStep_mm = 0.3;
constexpr int kRows = 12;
constexpr double kLength_mm = 10;

/// Rows along X, 0.3 mm apart, with rapids between them; to and fro where asked.
nc::Interpretation rows_program(bool to_and_fro) {
  nc::Interpretation p;
  p.states.emplace_back();
  Vec3 at(0, 0, 5);
  const auto add = [&](nc::MoveKind kind, const Vec3& to) {
    nc::Move m;
    m.kind = kind;
    m.start_mm = at;
    m.end_mm = to;
    m.feed_mm_per_s = 10;
    m.block = static_cast<std::uint32_t>(p.moves.size());
    p.moves.push_back(m);
    at = to;
  };
  for (int row = 0; row < kRows; ++row) {
    const bool back = to_and_fro && row % 2 == 1;
    add(nc::MoveKind::rapid, {back ? kLength_mm : 0, row * kStep_mm, 0});
    add(nc::MoveKind::linear, {back ? 0 : kLength_mm, row * kStep_mm, 0});
  }
  return p;
}

ShiftPath path_of(const nc::Interpretation& p) {
  std::vector<bool> selected;
  for (const auto& m : p.moves) selected.push_back(m.kind == nc::MoveKind::linear);
  return {p, selected, 0.4};
}

/// Surface above every row whose error changes slowly over the part, and by up to `noise_mm` from row to row.
std::vector<Observation> observe(const nc::Interpretation& p, const ShiftPath& path, double noise_mm) {
  std::mt19937 random(5);
  std::vector<Observation> out;
  for (std::uint32_t m = 0; m < p.moves.size(); ++m) {
    if (!path.contains(m)) continue;
    const double of_row = noise_mm * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1);
    for (double u = 0.01; u < 1; u += 0.02) {
      const Vec3 at = nc::point_at(p, p.moves[m], u);
      const double error = 0.02 + 0.003 * std::sin(at.x() / 3) + 0.002 * at.y() + of_row;
      out.push_back({path.find(m, u), Vec3::UnitZ(), error, kStep_mm * 0.02 * kLength_mm});
    }
  }
  return out;
}

TEST(RowLinks, JoinEachPointToTheRowsBesideIt) {
  const auto program = rows_program(false);
  const ShiftPath path = path_of(program);
  const auto links = row_links(path, 1.0);
  // A row of 10 mm has 26 points, the first of which is where the rapid ends and stays.
  EXPECT_EQ(links.size(), static_cast<std::size_t>((kRows - 1) * 25));
  for (const RowLink& l : links) {
    EXPECT_NEAR(l.distance_mm, kStep_mm, 1e-9);
    EXPECT_LT(l.a, l.b);
  }
}

TEST(RowLinks, PassOverRowsOfTheOtherSense) {
  const auto program = rows_program(true);
  const ShiftPath path = path_of(program);
  const auto links = row_links(path, 1.0);
  EXPECT_EQ(links.size(), static_cast<std::size_t>((kRows - 2) * 25));
  for (const RowLink& l : links) EXPECT_NEAR(l.distance_mm, 2 * kStep_mm, 1e-9);
}

TEST(RowLinks, JoinNothingThatLiesTooFarAway) {
  const auto program = rows_program(false);
  EXPECT_TRUE(row_links(path_of(program), 0.25).empty());
}

TEST(RowLinks, SmoothErrorsAreStillCorrected) {
  const auto program = rows_program(false);
  ShiftPath path = path_of(program);
  const auto links = row_links(path, 1.0);
  const auto observations = observe(program, path, 0);
  fit_shift(path, observations, {.links = links});
  for (const Observation& o : observations) {
    if (path.points()[o.place.lower].along_mm < 2) continue;  // the first point is fixed
    EXPECT_NEAR(o.error_mm + o.normal.dot(path.shift_at(o.place)), 0, 0.0005);
  }
}

TEST(RowLinks, ARowThatTheGuardHoldsDoesNotHoldItsNeighbours) {
  const auto program = rows_program(false);
  ShiftPath path = path_of(program);
  const auto links = row_links(path, 1.0);
  auto observations = observe(program, path, 0);
  const auto row_of = [&](const Observation& o) {
    return std::lround(path.points()[o.place.lower].place_mm.y() / kStep_mm);
  };
  for (Observation& o : observations)
    if (row_of(o) == kRows - 1) o.error_mm = 0, o.weight = 5000;
  fit_shift(path, observations, {.links = links});
  double held = 0, beside = 0;
  for (const Observation& o : observations) {
    if (path.points()[o.place.lower].along_mm < 2) continue;
    if (row_of(o) == kRows - 1) held = std::max(held, std::abs(path.shift_at(o.place).z()));
    if (row_of(o) == kRows - 2) beside = std::max(beside, std::abs(o.error_mm + path.shift_at(o.place).z()));
  }
  EXPECT_LT(held, 0.0005);
  EXPECT_LT(beside, 0.008) << "of 0.025 mm";
}

TEST(RowLinks, NoiseFromRowToRowMakesNoFacets) {
  const auto program = rows_program(false);
  ShiftPath path = path_of(program);
  const auto links = row_links(path, 1.0);
  const auto observations = observe(program, path, 0.03);
  const double bound_rad = 3 * kPi / 180;

  fit_shift(path, observations, {});
  const double alone = row_turn(path, links, bound_rad).max_rad;
  ASSERT_GT(alone, bound_rad) << "rows fitted each for itself follow the noise";

  // As the loop does: stiffer where the bound is passed.
  std::vector<double> stiffness(links.size(), 1.0);
  path.set_shifts(std::vector<Vec3>(path.points().size(), Vec3::Zero()));
  fit_shift(path, observations, {.links = links, .link_stiffness = stiffness});
  EXPECT_LT(row_turn(path, links, bound_rad).max_rad, 0.8 * alone);
  for (int i = 0; i < 12; ++i) {
    const RowTurn turn = row_turn(path, links, bound_rad);
    if (turn.over.empty()) break;
    for (const std::size_t l : turn.over) stiffness[l] *= 2.5;
    path.set_shifts(std::vector<Vec3>(path.points().size(), Vec3::Zero()));
    fit_shift(path, observations, {.links = links, .link_stiffness = stiffness});
  }
  EXPECT_LE(row_turn(path, links, bound_rad).max_rad, bound_rad);

  // What is left of the error is the noise, not the error that all rows share.
  double sum = 0;
  for (const Observation& o : observations) sum += o.error_mm + o.normal.dot(path.shift_at(o.place));
  EXPECT_NEAR(sum / static_cast<double>(observations.size()), 0, 0.001);
}

TEST(RowLinks, ConjugateGradientsMeetTheEliminationWhereLinksWeighNothing) {
  const auto program = rows_program(false);
  ShiftPath alone = path_of(program), linked = path_of(program);
  const auto links = row_links(linked, 1.0);
  const auto observations = observe(program, alone, 0.03);
  const std::vector<double> nothing(links.size(), 1e-12);
  fit_shift(alone, observations, {});
  fit_shift(linked, observations, {.links = links, .link_stiffness = nothing});
  for (std::size_t i = 0; i < alone.points().size(); ++i)
    EXPECT_LT((alone.points()[i].shift_mm - linked.points()[i].shift_mm).norm(), 1e-9);
}

TEST(FitShift, AHeavyPointDoesNotBendThePathMoreThanALightOne) {
  const auto program = rows_program(false);
  ShiftPath path = path_of(program);
  auto light = observe(program, path, 0), heavy = light;
  for (std::size_t i = 0; i < heavy.size(); i += 7) heavy[i].error_mm += 0.005;
  light = heavy;
  for (std::size_t i = 0; i < heavy.size(); i += 7) heavy[i].weight = 1000;
  const auto roughness = [&](const std::vector<Observation>& observations) {
    path.set_shifts(std::vector<Vec3>(path.points().size(), Vec3::Zero()));
    fit_shift(path, observations, {});
    double most = 0;
    for (const ShiftChain& c : path.chains())
      for (std::size_t i = c.from + 5; i + 2 < c.from + c.count; ++i)
        most = std::max(
            most,
            (path.points()[i - 1].shift_mm - 2 * path.points()[i].shift_mm + path.points()[i + 1].shift_mm).norm());
    return most;
  };
  EXPECT_LT(roughness(heavy), 3 * roughness(light));
}

/// The error of each row as a whole, um, and that of one place.
Observed rows_that_leave(const nc::Interpretation& p, const ShiftPath& path, double up_um, double down_um,
                         double odd_um) {
  Observed out;
  int row = 0;
  for (std::uint32_t m = 0; m < p.moves.size(); ++m) {
    if (!path.contains(m)) continue;
    for (double u = 0.01; u < 1; u += 0.02) {
      const double e = row == 5 && std::abs(u - 0.5) < 0.05 ? odd_um : row % 2 ? down_um : up_um;
      out.points.push_back({path.find(m, u), Vec3::UnitZ(), e / 1000, 0.01});
      out.compensated.push_back(true);
    }
    ++row;
  }
  return out;
}

TEST(SurfaceSteps, AreToldBetweenRowsOfEitherSense) {
  const auto program = rows_program(true);
  const ShiftPath path = path_of(program);
  const auto pairs = row_links(path, 1.0, RowSense::any);
  EXPECT_GT(pairs.size(), row_links(path, 1.0).size());
  const auto steps = surface_steps(path, pairs, rows_that_leave(program, path, 9, 2, 2),
                                   rows_that_leave(program, path, 0.3, 0.1, 0.1));
  EXPECT_NEAR(1000 * steps.before_p95_mm, 7, 1e-9);
  EXPECT_NEAR(1000 * steps.after_p95_mm, 0.2, 1e-9);
  EXPECT_LE(steps.growth_rad, 0);
}

TEST(SurfaceSteps, FindThePlaceThatTheShiftMadeWorse) {
  const auto program = rows_program(true);
  const ShiftPath path = path_of(program);
  const auto steps = surface_steps(path, row_links(path, 1.0, RowSense::any), rows_that_leave(program, path, 9, 2, 2),
                                   rows_that_leave(program, path, 0.3, 0.1, 30));
  EXPECT_NEAR(1000 * steps.after_p95_mm, 0.2, 0.2) << "one place is not the whole";
  EXPECT_NEAR(1000 * steps.after_max_mm, 29.7, 1e-9);
  EXPECT_NEAR(steps.growth_rad, std::atan(0.0297 / kStep_mm) - std::atan(0.007 / kStep_mm), 1e-9);
}

}  // namespace
}  // namespace camber::compensate
