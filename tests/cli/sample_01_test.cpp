// The sample is what its files say: a program that reads clean, and a part that the program makes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "machine/job_file.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "test_paths.h"
#include "tests/support/binary_stl.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

const std::string kSample = CAMBER_SOURCE_DIR "/samples/01-finishing/";
constexpr double kBallRadiusMm = 3;
/// The chord tolerance, and half of the last decimal.
constexpr double kGougeMm = 0.002 + 0.0005;
/// Cusps between rows that lie no more than 0.39 mm apart along the steepest slope: 0.39^2 / (8 R).
constexpr double kCuspMm = 0.0064;

nc::Interpretation program() {
  Diagnostics diagnostics;
  const auto text = nc::read_program(SourceText::read(kSample + "finish.nc"), diagnostics);
  auto moves = nc::interpret(text, {}, diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  return moves;
}

/// Ball centres along the cutting moves, about every 0.02 mm, by row (their y).
std::map<double, std::vector<Vec3>> ball_centres(const nc::Interpretation& moves) {
  std::map<double, std::vector<Vec3>> rows;
  for (const auto& move : moves.moves) {
    if (move.kind != nc::MoveKind::linear) continue;
    const int steps = std::max(1, static_cast<int>((move.end_mm - move.start_mm).norm() / 0.02));
    for (int i = 0; i <= steps; ++i)
      rows[move.start_mm.y()].push_back(move.start_mm + (move.end_mm - move.start_mm) * (i / double(steps)) +
                                        Vec3(0, 0, kBallRadiusMm));
  }
  return rows;
}

double distance_mm(const Vec3& p, const std::map<double, std::vector<Vec3>>& rows) {
  double nearest = std::numeric_limits<double>::infinity();
  for (auto row = rows.lower_bound(p.y() - 3.1); row != rows.end() && row->first < p.y() + 3.1; ++row)
    for (const auto& c : row->second) nearest = std::min(nearest, (c - p).squaredNorm());
  return std::sqrt(nearest);
}

TEST(Sample01, ChecksWithoutAWord) {
  const tests::TempFolder folder;
  for (const char* name : {"finish.nc", "trace_program.nc"}) {
    const auto run = tests::run_camber(folder, "check --strict " + kSample + name);
    EXPECT_EQ(run.status, 0) << name;
    EXPECT_EQ(run.err, "") << name;
  }
}

TEST(Sample01, JobReadsWithoutAWord) {
  Diagnostics diagnostics;
  const auto job = machine::read_job(kSample + "job.toml", diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  EXPECT_EQ(job.tools.at(1).diameter_mm, 2 * kBallRadiusMm);
}

TEST(Sample01, ProgramMakesThePart) {
  const auto vertices = tests::stl_vertices(kSample + "part.stl");
  ASSERT_FALSE(vertices.empty());
  const double bottom =
      std::min_element(vertices.begin(), vertices.end(), [](auto& a, auto& b) { return a.z() < b.z(); })->z();
  const auto rows = ball_centres(program());
  double least = std::numeric_limits<double>::infinity(), greatest = 0;
  for (std::size_t i = 0; i < vertices.size(); i += 7) {  // every vertex stands in about six triangles
    if (vertices[i].z() == bottom) continue;
    const double d = distance_mm(vertices[i], rows);
    least = std::min(least, d);
    greatest = std::max(greatest, d);
  }
  EXPECT_GE(least, kBallRadiusMm - kGougeMm);
  EXPECT_LE(greatest, kBallRadiusMm + kCuspMm + kGougeMm);
}

TEST(Sample01, PartIsClosed) {
  // Signed volume of a closed surface does not depend on where the origin lies.
  const auto v = tests::stl_vertices(kSample + "part.stl");
  const auto volume = [&](const Vec3& origin) {
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); i += 3)
      sum += (v[i] - origin).dot((v[i + 1] - origin).cross(v[i + 2] - origin)) / 6;
    return sum;
  };
  EXPECT_NEAR(volume(Vec3::Zero()), volume({100, -50, 30}), 0.01);
  EXPECT_GT(volume(Vec3::Zero()), 0);
}

}  // namespace
}  // namespace camber
