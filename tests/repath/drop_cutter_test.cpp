// The drop cutter against closed forms, against dense sampling, and the tree against every triangle.
#include "repath/raster/drop_cutter.h"

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

using namespace camber;
using namespace camber::removal;
using namespace camber::repath;

namespace {

constexpr double kExact = 1e-9;  // STL points are floats; the tests' own numbers are chosen to be exact in them

struct Named {
  const char* name;
  double radius, corner;
  double flat() const { return radius - corner; }
  CutterShape shape() const { return {.radius_mm = radius, .corner_radius_mm = corner}; }
};
constexpr Named kCutters[] = {{"ball", 3, 3}, {"flat", 3, 0}, {"bull", 3, 1}, {"bull, small corner", 3, 0.125}};

TriangleMesh mesh_of(const std::vector<std::array<Vec3, 3>>& triangles) {
  TriangleMesh mesh;
  for (const auto& t : triangles) {
    std::array<std::uint32_t, 3> index{};
    for (std::size_t k = 0; k < 3; ++k) {
      index[k] = static_cast<std::uint32_t>(mesh.points.size());
      mesh.points.push_back(t[k].cast<float>());
    }
    mesh.triangles.push_back(index);
  }
  return mesh;
}

double tip(const Named& cutter, const TriangleMesh& mesh, const Vec2& axis) {
  const auto contact = DropCutter(mesh, cutter.shape()).at(axis);
  EXPECT_TRUE(contact.has_value());
  return contact ? contact->tip_mm : 0;
}

/// Of the underside above the tip; written anew.
double underside(const Named& c, double r) {
  return r <= c.flat() ? 0 : c.corner - std::sqrt(c.corner * c.corner - (r - c.flat()) * (r - c.flat()));
}

/// A surface over a grid, two triangles a cell.
template <class Height>
TriangleMesh surface(double from, double to, int n, const Height& height) {
  TriangleMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = from + (to - from) * i / n, y = from + (to - from) * j / n;
      mesh.points.push_back(Vec3(x, y, height(x, y)).cast<float>());
    }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

TriangleMesh random_mesh(unsigned seed, int triangles, double size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-10, 10), near(-size, size), height(0, 4);
  std::vector<std::array<Vec3, 3>> out;
  for (int k = 0; k < triangles; ++k) {
    const Vec3 a(place(random), place(random), height(random));
    out.push_back(
        {a, a + Vec3(near(random), near(random), near(random)), a + Vec3(near(random), near(random), near(random))});
  }
  return mesh_of(out);
}

}  // namespace

TEST(DropCutter, RestsOnPlanesOfAnySlope) {
  for (const Named& c : kCutters)
    for (const double degrees : {0.0, 5.0, 30.0, 60.0, 80.0})
      for (const double uphill : {0.0, 0.7, 2.0, 4.5}) {
        const double slope = std::tan(degrees * kPi / 180), a = slope * std::cos(uphill), b = slope * std::sin(uphill);
        const auto mesh = surface(-40, 40, 1, [&](double x, double y) { return a * x + b * y; });
        // In the plane across: the corner's centre lies corner / cos above the plane, flat x slope higher than the
        // axis.
        const double expected = 0.5 * a - 0.25 * b + c.flat() * slope + c.corner * (std::sqrt(1 + slope * slope) - 1);
        EXPECT_NEAR(tip(c, mesh, {0.5, -0.25}), expected, 2e-5 * (1 + slope)) << c.name << " " << degrees;
      }
}

TEST(DropCutter, RestsOnASphere) {
  // Chords of 0.14 mm on a radius of 20 mm lie at most 0.14^2 / (8 * 20) under it.
  const double radius = 20;
  const auto mesh = surface(-9, 9, 180, [&](double x, double y) { return std::sqrt(radius * radius - x * x - y * y); });
  for (const Named& c : kCutters) {
    const DropCutter drop(mesh, c.shape());
    for (const double away : {0.0, 1.0, 2.0, 3.5, 6.0})
      for (const double turn : {0.0, 0.3, 1.1, 3.0}) {
        const double sine = std::max(0.0, away - c.flat()) / (radius + c.corner);
        const double expected = (radius + c.corner) * std::sqrt(1 - sine * sine) - c.corner;
        const auto contact = drop.at({away * std::cos(turn), away * std::sin(turn)});
        ASSERT_TRUE(contact);
        EXPECT_LE(contact->tip_mm, expected + 1e-5) << c.name << " " << away;
        EXPECT_GE(contact->tip_mm, expected - 1.6e-4) << c.name << " " << away;
      }
  }
}

