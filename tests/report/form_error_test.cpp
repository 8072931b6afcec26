#include "report/form_error_files.h"

#include <vector>

#include <gtest/gtest.h>

#include "report/base64.h"
#include "report/decimate.h"
#include "tests/support/temp_folder.h"

namespace camber::report {
namespace {

FormErrorPoints those(std::vector<FormErrorPoint> points) {
  const std::size_t count = points.size();
  return {count, [points = std::move(points)](std::size_t i) { return points[i]; }};
}

std::vector<FormErrorPoint> two_points() {
  return {{{1, 2, -3.25}, Vec3::Zero(), {0, 0, 1}, 12.3456, 2.0456, 0.0075, 13.5, std::nan(""), 42, 3},
          {{0, 0, 0}, Vec3::Zero(), {0, 0.6, 0.8}, -0.5, 0, 0.01, std::nan(""), 0}};
}

TEST(FormErrorCsv, HasARowAPoint) {
  const tests::TempFolder folder;
  write_form_error_csv(folder / "e.csv", those(two_points()));
  EXPECT_EQ(tests::file_text(folder / "e.csv"),
            "x_mm,y_mm,z_mm,nx,ny,nz,error_um,deflection_um,contour_um,total_error_um,area_mm2,block,tool,valid\n"
            "1.0000,2.0000,-3.2500,0.00000,0.00000,1.00000,12.346,10.300,2.046,13.500,0.007500,42,3,1\n"
            "0.0000,0.0000,0.0000,0.00000,0.60000,0.80000,-0.500,-0.500,0.000,,0.010000,0,0,1\n");
}

TEST(FormErrorVtp, HoldsEveryArray) {
  const tests::TempFolder folder;
  write_form_error_vtp(folder / "e.vtp", those(two_points()));
  const std::string text = tests::file_text(folder / "e.vtp");
  EXPECT_NE(text.find("<Piece NumberOfPoints=\"2\" NumberOfVerts=\"2\""), std::string::npos);
  for (const char* name : {"error_um", "deflection_um", "contour_um", "area_mm2", "total_error_um", "normal", "block",
                           "tool", "connectivity", "offsets"})
    EXPECT_NE(text.find(std::string("Name=\"") + name + "\""), std::string::npos) << name;
  // 8 bytes of length (8), then 12.3456f and -0.5f.
  std::string bytes;
  append_little_endian(bytes, std::uint64_t{8});
  append_little_endian(bytes, 12.3456f);
  append_little_endian(bytes, -0.5f);
  EXPECT_NE(text.find(">" + base64(bytes) + "<"), std::string::npos);
}

TEST(FormErrorVtp, LeavesTheTotalOutWhereThereIsNoMesh) {
  const tests::TempFolder folder;
  auto points = two_points();
  points[0].total_error_um = std::nan("");
  write_form_error_vtp(folder / "e.vtp", those(points));
  EXPECT_EQ(tests::file_text(folder / "e.vtp").find("total_error_um"), std::string::npos);
}

/// More than is written at once.
FormErrorPoints many_points(std::size_t count) {
  return {count, [](std::size_t i) {
            const double v = static_cast<double>(i);
            FormErrorPoint point{{v, -v, 0.5 * v}, Vec3::Zero(), {0, 0, 1}, 0.25 * v, 0, 1};
            point.block = static_cast<std::uint32_t>(i);
            point.tool = 7;
            return point;
          }};
}

TEST(FormErrorVtp, OfManyPointsIsBase64OfAllBytesInOrder) {
  constexpr std::size_t kCount = 150'001;  // 1.8 MB of places, no whole groups of three bytes
  const tests::TempFolder folder;
  const FormErrorPoints points = many_points(kCount);
  write_form_error_vtp(folder / "e.vtp", points);
  const std::string text = tests::file_text(folder / "e.vtp");
  std::string places, errors;
  append_little_endian(places, std::uint64_t{12 * kCount});
  append_little_endian(errors, std::uint64_t{4 * kCount});
  for (std::size_t i = 0; i < kCount; ++i) {
    const FormErrorPoint p = points.at(i);
    for (int a = 0; a < 3; ++a) append_little_endian(places, static_cast<float>(p.place_mm[a]));
    append_little_endian(errors, static_cast<float>(p.error_um));
  }
  EXPECT_NE(text.find(">" + base64(places) + "<"), std::string::npos);
  EXPECT_NE(text.find(">" + base64(errors) + "<"), std::string::npos);
}

TEST(FormErrorPly, OfManyPointsHoldsEachOnce) {
  constexpr std::size_t kCount = 60'000, kEach = 24 + 3 + 24;
  const tests::TempFolder folder;
  write_form_error_ply(folder / "e.ply", many_points(kCount), 1.0);
  const std::string text = tests::file_text(folder / "e.ply");
  const std::size_t end = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size(), end + kCount * kEach);
  for (const std::size_t i : {std::size_t{0}, std::size_t{26'887}, kCount - 1}) {
    std::string x;
    append_little_endian(x, static_cast<float>(i));
    EXPECT_EQ(text.substr(end + i * kEach, 4), x) << i;
  }
}

TEST(FormErrorPly, HoldsPlacesColoursAndWhatMadeThem) {
  const tests::TempFolder folder;
  write_form_error_ply(folder / "e.ply", those(two_points()), 1.0);
  const std::string text = tests::file_text(folder / "e.ply");
  const std::size_t end = text.find("end_header\n") + 11;
  EXPECT_EQ(text.substr(0, 36), "ply\nformat binary_little_endian 1.0\n");
  EXPECT_NE(text.find("element vertex 2\n"), std::string::npos);
  // A vertex: six floats, three bytes, four floats and two whole numbers.
  ASSERT_EQ(text.size(), end + 2 * (24 + 3 + 24));
  std::string first, second;
  for (const float v : {1.0f, 2.0f, -3.25f, 0.0f, 0.0f, 1.0f}) append_little_endian(first, v);
  first += std::string("\xff\x00\x00", 3);  // material left beyond the scale: red
  for (const double v : {12.3456, 12.3456 - 2.0456, 2.0456, 0.0075}) append_little_endian(first, static_cast<float>(v));
  append_little_endian(first, std::uint32_t{42});
  append_little_endian(first, std::uint32_t{3});
  EXPECT_EQ(text.substr(end, 51), first);
  EXPECT_EQ(text.substr(end + 51 + 24, 3), "\x80\x80\xff") << "half as deep as the scale: light blue";
}

TEST(Base64, AgreesWithRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Decimation, KeepsTheExtremes) {
  std::vector<double> values(1000, 0.0);
  values[437] = 5;
  values[900] = -7;
  const auto kept = keep_extremes(values, 90);
  EXPECT_LE(kept.size(), 90u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_NE(std::find(kept.begin(), kept.end(), 437u), kept.end());
  EXPECT_NE(std::find(kept.begin(), kept.end(), 900u), kept.end());
  EXPECT_EQ(keep_extremes(values, 1000).size(), 1000u);
}

TEST(Decimation, FindsRoundScales) {
  EXPECT_EQ(nice_limit(0), 1);
  EXPECT_EQ(nice_limit(0.7), 0.75);
  EXPECT_EQ(nice_limit(1.2), 1.5);
  EXPECT_EQ(nice_limit(20), 20);
  EXPECT_EQ(nice_limit(21), 30);
  EXPECT_EQ(nice_limit(98), 100);
}

}  // namespace
}  // namespace camber::report
