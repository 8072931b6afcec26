#include "report/fit_summary.h"

#include <gtest/gtest.h>

namespace camber::report {
namespace {

calib::FitFeedResult fitted() {
  calib::FitFeedResult fit;
  fit.message = "converged";
  fit.law = "angle";
  fit.laws = {{"angle", 0.21, 1.5}, {"radius", 3.4, 9}};
  fit.parameters = {{"axis.x.acceleration_mm_per_s2", 601.5, "mm/s2", 2.7, "", true, 9, 500.0},
                    {"control.block_time_ms", machine::kNoLimit, "ms", std::nullopt, "not determined", false}};
  fit.held_out = {.parts = 7, .part_time_percent = 0.19, .speed_rms_percent = 1.25};
  fit.promise = calib::TimePromise{-0.3, 0.4};
  calib::RunAccuracy run{"a<b.nc", {}};
  run.accuracy.time_trace_s = 10, run.accuracy.time_model_s = 10.1, run.accuracy.time_error_percent = 1;
  for (std::uint32_t i = 0; i < 5; ++i) {
    calib::PartAccuracy part{{10 * i + 1, 10 * i + 9, 25}, 2.0, 2.02, 1.0 + i, 3};
    part.speeds = {{10, 25, 10}, {12, 24, 12}};
    run.accuracy.parts.push_back(part);
  }
  run.accuracy.by_state[0] = {100, 4};
  run.accuracy.by_state[3] = {300, 1};
  run.accuracy.by_axis[0] = {400, 2};
  fit.runs = {run, run};
  fit.runs[1].accuracy.by_state[0] = {300, 2};
  return fit;
}

TEST(FitFeedPage, HasFiguresResidualsAndParameters) {
  const std::string page = fit_feed_page(fitted());
  for (const char* text :
       {"<div class=\"name\">time, held out</div><div class=\"value\">0.19 %</div>",
        "<div class=\"value\">−0.30 to 0.40 %</div>", "<h2>a&lt;b.nc</h2>",
        "<td>axis.x.acceleration_mm_per_s2</td><td>601.5</td><td>mm/s2</td><td>2.7</td><td>9</td><td>500</td>",
        "<td>control.block_time_ms</td><td>no limit</td>", "<td>radius</td><td>3.400 %</td>",
        // 100 stations of 4 % and 300 of 2 %; two runs with 300 of 1 %: 1000 in all.
        "<td>corner</td><td>40.0 %</td><td>2.65 %</td>", "<td>programmed feed</td><td>60.0 %</td><td>1.00 %</td>",
        "<td>X</td><td>2.00 %</td>"})
    EXPECT_NE(page.find(text), std::string::npos) << text << '\n' << page;
}

TEST(FitFeedPage, DrawsThePartsWithTheLargestErrors) {
  const std::string page = fit_feed_page(fitted());
  for (const char* drawn : {"Speed along lines 41-49", "Speed along lines 31-39", "Speed along lines 21-29"})
    EXPECT_NE(page.find(drawn), std::string::npos) << drawn;
  EXPECT_EQ(page.find("Speed along lines 11-19"), std::string::npos);
  EXPECT_NE(page.find("<td>1-9</td><td>1500</td><td>2.000</td><td>2.020</td><td>1.00 %</td><td>1.00 %</td>"),
            std::string::npos);
}

TEST(FitFeedPage, DrawsNoSpeedsThatWereNotKept) {
  EXPECT_EQ(part_speed_svg(calib::PartAccuracy{}), "");
  EXPECT_EQ(fit_feed_page({}).find("Residuals"), std::string::npos);
}

}  // namespace
}  // namespace camber::report
