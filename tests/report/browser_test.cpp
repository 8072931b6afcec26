// The page as a person sees it: opened in headless Chromium, without a network.
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "kinematics/chain.h"
#include "report/html_report.h"
#include "tests/support/cutting.h"
#include "tests/support/open_page.h"
#include "tests/support/temp_folder.h"

namespace camber::report {
namespace {

constexpr double kGrid_mm = 0.25;

/// A slope of 30 x 10 mm along X, red at one side and blue at the other before, next to nothing after. Line 3 + x makes
/// what lies between x and x + 1.
std::vector<SurfaceSample> slope(double length_mm = 30, double width_mm = 10, std::uint32_t lines_per_mm = 1) {
  std::vector<SurfaceSample> out;
  const Vec3 normal = Vec3(0, -0.1, 1).normalized();
  for (int i = 0; i * kGrid_mm <= length_mm; ++i)
    for (int j = 0; j * kGrid_mm <= width_mm; ++j) {
      SurfaceSample s;
      s.place_mm = Vec3(i * kGrid_mm, j * kGrid_mm, 0.013 + 0.1 * j * kGrid_mm);
      s.normal = normal;
      s.error_um = 20 * std::sin(2 * kPi * i * kGrid_mm / length_mm);
      s.error_after_um = 0.05 * s.error_um;
      s.area_mm2 = kGrid_mm * kGrid_mm;
      s.block = s.block_after = 3 + static_cast<std::uint32_t>(i * kGrid_mm * lines_per_mm);
      out.push_back(s);
    }
  return out;
}

/// One line a second: line 3 + n takes the tool from X n to X n + 1.
PathRun run_of(const std::string& name, double shift_mm) {
  PathRun run{name, "%\r\nO1\r\n", {}};
  for (int n = 0; n < 30; ++n) {
    run.program_text +=
        fmt::format("N{} G1 X{:.{}f}{}\r\n", n + 3, n + shift_mm, shift_mm > 0 ? 3 : 0, shift_mm > 0 ? "" : ".");
    for (int k = 0; k < 10; ++k) {
      PathRow row;
      row.t_s = n + 0.1 * k;
      row.place_mm = row.command_mm = Vec3(n + 0.1 * k, 5, 0.513 + shift_mm);
      row.block = static_cast<std::uint32_t>(n + 3);
      row.cutting = true;
      row.feed_command_mm_per_min = 900;
      row.feed_mm_per_min = 600;
      row.force_N = 20 + n;
      row.margin = 0.03 * n;
      row.error_um = 2;
      if (shift_mm > 0) row.shift_um = 1000 * shift_mm;
      run.rows.push_back(row);
    }
  }
  run.rows.push_back(run.rows.back());
  run.rows.back().t_s = 30;
  run.program_text += "M30\r\n%\r\n";
  return run;
}

ReportData example() {
  ReportData data;
  data.title = "Compensation of p.nc";
  data.figures = {{"form error, rms", 12.0, 0.6, "um", 2, ""},
                  {"largest shift", 1.0, std::nullopt, "um", 1, ""},
                  {"machine time", 30, 30, "s", 1, ""}};
  data.surface = slope();
  data.compared = true;
  data.voxel_mm = kGrid_mm;
  data.path = {run_of("before", 0), run_of("after", 0.001)};
  data.download_name = "out.nc";
  data.tables = {{"Rounds", {"round", "rms"}, {{"1", "0.60"}}, "Stopped: tolerance."}};
  return data;
}

/// Where the lines of a grid cross the faces of a box.
std::vector<SurfaceSample> faces(const Vec3& low, const Vec3& high, double cell_mm) {
  std::vector<SurfaceSample> out;
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int i = static_cast<int>(std::ceil(low[b] / cell_mm)); i * cell_mm < high[b]; ++i)
      for (int j = static_cast<int>(std::ceil(low[c] / cell_mm)); j * cell_mm < high[c]; ++j)
        for (const bool upper : {false, true}) {
          SurfaceSample s;
          s.place_mm[axis] = upper ? high[axis] : low[axis];
          s.place_mm[b] = i * cell_mm;
          s.place_mm[c] = j * cell_mm;
          s.normal = (upper ? 1.0 : -1.0) * Vec3::Unit(axis);
          out.push_back(s);
        }
  }
  return out;
}

/// A wall in front of the slope, higher than it.
ReportData behind_a_wall() {
  ReportData data = example();
  data.stock_cell_mm = 0.5;
  data.stock = faces({-5.1, -4.1, -8.1}, {35.1, -0.6, 3.1}, data.stock_cell_mm);
  return data;
}

/// Table-table: C on A on Y.
machine::Job five_axes() {
  machine::Job job;
  machine::Kinematics& k = job.machine.kinematics;
  k.chain = "cayxz";
  k.table_axes = 3;
  job.machine.rotary[0].direction = Vec3::UnitX();
  job.machine.rotary[0].point_mm = Vec3(0, 0, -70);
  job.machine.rotary[0].positive = job.machine.rotary[2].positive = machine::PositiveTurn::table;
  job.tools[1] = testing::make_tool(machine::ToolType::ball, 4, 2, 30);
  job.tools[1].holder = {{20, 24, 30}};
  return job;
}

