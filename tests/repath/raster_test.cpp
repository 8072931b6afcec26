// Rows on the offset surface: no gouge, scallops as asked for, by carving a height field that knows nothing of repath/.
#include "repath/raster/raster.h"

#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "kinematics/control_options.h"

using namespace camber;
using namespace camber::repath;
using removal::CutterShape;

namespace {

using Height = std::function<double(double, double)>;

constexpr CutterShape kBall{.radius_mm = 3, .corner_radius_mm = 3};
constexpr CutterShape kFlat{.radius_mm = 3, .corner_radius_mm = 0};
constexpr CutterShape kBull{.radius_mm = 3, .corner_radius_mm = 1};

/// Block under a surface over [0, x] x [0, y]; its walls and bottom are of no matter here.
TriangleMesh surface(double x_mm, double y_mm, double cell_mm, const Height& height) {
  TriangleMesh mesh;
  const int nx = static_cast<int>(std::lround(x_mm / cell_mm)), ny = static_cast<int>(std::lround(y_mm / cell_mm));
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double x = x_mm * i / nx, y = y_mm * j / ny;
      mesh.points.push_back(Vec3(x, y, height(x, y)).cast<float>());
    }
  const auto at = [nx](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

RasterOptions over(double x_mm, double y_mm, double scallop_mm, double tolerance_mm = 0.002, double degrees = 0) {
  return {.boundary = {{0, 0}, {x_mm, y_mm}},
          .direction_rad = degrees * kPi / 180,
          .scallop_mm = scallop_mm,
          .tolerance_mm = tolerance_mm,
          .increment_mm = 0.0001};
}

/// Height of the underside above the tip.
double underside(const CutterShape& c, double r) {
  const double out = r - (c.radius_mm - c.corner_radius_mm);
  return out <= 0 ? 0
                  : c.corner_radius_mm - std::sqrt(std::max(0.0, c.corner_radius_mm * c.corner_radius_mm - out * out));
}

struct Left {
  double most = 0, least = 1e9, mean = 0;
};

constexpr double kCellX = 0.13, kCellY = 0.031;  // the rows lie along X, more or less

/// Points of a grid at least `rim_mm` within the border.
struct Grid {
  Grid(double x_mm, double y_mm, double rim)
      : rim_mm(rim), nx(static_cast<int>((x_mm - 2 * rim) / kCellX)), ny(static_cast<int>((y_mm - 2 * rim) / kCellY)) {}
  double x(int i) const { return rim_mm + i * kCellX; }
  double y(int j) const { return rim_mm + j * kCellY; }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j * (nx + 1) + i); }
  double rim_mm;
  int nx, ny;
};

