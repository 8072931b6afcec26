// camber copy J.toml -o OUT.nc [--stream S.csv] [--stock OUT.vdb] [--log LOG.csv] [--hardness REGIONS.csv]
// [--report R.html] [--json R.json]
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "camber/copy.h"
#include "camber/job.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "cli/outputs.h"
#include "cli/progress.h"

namespace camber::cli {
namespace {

struct CopyArguments {
  std::string job;
  std::string output;
  std::string stream;  ///< empty: none
  std::string json;    ///< empty: none
  std::string log;     ///< changes of feed and depths; empty: none
  std::string report;  ///< empty: none
  CopyOptions options{};
};

/// A row a tick, written as they come.
class StreamWriter {
 public:
  explicit StreamWriter(const std::string& path) : file_(path) {
    file_.stream() << "t_s,x_mm,y_mm,z_mm,feed_mm_per_min,load_N\n";
  }
  void add(const CopyTick& t) {
    file_.stream() << fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.1f},{:.1f}\n", t.t_s, t.x_mm, t.y_mm, t.z_mm,
                                  t.feed_mm_per_min, t.load_N);
  }
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
};

/// Throws InputError. Returns kDone.
int run_copy(const CopyArguments& arguments, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  CopyOptions asked = arguments.options;
  const Job job = read_unprogrammed_job(arguments.job);
  std::vector<std::string> inputs = job.files();
  std::erase(inputs, job.program_path());  // which may be the one that is made
  inputs.push_back(asked.hardness);
  check_outputs({arguments.output, arguments.stream, asked.stock, arguments.log, arguments.report, arguments.json},
                inputs);
  std::optional<StreamWriter> stream;
  if (!arguments.stream.empty()) {
    stream.emplace(arguments.stream);
    asked.stream = [&](const CopyTick& t) { stream->add(t); };
  }
  asked.page = !arguments.report.empty();
  asked.output = arguments.output;
  const CopyResult result = copy(arguments.job, asked, run_options(progress, options));
  Diagnostics failed;
  try_to_write([&] { write_file(arguments.output, result.program); }, failed);
  if (stream) try_to_write([&] { stream->commit(); }, failed);
  if (!arguments.log.empty()) try_to_write([&] { write_file(arguments.log, result.log); }, failed);
  if (!arguments.report.empty()) try_to_write([&] { write_file(arguments.report, result.page); }, failed);
  if (!arguments.json.empty()) try_to_write([&] { write_file(arguments.json, result.json); }, failed);
  if (!options.quiet) fmt::print("{}", result.printed);
  failed.throw_if_errors();
  return kDone;
}

int print_effective_copy_job(const std::string& path, const GlobalOptions& options) {
  ProgressLine progress(options, "reading");
  fmt::print("{}", copy_job_toml(path, run_options(progress, options)));
  return kDone;
}

}  // namespace

void add_copy_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("copy", "make paths from the part's model while the tool cuts");
  auto arguments = std::make_shared<CopyArguments>();
  command->add_option("job", arguments->job, "job.toml with [part] mesh and [[copy]]")->required()->type_name("J.toml");
  command->add_option("-o,--output", arguments->output, "the program")->required()->type_name("OUT.nc");
  command->add_option("--stream", arguments->stream, "positions, feed and load, a row a tick of the control")
      ->type_name("S.csv");
  command->add_option("--stock", arguments->options.stock, "the stock that is left")->type_name("OUT.vdb");
  command
      ->add_option("--stop-after", arguments->options.stop_after_s,
                   "stop after this time, s, and lift the tool; with --stock the run can be taken up again")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_option("--log", arguments->log, "changes of feed and depths: time, place, reason")->type_name("LOG.csv");
  command
      ->add_option("--hardness", arguments->options.hardness,
                   "boxes in which the material is harder by a factor: the cut feels it, the rule has to find out")
      ->type_name("REGIONS.csv");
  command->add_option("--report", arguments->report, "page with the path, loads and feeds")->type_name("R.html");
  command->add_option("--json", arguments->json, "the figures")->type_name("R.json");
  command->callback([arguments, &options, &chosen] {
    chosen = [arguments, &options] {
      if (options.effective_config) return print_effective_copy_job(arguments->job, options);
      return run_copy(*arguments, options);
    };
  });
}

}  // namespace camber::cli