TEST(DropCutter, RestsOnALyingCylinder) {
  const double radius = 20;
  const auto mesh = surface(-9, 9, 180, [&](double, double y) { return std::sqrt(radius * radius - y * y); });
  for (const Named& c : kCutters)
    for (const double away : {0.0, 1.0, 2.5, 5.0}) {
      const double sine = std::max(0.0, away - c.flat()) / (radius + c.corner);
      const double expected = (radius + c.corner) * std::sqrt(1 - sine * sine) - c.corner;
      EXPECT_NEAR(tip(c, mesh, {0.25, away}), expected, 8e-5) << c.name << " " << away;
    }
}

TEST(DropCutter, RestsOnACone) {
  // A pyramid of 24 sides; over the middle line of a side it is a plane, near the axis a point.
  constexpr int kSides = 24;
  const double height = 8, radius = 6, apothem = radius * std::cos(kPi / kSides), slope = height / apothem;
  std::vector<std::array<Vec3, 3>> sides;
  for (int k = 0; k < kSides; ++k) {
    const double a = 2 * kPi * k / kSides, b = 2 * kPi * (k + 1) / kSides;
    sides.push_back({Vec3(0, 0, height), Vec3(radius * std::cos(a), radius * std::sin(a), 0),
                     Vec3(radius * std::cos(b), radius * std::sin(b), 0)});
  }
  const auto mesh = mesh_of(sides);
  const double middle = kPi / kSides, cosine = 1 / std::sqrt(1 + slope * slope), sine = slope * cosine;
  for (const Named& c : kCutters)
    for (const double away : {0.0, 0.5, 2.0, 2.875, 4.0, 6.0}) {
      const double beside = away - c.flat() - c.corner * sine;  // of the contact from the cone's axis
      const double expected =
          beside >= 0 ? height - slope * beside - c.corner * (1 - cosine) : height - underside(c, away);
      EXPECT_NEAR(tip(c, mesh, {away * std::cos(middle), away * std::sin(middle)}), expected, 3e-6)
          << c.name << " " << away;
    }
}

TEST(DropCutter, RestsOnAnEdge) {
  // The upper edge of an upright triangle, from (-16, 0, 4 - 16 s) to (16, 0, 4 + 16 s).
  for (const Named& c : kCutters)
    for (const double slope : {0.0, 0.25, 1.0, 4.0})
      for (const double away : {0.0, 0.5, 1.9375, 2.0, 2.5, 2.9375}) {
        const auto mesh = mesh_of({{Vec3(-16, 0, 4 - 16 * slope), Vec3(16, 0, 4 + 16 * slope), Vec3(0, 0, -100)}});
        // The greatest of the concave slope l - underside, by halving thirds.
        const double chord = std::sqrt(c.radius * c.radius - away * away);
        double low = 0, high = chord;
        const auto lift = [&](double l) {
          return slope * l - underside(c, std::min(c.radius, std::sqrt(l * l + away * away)));
        };
        for (int i = 0; i < 300; ++i) {
          const double a = low + (high - low) / 3, b = high - (high - low) / 3;
          (lift(a) < lift(b) ? low : high) = lift(a) < lift(b) ? a : b;
        }
        const double expected = 4 + 0.5 * slope + lift(0.5 * (low + high));
        EXPECT_NEAR(tip(c, mesh, {0.5, away}), expected, 1e-7) << c.name << " " << slope << " " << away;
        const double of_ball = 4 + 0.5 * slope + chord * std::sqrt(1 + slope * slope) - c.radius;
        const double of_flat = 4 + 0.5 * slope + slope * chord;
        if (c.flat() == 0) {
          EXPECT_NEAR(tip(c, mesh, {0.5, away}), of_ball, kExact);
        }
        if (c.corner == 0) {
          EXPECT_NEAR(tip(c, mesh, {0.5, away}), of_flat, kExact);
        }
      }
}

TEST(DropCutter, RestsOnAVertexAndMissesWhatOnlyTouchesItsWall) {
  const auto needle = mesh_of({{Vec3(0, 0, 2), Vec3(0.0625, 0, -50), Vec3(0, 0.0625, -50)}});
  for (const Named& c : kCutters) {
    for (const double away : {0.0, 1.0, 2.0, 2.5, 2.875})
      EXPECT_NEAR(tip(c, needle, {0, -away}), 2 - underside(c, away), kExact) << c.name;
    EXPECT_FALSE(DropCutter(needle, c.shape()).at({0, -3}).has_value()) << c.name;
    EXPECT_FALSE(DropCutter(needle, c.shape()).at({-3.001, 0}).has_value()) << c.name;
  }
}