/// Heights that the paths leave.
std::vector<double> carved(const std::vector<std::vector<Vec3>>& paths, const CutterShape& cutter, const Grid& grid,
                           double step_mm) {
  std::vector<double> out(grid.at(grid.nx, grid.ny) + 1, 1e9);
  const auto stamp = [&](const Vec3& tip) {
    const int i0 = static_cast<int>(std::ceil((tip.x() - cutter.radius_mm - grid.rim_mm) / kCellX));
    const int i1 = static_cast<int>(std::floor((tip.x() + cutter.radius_mm - grid.rim_mm) / kCellX));
    const int j0 = static_cast<int>(std::ceil((tip.y() - cutter.radius_mm - grid.rim_mm) / kCellY));
    const int j1 = static_cast<int>(std::floor((tip.y() + cutter.radius_mm - grid.rim_mm) / kCellY));
    for (int j = std::max(0, j0); j <= std::min(grid.ny, j1); ++j)
      for (int i = std::max(0, i0); i <= std::min(grid.nx, i1); ++i) {
        const double x = grid.x(i) - tip.x(), y = grid.y(j) - tip.y();
        if (x * x + y * y >= cutter.radius_mm * cutter.radius_mm) continue;
        double& h = out[grid.at(i, j)];
        h = std::min(h, tip.z() + underside(cutter, std::sqrt(x * x + y * y)));
      }
  };
  // Under a flat bottom a place is cut lowest as the rim passes over it: stamps would be early or late by up to a step,
  // which on a slope is height. The rim's passing is a quadratic equation.
  const auto sweep_flat = [&](const Vec3& from, const Vec3& to) {
    const Vec2 way = (to - from).head<2>();
    const double a = way.squaredNorm(), r = cutter.radius_mm;
    const auto first_cell = [&](double low, double cell) {
      return std::max(0, static_cast<int>(std::ceil((low - r - grid.rim_mm) / cell)));
    };
    const auto last_cell = [&](double high, double cell, int n) {
      return std::min(n, static_cast<int>(std::floor((high + r - grid.rim_mm) / cell)));
    };
    const int i0 = first_cell(std::min(from.x(), to.x()), kCellX), j0 = first_cell(std::min(from.y(), to.y()), kCellY);
    const int i1 = last_cell(std::max(from.x(), to.x()), kCellX, grid.nx);
    const int j1 = last_cell(std::max(from.y(), to.y()), kCellY, grid.ny);
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const Vec2 away = from.head<2>() - Vec2(grid.x(i), grid.y(j));
        const double b = away.dot(way), c = away.squaredNorm() - r * r, root = b * b - a * c;
        double first = 0, last = 1;
        if (a > 0 && root >= 0)
          first = std::max(0.0, (-b - std::sqrt(root)) / a), last = std::min(1.0, (-b + std::sqrt(root)) / a);
        if (root < 0 || first > last || (a == 0 && c > 0)) continue;
        double& h = out[grid.at(i, j)];
        for (const double t : {first, last}) h = std::min(h, from.z() + t * (to.z() - from.z()));
      }
  };
  const bool flat = cutter.corner_radius_mm == 0;
  for (const auto& path : paths)
    for (std::size_t k = 0; k + 1 < path.size(); ++k) {
      if (flat) {
        sweep_flat(path[k], path[k + 1]);
        continue;
      }
      const int n = 1 + static_cast<int>((path[k + 1] - path[k]).norm() / step_mm);
      for (int i = 0; i < n; ++i) stamp(path[k] + static_cast<double>(i) / n * (path[k + 1] - path[k]));
    }
  return out;
}

/// Whether the surface is hollow there in any direction: a flat bottom does not reach it.
bool hollow_at(const Height& height, double x, double y) {
  constexpr double e = 1e-3;
  const double here = height(x, y);
  const double xx = height(x + e, y) - 2 * here + height(x - e, y), yy = height(x, y + e) - 2 * here + height(x, y - e);
  const double xy = 0.25 * (height(x + e, y + e) - height(x + e, y - e) - height(x - e, y + e) + height(x - e, y - e));
  return 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy) > 1e-9;
}

/// What the path leaves above the surface, along its normal.
Left left_standing(const std::vector<std::vector<Vec3>>& paths, const CutterShape& cutter, const Height& height,
                   double x_mm, double y_mm, double rim_mm, double step_mm) {
  const Grid grid(x_mm, y_mm, rim_mm);
  const std::vector<double> left = carved(paths, cutter, grid, step_mm);
  const bool flat = cutter.corner_radius_mm < cutter.radius_mm;
  Left out;
  for (int j = 0; j <= grid.ny; ++j)
    for (int i = 0; i <= grid.nx; ++i) {
      const double x = grid.x(i), y = grid.y(j), e = 1e-4;
      if (flat && hollow_at(height, x, y)) continue;
      const double gx = (height(x + e, y) - height(x - e, y)) / (2 * e);
      const double gy = (height(x, y + e) - height(x, y - e)) / (2 * e);
      const double away = (left[grid.at(i, j)] - height(x, y)) / std::sqrt(1 + gx * gx + gy * gy);
      out.most = std::max(out.most, away), out.least = std::min(out.least, away);
      out.mean += away / ((grid.nx + 1) * (grid.ny + 1));
    }
  return out;
}

