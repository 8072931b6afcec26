#include "cli/feed_command.h"

#include <fmt/format.h>

#include <memory>

#include "api/commands/feed.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/feed_page.h"
#include "cli/progress.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/timed_path.h"
#include "kinematics/joint_map.h"
#include "machine/assumptions.h"
#include "machine/machine.h"
#include "nc/language.h"
#include "nc/program.h"
#include "report/timed_track.h"

namespace camber::cli {

int run_feed(const FeedArguments& arguments, const GlobalOptions& options) {
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const machine::Machine machine = machine::read_machine(arguments.machine, diagnostics);
  const nc::Program program =
      nc::read_program(SourceText::read(arguments.program), nc::language_asked_for(arguments.interpreter), diagnostics);
  const nc::Interpretation moves =
      api::moves_of_feed(program, machine, arguments.interpreter, arguments.output, diagnostics);
  progress.clear();
  if (!arguments.report.empty() && !kinematics::has_rotary_motion(moves, machine))
    fail_on_file(arguments.program,
                 "turns no rotary axis of the machine, and the page of feed shows those; camber check --report shows "
                 "programs of three axes",
                 "no-rotary-motion");
  settle(diagnostics, options);
  print_translation(machine.translation, options);

  std::unique_ptr<feedmodel::FeedCsv> csv;
  if (!arguments.output.empty())
    csv = std::make_unique<feedmodel::FeedCsv>(moves, arguments.output, api::rotary_columns(moves, machine));
  report::TimedTrack track(machine, moves);
  const feedmodel::FeedSummary summary = api::predict_feed(
      moves, machine,
      [&](std::span<const feedmodel::TimedSample> samples, std::span<const feedmodel::JointSample> joints) {
        if (csv && joints.empty()) csv->write(samples);
        if (csv && !joints.empty()) csv->write(samples, joints);
        if (!arguments.report.empty()) track.add(samples, joints);
        if (!samples.empty())
          progress.show("timing", static_cast<double>(samples.back().move) / static_cast<double>(moves.moves.size()));
      });
  if (csv) csv->commit();
  progress.clear();

  if (!options.quiet)
    fmt::print("{}time          {:.3f} s\ncutting time  {:.3f} s\nblocks        {}\n",
               machine::assumptions_text(machine::assumptions(machine)), summary.time_s, summary.cutting_time_s,
               summary.blocks);
  if (!options.quiet && summary.contour) fmt::print("{}", api::contour_text(*summary.contour));
  if (!arguments.json.empty())
    write_file(arguments.json, machine::with_assumptions(api::feed_json(summary), machine::assumptions(machine)));
  if (!arguments.report.empty())
    write_file(arguments.report,
               feed_page({arguments.program, arguments.machine, summary, track.take()}, moves, machine, diagnostics));
  return kDone;
}

}  // namespace camber::cli
