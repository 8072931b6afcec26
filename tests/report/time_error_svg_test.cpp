#include "report/histogram_svg.h"

#include <gtest/gtest.h>

#include "report/figures_json.h"

namespace camber::report {
namespace {

compensate::Round round(double time_s, double p95_um, std::size_t slowed, std::size_t repeated) {
  compensate::Round out;
  out.machine_time_s = time_s;
  out.error_um.p95 = p95_um;
  out.slowed = slowed;
  out.repeated = repeated;
  return out;
}

compensate::CompensationResult example() {
  compensate::CompensationResult c;
  c.figures.feed_before.time_s = 10;
  c.rounds = {round(10, 50, 0, 0), round(10, 8, 0, 0), round(11, 6, 4, 0), round(20, 3, 0, 2)};
  c.time_points = {{0, 1}, {10, 2}, {100, 3}};
  c.best = 3;
  return c;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t out = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++out;
  return out;
}

TEST(TimeErrorSvg, DrawsTheTimesAndMarksTheEmittedProgram) {
  const std::string svg = time_error_svg(example(), 5);
  EXPECT_EQ(count(svg, "r=\"2\""), 3u) << "the given program's 50 um would flatten the rest";
  EXPECT_EQ(count(svg, "r=\"4\""), 3u);
  EXPECT_EQ(count(svg, "r=\"4\" stroke=\"#1668b8\" fill=\"#fff\""), 2u) << "cut once";
  EXPECT_EQ(count(svg, "r=\"8\""), 1u);
  EXPECT_NE(svg.find("emitted: round 3: 20.0 s, 3.00 µm, 0 changes of feed, 2 runs cut twice"), std::string::npos);
  EXPECT_EQ(count(svg, "stroke-dasharray"), 1u) << "the tolerance";
  // 0 to 8 um are 188 px, 10 to 20 s are 494: a lower error is a lower place, more time is farther right.
  EXPECT_NE(svg.find("d=\"M50.0 28.0L99.4 75.0L544.0 145.5\""), std::string::npos) << svg;
}

TEST(TimeErrorSvg, IsEmptyWithoutALeverThatTakesTime) {
  compensate::CompensationResult c = example();
  c.time_points.clear();
  EXPECT_EQ(time_error_svg(c, 5), "");
}

TEST(CompensateText, ListsMachineTimeAgainstErrorAndWhatIsCutTwice) {
  compensate::CompensationResult c = example();
  c.passes.runs = {{9, 14}, {19, 23}};
  c.passes.allowance_mm = 0.025;
  const std::string text = compensate_text(c, 0);
  EXPECT_NE(text.find("extra time allowed    machine time, s        p95, um   rms, um   changes of feed   cut twice\n"
                      "               0 %        10.0 (  +0.0 %)      8.00      0.00                 0           0\n"
                      "              10 %        11.0 ( +10.0 %)      6.00      0.00                 4           0\n"
                      "             100 %        20.0 (+100.0 %)      3.00      0.00                 0           2  <\n"
                      "cut twice, the first cut leaving 25 um: lines 9 to 14, 19 to 23 of the given program\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace camber::report