std::vector<std::vector<Vec3>> paths_of(const DropCutter& part, const Raster& raster, const RasterOptions& options) {
  std::vector<std::vector<Vec3>> out;
  for (const auto& chain : raster.chains) out.push_back(points_of(part, chain, options));
  return out;
}

double wave(double x, double y) { return 0.6 * std::sin(0.5 * x) * std::cos(0.4 * y) + 0.25 * y; }
double sphere(double x, double y) { return std::sqrt(30.0 * 30.0 - (x - 6) * (x - 6) - (y - 3) * (y - 3)) - 25; }
/// Convex, with radii of 20 to 35 mm that change.
double egg(double x, double y) {
  const double u = x - 2, v = y - 3;
  return 5 - u * u / 70 - v * v / 60 - 0.0003 * v * v * v * v + 0.003 * u * v;
}

}  // namespace

// The two rows' cusp on a plane: R - sqrt(R^2 - (w/2)^2), w along the plane; along the slope it is the level one.
TEST(Scallop, OfABallOnAPlaneIsTheClosedForm) {
  for (const double degrees : {0.0, 20.0, 45.0, 70.0})
    for (const bool across : {false, true}) {
      const double slope = std::tan(degrees * kPi / 180);
      const DropCutter part(surface(20, 20, 1, [&](double x, double y) { return slope * (across ? y : x); }), kBall);
      const RowSampler sampler(part, {}, {{0, 0}, {20, 20}}, 0.5);
      for (const double space : {0.1, 0.3}) {
        const double w = across ? space / std::cos(degrees * kPi / 180) : space;
        const double height = scallop_mm(sampler, part.cutter(), sampler.row(10), sampler.row(10 + space));
        EXPECT_NEAR(height, 3 - std::sqrt(9 - w * w / 4), 2e-5) << degrees << " " << across << " " << space;
      }
    }
}

// Convex and concave cylinders of radius S along the rows: the distance w of the centres is a chord of the offset
// cylinder, and the cusp lies sqrt(R^2 - w^2/4) from it.
TEST(Scallop, OfABallOnACylinderIsTheClosedForm) {
  for (const double bow : {1.0, -1.0}) {
    const double s = 20, offset = s + bow * 3;
    const auto height = [&](double, double y) { return bow * std::sqrt(s * s - (y - 6) * (y - 6)); };
    const DropCutter part(surface(12, 12, 0.05, height), kBall);
    const RowSampler sampler(part, {}, {{0, 0}, {12, 12}}, 0.5);
    const double space = 0.5, half_angle = std::asin(0.5 * space / offset);
    const double reach = std::sqrt(9 - space * space / 4);
    // Distance of the cusp from the cylinder's axis, less its radius.
    const double expected = bow * (offset * std::cos(half_angle) - bow * reach - s);
    EXPECT_NEAR(scallop_mm(sampler, part.cutter(), sampler.row(5.75), sampler.row(6.25)), expected, 3e-5) << bow;
  }
}

TEST(Scallop, OfAFlatCutterOnASlopeIsTheStepsHeight) {
  for (const double degrees : {2.0, 10.0, 40.0}) {
    const double slope = std::tan(degrees * kPi / 180);
    const DropCutter part(surface(20, 20, 1, [&](double, double y) { return slope * y; }), kFlat);
    const RowSampler sampler(part, {}, {{0, 0}, {20, 20}}, 0.5);
    EXPECT_NEAR(scallop_mm(sampler, part.cutter(), sampler.row(10), sampler.row(10.2)),
                0.2 * std::sin(degrees * kPi / 180), 2e-5);
  }
  const DropCutter level(surface(20, 20, 1, [](double, double) { return 1; }), kFlat);
  const RowSampler sampler(level, {}, {{0, 0}, {20, 20}}, 0.5);
  EXPECT_NEAR(scallop_mm(sampler, level.cutter(), sampler.row(8), sampler.row(12)), 0, 1e-12);
}

