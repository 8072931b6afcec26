#include "inspect/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace camber::inspect {
namespace {

using machine::Feature;
using machine::FeatureFilter;
using machine::FeatureKind;
using removal::SurfacePoint;

constexpr double kVoxel_mm = 0.1;
constexpr double kRead_um = 0.05;  // readings are means over three voxels of a curved error

/// Surface of a hole of radius `radius` in `points`, its errors by angle and height: material left is positive.
void add_hole(std::vector<SurfacePoint>& points, const Vec3& top, double radius, double depth,
              const std::function<double(double, double)>& error_mm, double contour_mm = 0) {
  const int around = static_cast<int>(2 * kPi * radius / kVoxel_mm);
  for (double z = 0; z <= depth; z += kVoxel_mm)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * kPi * i / around;
      const Vec3 out(std::cos(a), std::sin(a), 0);
      SurfacePoint p;
      p.place_mm = top + radius * out - z * Vec3::UnitZ();
      p.normal = -out;
      p.error_mm = error_mm(a, z) + contour_mm;
      p.contour_mm = contour_mm;
      p.area_mm2 = kVoxel_mm * kVoxel_mm;
      points.push_back(p);
    }
}

/// A flat face from `corner` along u and v, with the error by the place on it.
void add_face(std::vector<SurfacePoint>& points, const Vec3& corner, const Vec3& u, const Vec3& v,
              const std::function<double(double, double)>& error_mm) {
  for (double a = 0; a <= u.norm() + 1e-9; a += kVoxel_mm)
    for (double b = 0; b <= v.norm() + 1e-9; b += kVoxel_mm) {
      SurfacePoint p;
      p.place_mm = corner + a * u.normalized() + b * v.normalized();
      p.normal = Vec3(u.normalized().y() * v.normalized().z() - u.normalized().z() * v.normalized().y(),
                      u.normalized().z() * v.normalized().x() - u.normalized().x() * v.normalized().z(),
                      u.normalized().x() * v.normalized().y() - u.normalized().y() * v.normalized().x());
      p.error_mm = error_mm(a, b);
      p.area_mm2 = kVoxel_mm * kVoxel_mm;
      points.push_back(p);
    }
}

Feature bore(const std::string& name, const Vec3& top, double diameter, double depth) {
  Feature f;
  f.name = name;
  f.kind = FeatureKind::bore;
  f.axis_mm = {top, top - depth * Vec3::UnitZ()};
  f.nominal_mm = diameter;
  return f;
}

FeatureResult only(const Feature& f, const std::vector<SurfacePoint>& points, const machine::ModelError& error = {}) {
  return evaluate({f}, points, kVoxel_mm, error).front();
}

TEST(Evaluate, BoreWithEvenMaterialIsSmallerByTwiceIt) {
  std::vector<SurfacePoint> points;
  add_hole(
      points, {3, 4, 0}, 2.01, 5, [](double, double) { return 0.006; }, 0.002);
  const FeatureResult r =
      only(bore("A", {3, 4, 0}, 4, 5), points, {.deflection = 0.5, .contour = 0.1, .size_mm = 0.001});
  ASSERT_TRUE(r.predicted_mm) << r.reason;
  EXPECT_NEAR(*r.commanded_mm, 4.02, 1e-9);
  EXPECT_NEAR(*r.predicted_mm, 4.02 - 0.016, 1e-9);
  EXPECT_NEAR(r.contour_um, -4, 1e-6);
  EXPECT_NEAR(r.deflection_um, -12, 1e-6);
  EXPECT_NEAR(*r.std_mm, std::hypot(0.5 * 0.012, 0.1 * 0.004, 0.001), 1e-9);
  EXPECT_NEAR(*r.form_um, 0, 1e-6);
  EXPECT_NEAR(*r.taper_um, 0, 1e-6);
}

TEST(Evaluate, FiltersOfThreeLobesFindTheirClosedForms) {
  std::vector<SurfacePoint> points;
  add_hole(points, {0, 0, 0}, 2, 5, [](double a, double) { return -0.004 * std::cos(3 * a); });
  Feature f = bore("A", {0, 0, 0}, 4, 5);
  f.depth_mm = 2.5;
  const std::array<double, 4> wanted{4, 4 - 0.008, 4 + 0.008, 4};
  for (const FeatureFilter filter : {FeatureFilter::least_squares, FeatureFilter::max_inscribed,
                                     FeatureFilter::min_circumscribed, FeatureFilter::min_zone}) {
    f.filter = filter;
    const FeatureResult r = only(f, points);
    EXPECT_NEAR(1000 * *r.predicted_mm, 1000 * wanted[static_cast<std::size_t>(filter)], kRead_um);
    EXPECT_NEAR(*r.form_um, 8, kRead_um);
  }
}