// No point of the mesh is inside the cutter, by the envelope that carving uses; and the point that it is said to touch
// is one of the mesh, and on the envelope.
TEST(DropCutter, TouchesRandomMeshesAndEntersThemNowhere) {
  for (const Named& c : kCutters) {
    const auto mesh = random_mesh(7, 40, 5);
    const DropCutter drop(mesh, c.shape());
    std::mt19937 random(11);
    std::uniform_real_distribution<double> place(-11, 11);
    int touched = 0, kinds[3] = {0, 0, 0};
    for (int trial = 0; trial < 60; ++trial) {
      const Vec2 axis(place(random), place(random));
      const auto contact = drop.at(axis);
      if (!contact) continue;
      ++touched;
      ++kinds[static_cast<int>(contact->kind)];
      const Vec3 tip_at(axis.x(), axis.y(), contact->tip_mm);
      EXPECT_NEAR(contact->tip_mm + underside(c, std::min(c.radius, (contact->point.head<2>() - axis).norm())),
                  contact->point.z(), 1e-7);
      double deepest = 1e9, nearest = 1e9;
      for (const auto& t : mesh.triangles) {
        const Vec3 a = mesh.points[t[0]].cast<double>(), b = mesh.points[t[1]].cast<double>(),
                   d = mesh.points[t[2]].cast<double>();
        constexpr int kSteps = 120;
        for (int i = 0; i <= kSteps; ++i)
          for (int j = 0; i + j <= kSteps; ++j) {
            const Vec3 p = a + (b - a) * (double(i) / kSteps) + (d - a) * (double(j) / kSteps);
            deepest = std::min(deepest, c.shape().distance_mm(p - tip_at));
            nearest = std::min(nearest, (p - contact->point).norm());
          }
      }
      EXPECT_GT(deepest, -1e-7) << c.name << " at " << axis.transpose();
      EXPECT_LT(deepest, 0.15) << c.name << " at " << axis.transpose();
      EXPECT_LT(nearest, 0.1) << c.name;
    }
    EXPECT_GT(touched, 40);
    if (c.corner > 0) {
      EXPECT_GT(kinds[0], 0);
    }
    EXPECT_GT(kinds[1], 0);
    EXPECT_GT(kinds[2], 0);
  }
}

TEST(DropCutter, TheTreeFindsWhatTryingEveryTriangleFinds) {
  for (const Named& c : kCutters) {
    const auto mesh = random_mesh(3, 3000, 0.8);
    const DropCutter drop(mesh, c.shape());
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-14, 14);
    std::optional<std::uint32_t> near;
    for (int trial = 0; trial < 300; ++trial) {
      const Vec2 axis(place(random), place(random));
      std::optional<double> highest;
      for (const auto& t : mesh.triangles) {
        const auto one = contact_with(
            underside_of(c.shape()),
            Facet(mesh.points[t[0]].cast<double>(), mesh.points[t[1]].cast<double>(), mesh.points[t[2]].cast<double>()),
            axis);
        if (one && (!highest || one->tip_mm > *highest)) highest = one->tip_mm;
      }
      const auto found = drop.at(axis, near);
      ASSERT_EQ(found.has_value(), highest.has_value());
      if (!found) continue;
      EXPECT_EQ(found->tip_mm, *highest) << c.name;
      near = found->triangle;
    }
  }
}

TEST(DropCutter, TheGrooveOfAMoveAlongASlopeIsTheEnvelopeOfItsPlaces) {
  for (const Named& c : kCutters)
    for (const double slope : {-1.5, 0.0, 0.4})
      for (const double beside : {0.0, 1.0, 2.25, 2.875}) {
        double lowest = 1e9;
        for (double along = -3; along <= 3; along += 1e-4) {
          const double r = std::hypot(along, beside);
          if (r <= c.radius) lowest = std::min(lowest, slope * along + underside(c, r));
        }
        const auto rise = rise_on_line(underside_of(c.shape()), beside, slope);
        ASSERT_TRUE(rise);
        EXPECT_NEAR(-*rise, lowest, 4e-4) << c.name << " " << slope << " " << beside;
        EXPECT_LE(-*rise, lowest + 1e-9);
      }
  EXPECT_FALSE(rise_on_line(underside_of(kCutters[0].shape()), 3.0, 0.4));
}