constexpr double kRim = 0.1;

struct Case {
  const char* name;
  CutterShape cutter;
  Height height;
  double degrees;
  double min_fraction;   ///< of the scallop asked for that is used up at the worst place
  double rim_mm = kRim;  ///< beside the border that is left out
};

TEST(Raster, LeavesTheScallopsThatWereAskedForAndNoMore) {
  constexpr double kScallop = 0.01, kTolerance = 0.002, kX = 6, kY = 5;
  const Case cases[] = {
      {"ball, plane across 30 degrees", kBall, [](double, double y) { return 0.577 * y; }, 0, 0.85},
      {"ball, plane along 30 degrees", kBall, [](double x, double) { return 0.577 * x; }, 0, 0.85},
      {"ball, sphere", kBall, sphere, 0, 0.85},
      // Rows along a border towards which the surface rises are cut off where they no longer touch inside.
      {"ball, wavy", kBall, wave, 0, 0.85, 0.6},
      {"ball, wavy, rows at 35 degrees", kBall, wave, 35, 0.85},
      {"bull, sphere", kBull, sphere, 0, 0.5},
      {"bull, plane across 20 degrees", kBull, [](double, double y) { return 0.364 * y; }, 0, 0.7},
      {"flat, plane across 5 degrees", kFlat, [](double, double y) { return 0.0875 * y; }, 0, 0.7},
      {"flat, sphere", kFlat, sphere, 0, 0.5, 0.6},
      {"flat, sphere, rows at 35 degrees", kFlat, sphere, 35, 0.5},
      {"flat, egg, rows at 60 degrees", kFlat, egg, 60, 0.5},
      {"bull, wavy", kBull, wave, 0, 0.5},
      {"bull, wavy, rows at 60 degrees", kBull, wave, 60, 0.5},
      {"bull, egg, rows at 60 degrees", kBull, egg, 60, 0.5},
  };
  for (const Case& c : cases) {
    const DropCutter part(surface(kX, kY, 0.1, c.height), c.cutter);
    const RasterOptions options = over(kX, kY, kScallop, kTolerance, c.degrees);
    const Raster raster = make_raster(part, options);
    EXPECT_LE(raster.spacing.largest_scallop_mm, kScallop) << c.name;
    EXPECT_EQ(raster.spacing.steep_fraction, 0) << c.name;
    const Left left = left_standing(paths_of(part, raster, options), c.cutter, c.height, kX, kY, c.rim_mm, 0.05);
    // Above: the scallop, the tolerance, and what stamps 0.05 mm apart and the mesh's chords leave.
    EXPECT_LE(left.most, kScallop + kTolerance + 0.0005) << c.name;
    EXPECT_GE(left.most, c.min_fraction * kScallop) << c.name;
    EXPECT_GE(left.least, -kTolerance - 0.0005) << c.name;
    RecordProperty(c.name, fmt::format("{:.4f}", left.most));
    std::cout << fmt::format("{:<36} {:3} rows, most {:.4f} mm", c.name, raster.spacing.rows_mm.size(), left.most);
    if (c.rim_mm > kRim) {
      const Left to_border = left_standing(paths_of(part, raster, options), c.cutter, c.height, kX, kY, kRim, 0.05);
      EXPECT_LE(to_border.most, 0.021) << c.name;
      std::cout << fmt::format(", {:.4f} mm with the strip along the border", to_border.most);
    }
    std::cout << '\n';
  }
}

// Ball: the height above a plane between rows is a parabola, whose mean is a third of its top.
TEST(Raster, LeavesAThirdOfTheScallopInTheMeanOnAPlane) {
  const Height level = [](double, double) { return 1; };
  const DropCutter part(surface(12, 6, 1, level), kBall);
  const RasterOptions options = over(12, 6, 0.01);
  const Raster raster = make_raster(part, options);
  const Left left = left_standing(paths_of(part, raster, options), kBall, level, 12, 6, 0.5, 0.05);
  EXPECT_NEAR(left.mean, 0.01 / 3, 0.0006);
}