TEST(Evaluate, TaperAndStraightnessOfABore) {
  std::vector<SurfacePoint> points;
  // Larger at the top by 10 um in diameter over 5 mm; the axis bows by 3 um in the middle, towards +X.
  add_hole(points, {0, 0, 0}, 2, 5, [](double a, double z) {
    const double bow = 0.003 * (1 - std::pow(2 * z / 5 - 1, 2));
    return -(0.005 * (1 - z / 5) + bow * std::cos(a));
  });
  const FeatureResult r = only(bore("A", {0, 0, 0}, 4, 5), points);
  EXPECT_NEAR(*r.taper_um, 10, 0.1);
  EXPECT_GT(*r.straightness_um, 1);
  EXPECT_LT(*r.straightness_um, 6);
}

TEST(Evaluate, PositionsAreJudgedAfterTheAlignment) {
  std::vector<SurfacePoint> points;
  const auto moved = [](double dx) { return [dx](double a, double) { return -dx * std::cos(a); }; };
  add_hole(points, {0, 0, 0}, 2, 3, moved(0.005));
  add_hole(points, {20, 0, 0}, 2, 3, moved(0.005));
  add_hole(points, {10, 8, 0}, 2, 3, moved(0.009));
  std::vector<Feature> features{bore("A", {0, 0, 0}, 4, 3), bore("B", {20, 0, 0}, 4, 3), bore("C", {10, 8, 0}, 4, 3)};
  auto r = evaluate(features, points, kVoxel_mm);
  EXPECT_NEAR(r[2].position_um->x(), 9, kRead_um);
  features[0].align = features[1].align = true;
  r = evaluate(features, points, kVoxel_mm);
  EXPECT_NEAR(r[0].position_um->x(), 0, kRead_um);
  EXPECT_NEAR(r[2].position_um->x(), 4, kRead_um);
  EXPECT_NEAR(*r[2].predicted_mm, 4, 1e-4);  // sizes do not depend on it
}

Feature distance_of_a_and_b() {
  Feature d;
  d.name = "D";
  d.kind = FeatureKind::distance;
  d.of = {"A", "B"};
  d.nominal_mm = 25;
  return d;
}

TEST(Evaluate, DistanceOfPartsOfCirclesHasTheBandOfTheirSizes) {
  std::vector<SurfacePoint> points;
  for (const double x : {0.0, 25.0})
    add_hole(
        points, {x, 0, 0}, 2, 3, [](double, double) { return 0.006; }, 0.002);
  std::vector<Feature> features{bore("A", {0, 0, 0}, 4, 3), bore("B", {25, 0, 0}, 4, 3), distance_of_a_and_b()};
  const machine::ModelError error{.deflection = 0.5, .contour = 0.1, .size_mm = 0.001};
  EXPECT_NEAR(*evaluate(features, points, kVoxel_mm, error)[2].std_mm, 0, 1e-6);  // whole circles keep their middles
  for (Feature* f : {&features[0], &features[1]}) f->arc_rad = {0, kPi};
  EXPECT_NEAR(*evaluate(features, points, kVoxel_mm, error)[2].std_mm, std::sqrt(2) * std::hypot(0.006, 0.0004), 1e-6);
}

TEST(Evaluate, DistanceOfTwoBoresFollowsTheirMiddles) {
  std::vector<SurfacePoint> points;
  add_hole(points, {0, 0, 0}, 2, 3, [](double a, double) { return 0.003 * std::cos(a); });    // 3 um towards -X
  add_hole(points, {25, 0, 0}, 2, 3, [](double a, double) { return -0.004 * std::cos(a); });  // 4 um towards +X
  const auto r =
      evaluate({bore("A", {0, 0, 0}, 4, 3), bore("B", {25, 0, 0}, 4, 3), distance_of_a_and_b()}, points, kVoxel_mm);
  ASSERT_TRUE(r[2].predicted_mm) << r[2].reason;
  EXPECT_NEAR(1000 * (*r[2].predicted_mm - 25), 7, kRead_um);
}

TEST(Evaluate, PartOfACircleIsFoundAmongStraightWalls) {
  std::vector<SurfacePoint> points;
  add_hole(points, {0, 0, 0}, 2, 3, [](double, double) { return 0.002; });
  std::erase_if(points, [](const SurfacePoint& p) { return p.place_mm.x() < 0; });
  Feature f = bore("end", {0, 0, 0}, 4, 3);
  f.depth_mm = 1.5;
  EXPECT_FALSE(only(f, points).predicted_mm && only(f, points).missed == 0);
  f.arc_rad = {-kPi / 2, kPi / 2};
  const FeatureResult r = only(f, points);
  ASSERT_TRUE(r.predicted_mm) << r.reason;
  EXPECT_NEAR(*r.predicted_mm, 4 - 0.004, 1e-6);
}