/// The slope again: A turns by a degree a second, C stands at 20 degrees.
ReportData with_a_tilted_tool() {
  const machine::Job job = five_axes();
  const kinematics::Chain chain(job.machine);
  ReportData data = example();
  data.compared = false;
  data.path = {run_of("", 0)};
  for (PathRow& row : data.path[0].rows) {
    row.rotary_rad = Vec3(rad_from_deg(row.t_s), 0, rad_from_deg(20));
    row.axis = chain.pose({Vec3::Zero(), row.rotary_rad}, 0).axis;
    row.tool = 1;
  }
  EXPECT_TRUE(turns(data.path[0].rows));
  data.machine = machine_view(job, data.path[0].rows);
  return data;
}

class ReportPage : public ::testing::Test {
 protected:
  void SetUp() override { CAMBER_NEEDS_BROWSER(); }
  std::string checked(const std::string& check, const ReportData& data) {
    write_html_report(folder_ / "report.html", data);
    return tests::open_page(check, folder_ / "report.html");
  }
  tests::TempFolder folder_;
};

TEST_F(ReportPage, ShowsPartAndPathAndLeadsFromOneToTheOther) { EXPECT_EQ(checked("compared", example()), ""); }

TEST_F(ReportPage, DrawsTheToolAtTheSelectedPlaceAndTurnsThePart) {
  EXPECT_EQ(checked("tilted", with_a_tilted_tool()), "");
}

TEST(ReportData, OfAThreeAxisProgramHasNoMachine) {
  EXPECT_FALSE(turns(run_of("", 0).rows));
  const std::string page = html_report(example());
  EXPECT_EQ(page.find("\"machine\":{"), std::string::npos);
  EXPECT_NE(html_report(with_a_tilted_tool()).find("\"machine\":{\"chain\":{"), std::string::npos);
}

TEST_F(ReportPage, IsWholeWhateverTheFilesAreCalled) {
  ReportData data = example();
  data.download_name = "<!--<script>.nc";
  // The page is whole; the browser alone replaces what a file name must not have.
  EXPECT_EQ(checked("compared", data), "the download is called _!--_script_.nc\n");
}

TEST_F(ReportPage, ShowsTheStockInGreyAndNothingBehindIt) { EXPECT_EQ(checked("stock", behind_a_wall()), ""); }

TEST_F(ReportPage, SaysSoWithoutWebGl) { EXPECT_EQ(checked("without_webgl", example()), ""); }

TEST_F(ReportPage, IsReadWithoutScripts) { EXPECT_EQ(checked("without_script", example()), ""); }

/// 200 000 blocks of half a millimetre at 2000 mm/min: 50 minutes, and a surface of a million points.
ReportData large() {
  ReportData data = example();
  std::vector<SurfaceSample> surface = slope(500, 125, 400);
  unsigned noise = 1;  // so that nothing deflates better than real data would
  const auto random = [&noise] { return (noise = noise * 1664525u + 1013904223u) / 4294967296.0; };
  for (auto& s : surface) {
    s.error_um += random();
    s.error_after_um += random();
  }
  data.surface = std::move(surface);
  data.stock_cell_mm = 5;
  data.stock = faces({-11, -11, -81}, {511, 136, 3}, data.stock_cell_mm);
  data.path.clear();
  for (const char* name : {"before", "after"}) {
    PathRun run{name, {}, {}};
    for (int n = 0; n < 200000; ++n) {
      const double x = 0.5 * (n % 1000), y = 0.625 * (n / 1000);
      run.program_text += fmt::format("N{} X{:.3f} Y{:.3f} Z{:.3f}\n", n, x + random(), y + random(), random());
      for (int k = 0; k < 3; ++k) {
        PathRow row;
        row.t_s = 0.015 * n + 0.005 * k;
        row.place_mm = Vec3(x + random(), y + random(), random());
        row.block = static_cast<std::uint32_t>(n + 1);
        row.cutting = true;
        row.feed_command_mm_per_min = 2000;
        row.feed_mm_per_min = 1000 + 1000 * random();
        row.force_N = 20 + random();
        row.deflection_um = 20 + random();
        row.chip_um = 20 + random();
        row.margin = random();
        row.error_um = random();
        row.shift_um = 20 + random();
        run.rows.push_back(row);
      }
    }
    data.path.push_back(std::move(run));
  }
  return data;
}

TEST_F(ReportPage, OfALargeProgramStaysBelowTenMegabytesAndOpens) {
  const ReportData data = large();
  EXPECT_EQ(checked("large", data), "");
  RecordProperty("bytes", static_cast<int>(std::filesystem::file_size(folder_ / "report.html")));
  EXPECT_LT(std::filesystem::file_size(folder_ / "report.html"), 10'000'000u);
  EXPECT_GT(data.surface.size(), 900'000u);
}

}  // namespace
}  // namespace camber::report