TEST(OffsetPath, KeepsCornersOfThePathAndItsChordsWithinTheChord) {
  // A gutter: the ball's path has a corner in its middle; and a wall, up which it goes upright.
  const Height gutter = [](double x, double) { return std::abs(x - 4); };
  const DropCutter part(surface(8, 8, 0.5, gutter), kBall);
  const auto path = offset_path(part, {1, 4}, {7, 4}, {.chord_mm = 0.0005});
  double nearest = 1e9;
  for (const auto& p : path) nearest = std::min(nearest, std::abs(p.tip.x() - 4));
  EXPECT_LT(nearest, 0.0006);
  for (std::size_t k = 0; k + 1 < path.size(); ++k)
    for (const double t : {0.2, 0.4, 0.6, 0.8}) {
      const Vec3 p = path[k].tip + t * (path[k + 1].tip - path[k].tip);
      EXPECT_NEAR(p.z(), part.at(p.head<2>())->tip_mm, 0.0006 * std::sqrt(2.0));
    }
}

// Spikes, ridges and upright walls: nothing of them is cut by more than the tolerance, however the path is laid.
TEST(Raster, GougesNothingOfARoughPart) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> place(0, 10), height(0, 3), size(0.05, 2);
  TriangleMesh mesh = surface(10, 6, 2, [](double, double) { return 0; });
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto at = static_cast<std::uint32_t>(mesh.points.size());
    for (const Vec3& p : {a, b, c}) mesh.points.push_back(p.cast<float>());
    mesh.triangles.push_back({at, at + 1, at + 2});
  };
  for (int k = 0; k < 12; ++k) {
    const Vec3 foot(place(random), 0.6 * place(random), 0);
    const Vec3 top = foot + Vec3(0, 0, height(random)), a = foot + Vec3(size(random), 0.3, 0),
               b = foot + Vec3(-0.3, size(random), 0);
    add(top, a, b), add(top, foot, a), add(top, foot, b);
  }
  std::vector<Vec3> dense;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.points[t[0]].cast<double>(), b = mesh.points[t[1]].cast<double>(),
               c = mesh.points[t[2]].cast<double>();
    if (a.z() + b.z() + c.z() == 0) continue;  // the floor lies below everything
    constexpr int kSteps = 30;
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j)
        dense.push_back(a + (b - a) * (double(i) / kSteps) + (c - a) * (double(j) / kSteps));
  }
  for (const CutterShape& cutter : {kBall, kFlat, kBull}) {
    const DropCutter part(mesh, cutter);
    const RasterOptions options = over(10, 6, 0.05, 0.004);
    const Raster raster = make_raster(part, options);
    double deepest = 0;
    std::size_t places = 0;
    for (const auto& path : paths_of(part, raster, options))
      for (std::size_t k = 0; k + 1 < path.size(); ++k) {
        const int n = 1 + static_cast<int>((path[k + 1] - path[k]).norm() / 0.1);
        for (int i = 0; i < n; ++i, ++places) {
          const Vec3 tip = path[k] + (i + 0.5) / n * (path[k + 1] - path[k]);
          for (const Vec3& p : dense) {
            if (std::abs(p.x() - tip.x()) > 3 || std::abs(p.y() - tip.y()) > 3 || p.z() < tip.z()) continue;
            deepest = std::max(deepest, -cutter.distance_mm(p - tip));
          }
        }
      }
    EXPECT_GT(places, 1000u);
    EXPECT_LE(deepest, options.tolerance_mm) << cutter.corner_radius_mm;
  }
}