TEST(Evaluate, PlaneSlotWallAndPoints) {
  std::vector<SurfacePoint> points;
  add_face(points, {0, 0, -2}, {10, 0, 0}, {0, 6, 0}, [](double, double) { return 0.003; });        // floor, +Z
  add_face(points, {0, 0, -2}, {0, 0, 2}, {10, 0, 0}, [](double, double) { return 0.004; });        // y = 0, +Y
  add_face(points, {0, 6, -2}, {10, 0, 0}, {0, 0, 2}, [](double, double b) { return 0.002 * b; });  // y = 6, -Y
  Feature floor, slot, spots;
  floor.kind = FeatureKind::plane;
  floor.axis_mm = {Vec3(5, 3, -7), Vec3(5, 3, -2)};
  floor.nominal_mm = 5;
  const FeatureResult f = only(floor, points);
  ASSERT_TRUE(f.predicted_mm) << f.reason;
  EXPECT_NEAR(*f.predicted_mm, 5.003, 1e-9);
  EXPECT_NEAR(*f.form_um, 0, 1e-6);
  slot.kind = FeatureKind::slot_width;
  slot.axis_mm = {Vec3(1, 3, 0), Vec3(9, 3, 0)};
  slot.nominal_mm = 6;
  slot.depth_mm = 1;
  EXPECT_NEAR(*only(slot, points).predicted_mm, 6 - 0.004 - 0.002, 1e-6);
  slot.depth_mm.reset();
  const FeatureResult s = only(slot, points);
  EXPECT_NEAR(*s.predicted_mm, 6 - 0.004 - 0.002, 1e-5);
  EXPECT_NEAR(*s.taper_um, -2 * 1.6, kRead_um);  // narrower at the top, over the measured 80 % of 2 mm
  spots.kind = FeatureKind::points;
  spots.points_mm = {Vec3(5, 3, -2), Vec3(5, 0, -1)};
  const FeatureResult p = only(spots, points);
  EXPECT_NEAR(*p.predicted_mm, 0.0035, 1e-9);
  EXPECT_NEAR(*p.form_um, 1, 1e-6);
  std::vector<SurfacePoint> web;
  add_face(web, {0, 0, 0}, {0, 10, 0}, {0, 0, 10}, [](double, double) { return 0.001; });   // +X
  add_face(web, {-2, 0, 0}, {0, 0, 10}, {0, 10, 0}, [](double, double) { return 0.002; });  // -X
  Feature wall;
  wall.kind = FeatureKind::wall;
  wall.axis_mm = {Vec3(-2, 5, 5), Vec3(0, 5, 5)};
  wall.nominal_mm = 2;
  wall.extent_mm = 2;
  EXPECT_NEAR(*only(wall, web).predicted_mm, 2.003, 1e-9);
}

TEST(Evaluate, WhatIsBeyondTheModelOrNotCutHasNoPrediction) {
  std::vector<SurfacePoint> points;
  add_hole(points, {0, 0, 0}, 2, 3, [](double, double) { return 0.002; });
  for (SurfacePoint& p : points) p.valid = false;
  const FeatureResult r = only(bore("A", {0, 0, 0}, 4, 3), points);
  EXPECT_FALSE(r.predicted_mm);
  EXPECT_EQ(r.reason, "648 of 648 places have no surface of the job's operations, or are beyond the model");
  EXPECT_FALSE(only(bore("A", {50, 0, 0}, 4, 3), points).predicted_mm);
}

TEST(Evaluate, CsvHasTheColumnsAndLeavesOutWhatIsNotKnown) {
  std::vector<FeatureResult> results(2);
  results[0].feature = "bore, top";
  results[0].nominal_mm = 4;
  results[0].predicted_mm = 4.0012346;
  results[0].std_mm = 0.0015;
  results[0].measured_mm = 4.003;
  results[0].lower_mm = 3.99;
  results[0].upper_mm = 4.01;
  results[1].feature = "wall";
  results[1].kind = FeatureKind::wall;
  results[1].nominal_mm = 2;
  EXPECT_EQ(features_csv(results),
            "feature,kind,nominal_mm,predicted_mm,std_mm,measured_mm,difference_um,form_um,taper_um,lower_mm,upper_mm,"
            "within\n"
            "\"bore, top\",bore,4.000000,4.001235,0.001500,4.003000,1.765,,,3.990000,4.010000,1\n"
            "wall,wall,2.000000,,,,,,,,,\n");
}

}  // namespace
}  // namespace camber::inspect
