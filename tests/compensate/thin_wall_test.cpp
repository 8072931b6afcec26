// A wall that bends under the tool: what shifts and second cuts leave of it, as the sample is shipped.
#include <gtest/gtest.h>

#include "compensate/compensate_path.h"
#include "compensate/verify_program.h"
#include "machine/job_file.h"
#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::compensate {
namespace {

TEST(CompensateThinWallSlow, FurtherCutsTakeTheErrorOffTheSample) {
  Diagnostics diagnostics;
  const machine::Job job = machine::read_job(CAMBER_SOURCE_DIR "/samples/22-thin-wall/job.toml", diagnostics);
  const CompensationResult c = compensate(job, diagnostics, {});
  const double given_um = c.figures.before_um.p95;
  EXPECT_NEAR(given_um, 47.4, 0.5);
  ASSERT_EQ(c.time_points.size(), 2u);
  EXPECT_LT(c.rounds[c.time_points[0].round].error_um.p95, 0.45 * given_um) << "shifts alone";
  EXPECT_LT(c.figures.after_um.p95, 0.15 * given_um);
  EXPECT_LT(c.safety.after.gouge_depth_p999_um, 12);
  EXPECT_LT(c.figures.feed_after.time_s, 2.003 * c.figures.feed_before.time_s) << "the job's budget";
  ASSERT_FALSE(c.passes.runs.empty());
  EXPECT_EQ(c.passes.runs.front().first_line, 10u) << "the highest level yields most";
  EXPECT_GE(c.passes.runs.front().cuts, c.passes.runs.back().cuts);

  // The rounds keep the part's compliance; here it is solved along the emitted program.
  const tests::TempFolder folder;
  const Record record = make_record(job, c, folder.write("wall.nc", c.emitted.text));
  const machine::Job judging = machine::read_job(folder.write("wall.verify.toml", record.job), diagnostics);
  const Verification found = verify(judging, record, diagnostics, {});
  EXPECT_NEAR(found.plain.error_um.p95, c.figures.after_um.p95, 0.03 * c.figures.after_um.p95);
}

}  // namespace
}  // namespace camber::compensate
