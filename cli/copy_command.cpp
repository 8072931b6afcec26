#include "cli/copy_command.h"

#include <chrono>
#include <optional>

#include <fmt/format.h>

#include "api/commands/copy.h"
#include "base/output_file.h"
#include "base/stage.h"
#include "base/units.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"
#include "machine/assumptions.h"
#include "report/copy_page.h"
#include "report/copy_summary.h"

namespace camber::cli {
namespace {

/// A row a tick, written as they come.
class StreamWriter {
 public:
  explicit StreamWriter(const std::string& path) : file_(path) {
    file_.stream() << "t_s,x_mm,y_mm,z_mm,feed_mm_per_min,load_N\n";
  }
  void add(const copymill::Tick& t) {
    file_.stream() << fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{:.1f}\n", t.t_s, t.tip_mm.x(), t.tip_mm.y(),
                                  t.tip_mm.z(), mm_per_min_from_mm_per_s(t.feed_mm_per_s), t.load_N);
  }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
};

std::vector<std::string> warnings_of(const Diagnostics& diagnostics) {
  std::vector<std::string> out;
  for (const Diagnostic& d : diagnostics.all()) out.push_back(to_string(d));
  return out;
}

}  // namespace

int run_copy(const CopyArguments& arguments, const GlobalOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  ProgressLine progress(options, "reading");
  const api::CopyJob job = api::read_copy_job(arguments.job, diagnostics);
  check_outputs({arguments.output, arguments.stream, arguments.stock, arguments.log, arguments.report, arguments.json},
                {job.job.path, job.job.machine_path, job.job.part.mesh, job.job.stock.mesh, job.job.stock.vdb,
                 arguments.hardness});
  const StageScope stages([&](const std::string& what, double share) { progress.show(what, share); });
  std::optional<StreamWriter> stream;
  copymill::CopyOptions copy_options;
  copy_options.stop_after_s = arguments.stop_after_s;
  if (!arguments.hardness.empty()) copy_options.regions = simulate::read_force_regions(arguments.hardness);
  if (!arguments.stream.empty()) stream.emplace(arguments.stream);
  report::TickPicture picture;
  copy_options.stream = [&](const copymill::Tick& t) {
    if (stream) stream->add(t);
    if (!arguments.report.empty()) picture.add(t);
  };
  const copymill::CopyResult result = api::copy_job(job, arguments.output, copy_options, diagnostics);
  progress.clear();
  settle(diagnostics, options);
  const double compute_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::vector<std::string> assumed = machine::assumptions(job.job);
  Diagnostics failed;
  try_to_write([&] { write_file(arguments.output, result.text); }, failed);
  if (stream) try_to_write([&] { stream->commit(); }, failed);
  if (!arguments.stock.empty()) try_to_write([&] { result.stock->save(arguments.stock); }, failed);
  if (!arguments.log.empty()) try_to_write([&] { write_file(arguments.log, report::copy_log_csv(result)); }, failed);
  if (!arguments.report.empty())
    try_to_write(
        [&] {
          write_file(arguments.report,
                     report::copy_page(result, picture, {arguments.job, job.job.part.mesh, arguments.output},
                                       warnings_of(diagnostics)));
        },
        failed);
  if (!arguments.json.empty())
    try_to_write(
        [&] { write_file(arguments.json, machine::with_assumptions(report::copy_json(result, compute_s), assumed)); },
        failed);
  if (!options.quiet) fmt::print("{}{}", machine::assumptions_text(assumed), report::copy_text(result, compute_s));
  failed.throw_if_errors();
  return kDone;
}

}  // namespace camber::cli
