// Feeds by load where rotary axes turn: the dome of samples/13-dome, by the tip and by positions of the axes.
#include <cmath>
#include <regex>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "adapt/adaptation.h"
#include "test_paths.h"

namespace camber::adapt {
namespace {

machine::Job dome_job(const std::string& name, double chip_mm, Diagnostics& diagnostics) {
  machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/13-dome/" + name, diagnostics);
  job.simulation.voxel_mm = 0.2;
  job.simulation.coupling = machine::Coupling::rigid;
  job.adapt.emplace();
  job.adapt->limits.chip_mm = chip_mm;
  job.adapt->lowest_feed_mm_per_s = 1;
  return job;
}

/// The text without its F words.
std::string without_feeds(const std::string& text) {
  static const std::regex feed(R"( ?F[0-9.]+)");
  return std::regex_replace(text, feed, "");
}

TEST(FiveAxisAdapt, KeepsALimitByTheTipAndByTheAxes) {
  constexpr double kThick_mm = 1;
  double limit_mm = 0;
  for (const char* name : {"job.toml", "job_axes.toml"}) {
    Diagnostics diagnostics;
    if (limit_mm == 0)
      limit_mm = 0.8 * adapt(dome_job(name, kThick_mm, diagnostics), diagnostics, {}).loads[0].max_before;
    const machine::Job job = dome_job(name, limit_mm, diagnostics);
    const AdaptResult r = adapt(job, diagnostics, {});
    ASSERT_EQ(r.loads.size(), 1u);
    EXPECT_GT(r.loads[0].max_before, 1.1 * limit_mm) << name;
    EXPECT_LT(r.loads[0].max_after, kOverLimit * limit_mm) << name;
    EXPECT_TRUE(r.good) << name;
    // Blocks that turn are never split: F words aside all are there, but for the plunge, which turns nothing.
    const SourceText given = SourceText::read(job.program), emitted("", r.text);
    std::set<std::string> lines;
    for (std::size_t line = 1; line <= emitted.line_count(); ++line)
      lines.insert(without_feeds(std::string(emitted.line(line))));
    int changed = 0;
    for (std::size_t line = 1; line <= given.line_count(); ++line)
      if (!lines.contains(without_feeds(std::string(given.line(line))))) ++changed;
    EXPECT_LE(changed, 1) << name;
    EXPECT_LE(emitted.line_count(), given.line_count() + 1) << name;
  }
}

}  // namespace
}  // namespace camber::adapt
