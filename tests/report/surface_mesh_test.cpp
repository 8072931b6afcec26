#include "report/surface_mesh.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace camber::report {
namespace {

constexpr double kGrid_mm = 0.1;

/// Where the lines of a grid cross a sphere of 3 mm about the origin.
std::vector<SurfaceSample> sphere(double radius_mm) {
  std::vector<SurfaceSample> out;
  const int n = static_cast<int>(radius_mm / kGrid_mm) + 1;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = -n; i <= n; ++i)
      for (int j = -n; j <= n; ++j) {
        const double b = i * kGrid_mm, c = j * kGrid_mm, left = radius_mm * radius_mm - b * b - c * c;
        if (left <= 0) continue;
        for (const double sign : {-1.0, 1.0}) {
          SurfaceSample s;
          s.place_mm[axis] = sign * std::sqrt(left);
          s.place_mm[(axis + 1) % 3] = b;
          s.place_mm[(axis + 2) % 3] = c;
          s.normal = s.place_mm.normalized();
          s.error_um = 10 * s.normal.z();
          s.block = s.normal.z() > 0 ? 1 : 2;
          out.push_back(s);
        }
      }
  return out;
}

double area_of(const SurfaceMesh& mesh, double* outward_fraction = nullptr) {
  double area = 0, outward = 0;
  for (const auto& q : mesh.quads)
    for (const auto& t : {std::array{q[0], q[1], q[2]}, std::array{q[0], q[2], q[3]}}) {
      const Vec3 &a = mesh.vertices[t[0]].place_mm, &b = mesh.vertices[t[1]].place_mm,
                 &c = mesh.vertices[t[2]].place_mm;
      area += 0.5 * (b - a).cross(c - a).norm();
    }
  for (const auto& v : mesh.vertices) outward += v.normal.dot(v.place_mm.normalized()) > 0.99 ? 1 : 0;
  if (outward_fraction) *outward_fraction = outward / static_cast<double>(mesh.vertices.size());
  return area;
}

TEST(SurfaceMesh, ClosesASphere) {
  // 3.03: no grid point lies on it.
  const SurfaceMesh mesh = surface_mesh(sphere(3.03), kGrid_mm, 1000000);
  EXPECT_EQ(mesh.cell_mm, kGrid_mm);
  double outward = 0;
  EXPECT_NEAR(area_of(mesh, &outward), 4 * kPi * 3.03 * 3.03, 0.01 * 4 * kPi * 3.03 * 3.03);
  EXPECT_EQ(outward, 1);
  for (const auto& v : mesh.vertices) EXPECT_NEAR(v.place_mm.norm(), 3.03, 0.01);
  // Closed: every edge belongs to two faces, so there are twice as many of them as quadrangles (Euler: V - E + F = 2).
  EXPECT_EQ(mesh.vertices.size(), mesh.quads.size() + 2);
}

TEST(SurfaceMesh, TakesCellsTogetherAndKeepsTheExtremes) {
  auto samples = sphere(3.03);
  samples[1234].error_um = -99;
  samples[1234].block = 77;
  const SurfaceMesh mesh = surface_mesh(samples, kGrid_mm, 2000);
  EXPECT_LE(mesh.vertices.size(), 2000u);
  EXPECT_GT(mesh.vertices.size(), 500u);
  EXPECT_GT(mesh.cell_mm, 0.19);
  EXPECT_NEAR(area_of(mesh), 4 * kPi * 3.03 * 3.03, 0.05 * 4 * kPi * 3.03 * 3.03);
  double least = 0;
  std::uint32_t line = 0;
  for (const auto& v : mesh.vertices)
    if (v.error_um < least) {
      least = v.error_um;
      line = v.block;
    }
  EXPECT_EQ(least, -99);
  EXPECT_EQ(line, 77u);
}

TEST(SurfaceMesh, IsEmptyWithoutPoints) { EXPECT_TRUE(surface_mesh({}, kGrid_mm, 10).vertices.empty()); }

}  // namespace
}  // namespace camber::report
