#include "report/html_report.h"

#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temp_folder.h"

namespace camber::report {
namespace {

/// A hill of n x n points with an error that follows its slope.
std::vector<SurfaceSample> hill(int n, double error_um) {
  std::vector<SurfaceSample> out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = 20.0 * i / n, y = 14.0 * j / n;
      const double slope = 0.8 * std::sin(y / 3);
      const double length = std::sqrt(1 + slope * slope);
      out.push_back({x, y, -2.4 * std::cos(y / 3), 0, -slope / length, 1 / length, error_um * slope, 0.01});
    }
  return out;
}

ReportData example() {
  ReportData data;
  data.title = "Camber: finish.nc";
  data.subtitle = "job.toml";
  data.figures = {{"95 % of the form error", 24.31, 1.2, "µm", 1},
                  {"root mean square", 12.0, 0.6, "um", 1},
                  {"greatest force", 61.5, 60.2, "N", 1},
                  {"machine time", 111.2, 111.9, "s", 1},
                  {"points", 900, std::nullopt, "", 0}};
  data.before = hill(30, 40);
  data.after = hill(30, 2);
  for (int i = 0; i < 5000; ++i) data.feed.push_back({i * 0.001, 900, 900 * (1 - std::exp(-(i % 500) / 30.0))});
  data.rounds = {{0, 24.31, 12, -31, 30, 0}, {1, 4.2, 2, -6, 7, 31}, {2, 1.2, 0.6, -2, 2, 33}};
  data.notes = {"12 points were cut to max_shift_mm", "<script>alert(1)</script>"};
  return data;
}

nlohmann::json data_of(const std::string& page) {
  const std::string open = "id=\"data\">";
  const std::size_t from = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(HtmlReport, NeedsNoNetwork) {
  const std::string page = html_report(example());
  for (const char* word : {"http://", "https://", "src=", "@import", "url("})
    EXPECT_EQ(page.find(word), std::string::npos) << word;
}

TEST(HtmlReport, IsTheSameForTheSameData) { EXPECT_EQ(html_report(example()), html_report(example())); }

TEST(HtmlReport, ShowsTextAsText) {
  const std::string page = html_report(example());
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_NE(page.find("<li>&lt;script&gt;alert(1)&lt;/script&gt;</li>"), std::string::npos);
}

TEST(HtmlReport, ListsEveryFigure) {
  const std::string page = html_report(example());
  EXPECT_NE(page.find("<tr><td>95 % of the form error</td><td>24.3</td><td>1.2</td><td>µm</td></tr>"),
            std::string::npos);
  EXPECT_NE(page.find("<tr><td>points</td><td>900</td><td></td><td></td></tr>"), std::string::npos);
  EXPECT_NE(page.find("<tr><td>as given</td><td>24.31</td><td>12.00</td><td>−31.0</td><td>30.0</td><td>0.0</td></tr>"),
            std::string::npos);
}

TEST(HtmlReport, SharesThePlacesOfTwoMapsOfTheSamePoints) {
  const auto data = data_of(html_report(example()));
  ASSERT_EQ(data["maps"].size(), 2u);
  EXPECT_TRUE(data["maps"][0].contains("xyz"));
  EXPECT_FALSE(data["maps"][1].contains("xyz"));
  auto moved = example();
  moved.after[5].x += 0.01;
  EXPECT_TRUE(data_of(html_report(moved))["maps"][1].contains("xyz"));
}

TEST(HtmlReport, TakesRoundScalesThatHoldTheErrors) {
  const auto data = data_of(html_report(example()));
  EXPECT_EQ(data["scales"], (std::vector<double>{40, 2}));
}

TEST(HtmlReport, CountsTheWholeAreaInTheHistogram) {
  const auto data = data_of(html_report(example()));
  for (const char* which : {"before", "after"}) {
    double sum = 0;
    for (const double share : data["histogram"][which]) sum += share;
    EXPECT_NEAR(sum, 100, 0.05) << which;  // each bin is rounded to 0.001
  }
}

TEST(HtmlReport, SaysWhenPointsWereLeftOut) {
  const std::string page = html_report(example(), {.most_points = 300, .most_feed_samples = 300});
  EXPECT_NE(page.find("Drawn are about 300 of the 900 points: of each run of neighbours the first and those with the "
                      "least and the greatest error."),
            std::string::npos);
  EXPECT_EQ(html_report(example()).find("Drawn are about"), std::string::npos);
}

TEST(HtmlReport, IsAPageWithoutAnyData) {
  const std::string page = html_report({});
  EXPECT_NE(page.find("</html>"), std::string::npos);
  EXPECT_EQ(page.find("<canvas"), std::string::npos);
}

TEST(HtmlReport, IsWrittenWhole) {
  const tests::TempFolder folder;
  write_html_report(folder / "r.html", example());
  EXPECT_EQ(tests::file_text(folder / "r.html"), html_report(example()));
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html.part"));
}

}  // namespace
}  // namespace camber::report
