#include "report/html_report.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "report/histogram_svg.h"
#include "report/page_tables.h"
#include "tests/support/temp_folder.h"

namespace camber::report {
namespace {

/// A wave of n x n points on the lines of a grid, with an error that follows its slope.
std::vector<SurfaceSample> wave(int n) {
  std::vector<SurfaceSample> out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = 0.5 * i, y = 0.5 * j, slope = 0.8 * std::sin(y / 3);
      SurfaceSample s;
      s.place_mm = Vec3(x, y, -2.4 * std::cos(y / 3) + 0.01);
      s.normal = Vec3(0, -slope, 1).normalized();
      s.error_um = 40 * slope;
      s.error_after_um = 2 * slope;
      s.area_mm2 = 0.01;
      out.push_back(s);
    }
  return out;
}

ReportData example() {
  ReportData data;
  data.title = "Compensation of finish.nc";
  data.subtitle = "job.toml";
  data.figures = {{"95 % of the form error", 24.31, 1.2, "µm", 1, "{}_um.p95"},
                  {"rms", 12.0, 0.6, "um", 1, ""},
                  {"least", -31.04, -0.001, "um", 2, ""},
                  {"machine time", 111.2, 111.9, "s", 1, ""},
                  {"points", 900, std::nullopt, "", 0, ""}};
  data.surface = wave(30);
  data.compared = true;
  data.voxel_mm = 0.5;
  for (const char* name : {"before", "after"}) {
    PathRun run{name, "G1 X1.\nM30\n", {}};
    for (int i = 0; i < 5000; ++i) {
      PathRow row;
      row.t_s = 0.01 * i;
      row.block = 1;
      row.cutting = true;
      row.feed_mm_per_min = 900 * (1 - std::exp(-(i % 500) / 30.0));
      run.rows.push_back(row);
    }
    data.path.push_back(std::move(run));
  }
  data.tables = {{"Rounds", {"round", "rms, µm"}, {{"as given", "12.00"}, {"1", "0.60"}}, "Stopped: tolerance."},
                 {"Inputs", {}, {{"job", "a/job.toml"}}, ""}};
  data.warnings = {"p.nc:3:1: warning: <b>bold</b> [check]"};
  data.notes = {"12 points were cut to max_shift_mm", "<script>alert(1)</script>"};
  data.download_name = "out \"new\".nc";
  return data;
}

/// The page without what report/web gives.
std::string without_scripts(std::string page) {
  return page.erase(page.rfind("<script>"), page.rfind("</script>") - page.rfind("<script>"));
}

nlohmann::json index_of(const std::string& page) {
  const std::string open = "id=\"index\">";
  const std::size_t from = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

bool holds(const std::string& page, const std::string& text) { return page.find(text) != std::string::npos; }

TEST(HtmlReport, NeedsNoNetwork) {
  const std::string page = html_report(example());
  EXPECT_TRUE(holds(page,
                    "content=\"default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
                    "img-src data: blob:\""));
  for (const char* word : {"http://", "https://", "src=", "@import", "url("})
    EXPECT_FALSE(holds(without_scripts(page), word)) << word;
}

TEST(HtmlReport, IsTheSameForTheSameData) { EXPECT_EQ(html_report(example()), html_report(example())); }

TEST(HtmlReport, ShowsTextAsText) {
  const std::string page = html_report(example());
  EXPECT_FALSE(holds(page, "<script>alert"));
  EXPECT_TRUE(holds(page, "<li>&lt;script&gt;alert(1)&lt;/script&gt;</li>"));
  EXPECT_TRUE(holds(page, "<li>p.nc:3:1: warning: &lt;b&gt;bold&lt;/b&gt; [check]</li>"));
  EXPECT_TRUE(holds(page, "download=\"out &quot;new&quot;.nc\""));
}

TEST(HtmlReport, FileNamesCannotHideTheEndOfAScript) {
  for (const std::string name : {"<!--<script>.nc", "</script><b>.nc", "a<b\\u003c\".nc"}) {
    ReportData data = example();
    data.download_name = name;
    const std::string page = html_report(data);
    const std::size_t from = page.find("id=\"index\">"), to = page.find("</script>", from);
    EXPECT_EQ(page.substr(from + 11, to - from - 11).find('<'), std::string::npos) << name;
    EXPECT_EQ(index_of(page)["download"], name);
  }
}

TEST(HtmlReport, SaysItsVerdictAndTheReasonAboveTheDownload) {
  ReportData data = example();
  EXPECT_FALSE(holds(html_report(data), "id=\"verdict\""));
  data.verdict = PageVerdict{false, "over the <tolerance>", {"4 um rms: a & b"}};
  const std::string page = html_report(data);
  const std::size_t at = page.find(
      "id=\"verdict\"><p><b>Over the &lt;tolerance&gt;</b></p>\n"
      "<ul>\n<li>4 µm rms: a &amp; b</li>\n</ul>");
  ASSERT_NE(at, std::string::npos);
  EXPECT_LT(at, page.find("id=\"download\""));
  EXPECT_LT(at, page.find("class=\"tiles\""));
}

TEST(HtmlReport, ListsEveryFigure) {
  const std::string page = html_report(example());
  EXPECT_TRUE(holds(page,
                    "<tr><td>95 % of the form error</td><td><span data-key=\"before_um.p95\">24.3</span></td>"
                    "<td><span data-key=\"after_um.p95\">1.2</span></td><td>−95.1 %</td>"
                    "<td class=\"unit\">µm</td></tr>"));
  EXPECT_TRUE(holds(page, "<tr><td>least</td><td>−31.04</td><td>0.00</td><td>−100.0 %</td><td class=\"unit\">µm</td>"));
  EXPECT_TRUE(holds(page, "<tr><td>points</td><td>900</td><td></td><td></td><td class=\"unit\"></td></tr>"));
}

TEST(HtmlReport, ListsEveryTable) {
  const std::string page = html_report(example());
  EXPECT_TRUE(holds(page,
                    "<h2>Rounds</h2>\n<div class=\"wide\"><table><thead><tr><th>round</th><th>rms, µm</th></tr>"
                    "</thead><tbody>\n<tr><td>as given</td><td>12.00</td></tr>\n<tr><td>1</td><td>0.60</td></tr>\n"
                    "</tbody></table></div>\n<p class=\"note\">Stopped: tolerance.</p>"));
  EXPECT_TRUE(holds(page, "<table><tbody>\n<tr><td>job</td><td>a/<wbr>job.toml</td></tr>"));
}

TEST(HtmlReport, TakesRoundScalesThatHoldTheErrors) {
  EXPECT_EQ(index_of(html_report(example()))["scales"], (std::vector<double>{40, 2}));
}

TEST(HtmlReport, ListsTheWorstLinesByTheirSurface) {
  std::vector<SurfaceSample> points;
  for (std::uint32_t line = 1; line <= 12; ++line)
    for (const double sign : {1.0, -1.0})
      points.push_back({.error_um = sign * line, .error_after_um = 1, .area_mm2 = 2, .block = line, .block_after = 3});
  points.push_back({.error_um = 500, .area_mm2 = 1e-3, .block = 13});  // too little surface to be a line's fault
  const TextTable table = worst_lines_table(points, "G1 X1\r\nG1 X2\nG1 X3\n", false);
  ASSERT_EQ(table.rows.size(), 10u);
  EXPECT_EQ(table.rows.front(), (std::vector<std::string>{"12", "", "12.00", "12.00", "4.00"}));
  EXPECT_EQ(table.rows.back(), (std::vector<std::string>{"3", "G1 X3", "3.00", "3.00", "4.00"}));
  const TextTable after = worst_lines_table(points, "", true);
  ASSERT_EQ(after.rows.size(), 1u);
  EXPECT_EQ(after.rows.front(), (std::vector<std::string>{"3", "", "1.00", "1.00", "48.00"}));
}

TEST(HtmlReport, LooksAtAWallFromItsOutside) {
  ReportData data;
  data.surface = std::vector<SurfaceSample>{{.normal = {0, 1, 0}}, {.place_mm = {1, 0, 0}, .normal = {0, 1, 0}}};
  const auto view = index_of(html_report(data))["view"];
  EXPECT_GT(view[1], 0.9);
  EXPECT_GT(view[2], 0);
  data.surface = std::vector<SurfaceSample>{{.normal = {0, 1, 0}}, {.normal = {0, -1, 0}}};
  EXPECT_FALSE(index_of(html_report(data)).contains("view"));
}

TEST(HtmlReport, HoldsTheProgramsAsLongAsThereIsRoom) {
  const auto count = [](const std::string& page) {
    return std::pair(holds(page, "id=\"program0\""), holds(page, "id=\"program1\""));
  };
  auto data = example();
  EXPECT_EQ(count(html_report(data)), std::pair(true, true));
  for (int i = 0; i < 2000; ++i)
    for (auto& run : data.path) run.program_text += "N" + std::to_string(i * 7919) + "\n";
  const std::string page = html_report(data, {.max_program_bytes = 10000});
  EXPECT_EQ(count(page), std::pair(false, true));
  EXPECT_TRUE(
      holds(page, "The text of the program before is too large for this page; lines are named by their numbers."));
}

TEST(HtmlReport, SaysWhenSomethingWasLeftOut) {
  const std::string page = html_report(example(), {.max_vertices = 300, .max_rows = 300});
  EXPECT_TRUE(holds(page,
                    "The surface is drawn in cells of 1.5 mm (176 vertices for 900 points); each shows the error of "
                    "largest magnitude in it."));
  EXPECT_TRUE(holds(
      page,
      " of 5000 rows: of each group of neighbours the first and, for every quantity, the minimum and the maximum."));
  EXPECT_FALSE(holds(without_scripts(html_report(example())), " drawn "));
}

TEST(ErrorHistogram, CountsTheWholeArea) {
  for (const auto error : {&SurfaceSample::error_um, &SurfaceSample::error_after_um}) {
    const auto bins = error_histogram(wave(30), error, 10, 20);
    EXPECT_NEAR(std::accumulate(bins.begin(), bins.end(), 0.0), 100, 1e-9);
  }
  // Beyond the limits: in the first and the last bin.
  std::vector<SurfaceSample> two(2);
  two[0].error_um = -50;
  two[1].error_um = 50;
  two[1].area_mm2 = 3;
  const auto bins = error_histogram(two, &SurfaceSample::error_um, 10, 4);
  EXPECT_EQ(bins, (std::vector<double>{25, 0, 0, 75}));
}

TEST(HtmlReport, IsAPageWithoutAnyData) {
  const std::string page = html_report({});
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_FALSE(holds(page, "id=\"scene\""));
  EXPECT_FALSE(holds(page, "<script"));
}

TEST(HtmlReport, IsWrittenWhole) {
  const tests::TempFolder folder;
  write_html_report(folder / "r.html", example());
  EXPECT_EQ(tests::file_text(folder / "r.html"), html_report(example()));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html.part"));
}

}  // namespace
}  // namespace camber::report
