// The form across a row is told from its error along it, wherever across the row the points lie.
#include "compensate/row_form.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "compensate/error_split.h"

namespace camber::compensate {
namespace {

constexpr double kRadius_mm = 2, kWidth_mm = 0.25;

nc::Interpretation row(int blocks) {
  nc::Interpretation p;
  p.states.emplace_back();
  for (int i = 0; i < blocks; ++i) {
    nc::Move m;
    m.kind = nc::MoveKind::linear;
    m.start_mm = {0.5 * i, 0, 0};
    m.end_mm = {0.5 * (i + 1), 0, 0};
    m.block = static_cast<std::uint32_t>(i);
    p.moves.push_back(m);
  }
  return p;
}

double bow_mm(double across_mm) {  // of mean zero over the row
  const double t = across_mm / (kWidth_mm / 2);
  return 0.0010 * t + 0.0008 * (t * t - 1.0 / 3);
}
double along_mm(double x) { return 0.004 + 0.001 * std::sin(x / 3); }

/// Seven points a block, at random across a ball's row on a slope of 40 degrees.
std::vector<Observation> observed(const ShiftPath& path, unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Observation> out;
  for (std::uint32_t m = 0; m < 60; ++m)
    for (int k = 0; k < 7; ++k) {
      const double u = uniform(), across = kWidth_mm * (uniform() - 0.5), angle = 0.7 + across / kRadius_mm;
      Observation o;
      o.place = path.find(m, u);
      o.normal = {0, std::sin(angle), std::cos(angle)};
      o.from_centre_mm = kRadius_mm * o.normal;
      // The path's cross product with the normal turns the other way than y.
      o.error_mm = along_mm(0.5 * (m + u)) + bow_mm(-across);
      o.area_mm2 = 0.5 * kWidth_mm / 7;
      out.push_back(o);
    }
  return out;
}

/// Rms of the shift's error away from the ends.
double scatter_um(const ShiftPath& path) {
  double squares = 0;
  int count = 0;
  for (const auto& p : path.points()) {
    if (p.place_mm.x() < 3 || p.place_mm.x() > 27) continue;
    const double wanted = along_mm(p.place_mm.x());
    const double got = -p.shift_mm.dot(Vec3(0, std::sin(0.7), std::cos(0.7)));
    squares += (got - wanted) * (got - wanted);
    ++count;
  }
  return 1000 * std::sqrt(squares / count);
}

TEST(RowForm, IsFoundFromPointsAtRandom) {
  const auto program = row(60);
  const ShiftPath path(program, std::vector<bool>(60, true), 1.0);
  const auto points = observed(path, 3);
  std::vector<double> left;
  for (const auto& o : points)
    left.push_back(o.error_mm - along_mm(path.points()[o.place.lower].place_mm.x() + 0.5 * o.place.upper_fraction));
  const auto form = row_form_mm(path, points, left, 0.2);
  double squares = 0;
  for (std::size_t i = 0; i < form.size(); ++i) squares += (form[i] - left[i]) * (form[i] - left[i]);
  EXPECT_LT(1000 * std::sqrt(squares / static_cast<double>(form.size())), 0.05) << "of a bow of 0.6 um rms";
}

TEST(RowForm, KeepsTheShiftFromFollowingWhereTheGridShowsTheRow) {
  const auto program = row(60);
  double with = 0, without = 0;
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    ShiftPath plain(program, std::vector<bool>(60, true), 1.0), formed = plain;
    const auto points = observed(plain, seed);
    fit_shift(plain, points, {});
    fit_shift(formed, without_row_form(formed, points, {}), {});
    without += scatter_um(plain) / 4;
    with += scatter_um(formed) / 4;
  }
  EXPECT_GT(without, 0.15) << "else there is nothing to keep out";
  EXPECT_LT(with, 0.6 * without);
}

TEST(RowForm, SquaresAddUpWithIt) {
  const auto program = row(60);
  const ShiftPath path(program, std::vector<bool>(60, true), 1.0);
  Observed seen;
  seen.points = observed(path, 5);
  seen.compensated.assign(seen.points.size(), true);
  double squares = 0, area = 0;
  double bow_squares = 0;
  for (const auto& o : seen.points) {
    const double x = path.points()[o.place.lower].place_mm.x() + 0.5 * o.place.upper_fraction;
    squares += o.area_mm2 * o.error_mm * o.error_mm, area += o.area_mm2;
    bow_squares += o.area_mm2 * std::pow(o.error_mm - along_mm(x), 2);
  }
  const ErrorSplit s = split_error(path, seen, {});
  EXPECT_NEAR(std::hypot(s.correctable_um, s.not_correctable_um()), 1000 * std::sqrt(squares / area), 1e-6);
  constexpr double kAtRandom_um = 0.15;  // the mean product of the form and the error along is not zero
  EXPECT_NEAR(s.bow_um, 1000 * std::sqrt(bow_squares / area), kAtRandom_um);
}

TEST(RowForm, IsNothingWhereAWallStandsOnAFloor) {
  const auto program = row(60);
  const ShiftPath path(program, std::vector<bool>(60, true), 1.0);
  auto points = observed(path, 3);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].normal = {0, -std::cos(0.7), std::sin(0.7)};
  for (const double f : row_form_mm(path, points, std::vector<double>(points.size(), 0.001), 0.2)) EXPECT_EQ(f, 0);
}

TEST(RowForm, IsNothingWhereTheRowHasNoWidth) {
  const auto program = row(60);
  const ShiftPath path(program, std::vector<bool>(60, true), 1.0);
  auto points = observed(path, 3);
  for (auto& o : points) o.from_centre_mm = Vec3::Zero();
  for (const double f : row_form_mm(path, points, std::vector<double>(points.size(), 0.001), 0.2)) EXPECT_EQ(f, 0);
}

}  // namespace
}  // namespace camber::compensate