TEST(Raster, GoesToAndFroOverThePartAndLiftsOverWhatIsNot) {
  // Two islands 20 mm apart: nothing lies under the cutter between them.
  TriangleMesh mesh = surface(5, 5, 1, [](double, double) { return 1; });
  const TriangleMesh other = mesh;
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (const auto& p : other.points) mesh.points.push_back(p + Eigen::Vector3f(20, 0, 0));
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const DropCutter part(mesh, kBall);
  const Raster raster = make_raster(part, over(25, 5, 0.02));
  const std::size_t rows = raster.spacing.rows_mm.size();
  EXPECT_NEAR(raster.spacing.rows_mm.front(), 0, 1e-9);
  EXPECT_NEAR(raster.spacing.rows_mm.back(), 5, 1e-9);
  EXPECT_EQ(raster.pieces, 2 * rows);
  EXPECT_EQ(raster.links, rows - 1);  // from row to row on the same island
  EXPECT_EQ(raster.chains.size(), rows + 1);
  for (const auto& chain : raster.chains)
    for (std::size_t k = 0; k + 1 < chain.size(); ++k) EXPECT_EQ(chain[k].to, chain[k + 1].from);
  // To: along +X over both; fro: along -X.
  EXPECT_LT(raster.chains[0][0].from.x(), raster.chains[0][0].to.x());
  EXPECT_GT(raster.chains[1][2].from.x(), raster.chains[1][2].to.x());
}

TEST(RasterText, IsReadWithoutADiagnosticByEveryControl) {
  RasterProgram program;
  program.tool.number = 3;
  program.tool.diameter_mm = 6;
  program.spindle_rpm = 9000;
  program.feed_mm_per_min = 1200;
  program.clearance_mm = 12;
  program.lead_in_mm = 1;
  program.lead_in_from_mm = 8;
  const std::vector<std::vector<Vec3>> chains{{{0, 0, 1}, {4, 0, 1.5}, {4, 0.25, 0}}};
  for (const machine::ControlKind& kind : machine::control_kinds()) {
    SCOPED_TRACE(kind.name);
    program.dialect = kinematics::dialect_of(kind);
    const std::string text = raster_text(program, chains);
    EXPECT_EQ(text.find("O0001") != std::string::npos, program.dialect.has_program_number);
    machine::Machine machine;
    machine.control.kind = kind;
    Diagnostics diagnostics;
    const auto read = nc::read_program(SourceText("raster.nc", text), diagnostics);
    const auto moves = nc::interpret(read, kinematics::interpreter_options(machine, std::nullopt), diagnostics);
    EXPECT_TRUE(diagnostics.all().empty()) << to_string(diagnostics.all().front());
    ASSERT_EQ(moves.moves.size(), 7u);  // to the clearance plane, over the start, down, three cuts less one, up
    EXPECT_EQ(moves.moves[5].end_mm, Vec3(4, 0.25, 0));
  }
}

TEST(RasterText, IsAProgramThatAControlTakes) {
  RasterProgram program;
  program.tool.number = 3;
  program.tool.diameter_mm = 6;
  program.spindle_rpm = 9000;
  program.feed_mm_per_min = 1200;
  program.clearance_mm = 12;
  program.lead_in_mm = 1;
  program.lead_in_from_mm = 8;
  const std::vector<std::vector<Vec3>> chains{{{0, 0, 1}, {4, 0, 1.5}, {4, 0.25, -0.0001}}, {{9, 1, 2}, {5, 1, 2}}};
  EXPECT_EQ(raster_text(program, chains), R"(%
O0001 (FINISHING RASTER)
G21 G17 G90 G94 G40 G49 G80
T3 M6 (BALL D6)
G54 S9000 M3
G43 H3 G0 Z12.
X0. Y0. Z12.
Z8.
G1 Z1. F400.
X4. Z1.5 F1200.
Y0.25 Z0.
G0 Z12.
X9. Y1.
Z8.
G1 Z2. F400.
X5. F1200.
G0 Z12.
M5
M30
%
)");
}
