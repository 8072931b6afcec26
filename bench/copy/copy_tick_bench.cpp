// Processor time of whole ticks of `camber copy`, one core: motion, tooth passings with their loads, the look ahead,
// the rule, and the heights that the planner keeps. The jobs are run one after another, again and again, until so many
// ticks are done. Prints a row every hundred thousand ticks: mean, 99th and 99.99th percentile and worst, ticks of more
// than half a millisecond, the longest planning between two ticks (the tool is at rest then), and the memory that the
// process holds.
//
//   copy_tick_bench TICKS JOB.toml...
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include <tbb/global_control.h>

#include "bench/copy/process_figures.h"
#include "copymill/copy_milling.h"
#include "machine/job_file.h"

namespace {

/// Of the ticks so far, a row at a time.
class Table {
 public:
  Table() {
    std::printf("%10s %9s %9s %9s %9s %9s %11s %12s\n", "ticks", "mean_ms", "p99_ms", "p9999_ms", "worst_ms",
                "over_half", "planning_ms", "resident_MB");
  }
  /// `between_ms`: since the last tick ended.
  void add(double ms, double between_ms) {
    row_.push_back(static_cast<float>(ms)), all_.push_back(static_cast<float>(ms));
    planning_ = std::max(planning_, between_ms), planning_of_all_ = std::max(planning_of_all_, between_ms);
    constexpr std::size_t kARow = 100000;
    if (row_.size() < kARow) return;
    print(row_, planning_);
    row_.clear(), planning_ = 0;
  }
  void finish() { print(all_, planning_of_all_); }
  std::size_t ticks() const { return all_.size(); }

 private:
  void print(std::vector<float>& ms, double planning) const {
    if (ms.empty()) return;
    double sum = 0;
    for (const float t : ms) sum += t;
    std::ranges::sort(ms);
    const auto over = ms.end() - std::ranges::upper_bound(ms, 0.5F);
    std::printf("%10zu %9.4f %9.4f %9.4f %9.4f %9ld %11.1f %12.1f\n", all_.size(), sum / static_cast<double>(ms.size()),
                static_cast<double>(ms[ms.size() * 99 / 100]), static_cast<double>(ms[ms.size() * 9999 / 10000]),
                static_cast<double>(ms.back()), static_cast<long>(over), planning, resident_MB());
    std::fflush(stdout);
  }

  std::vector<float> row_, all_;
  double planning_ = 0, planning_of_all_ = 0;
};

void run(Table& table, std::size_t ticks, const char* path) {
  camber::Diagnostics diagnostics;
  const camber::machine::Job job = camber::machine::read_unprogrammed_job(path, diagnostics);
  const auto operations = camber::machine::read_copy_operations(path, job, diagnostics);
  diagnostics.throw_if_errors();
  camber::copymill::CopyOptions options;
  double ended = 0;
  options.stop_after_s = static_cast<double>(ticks - table.ticks()) * job.machine.control.period_s;
  options.stream = [&](const camber::copymill::Tick& t) {
    const double now = processor_ms();
    table.add(t.processor_ms, ended > 0 ? now - ended - t.processor_ms : 0);
    ended = processor_ms();
  };
  camber::copymill::copy(job, operations, options, diagnostics);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "copy_tick_bench TICKS JOB.toml...\n");
    return 2;
  }
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  const auto ticks = static_cast<std::size_t>(std::atof(argv[1]));
  try {
    Table table;
    while (table.ticks() < ticks)
      for (int k = 2; k < argc && table.ticks() < ticks; ++k) run(table, ticks, argv[k]);
    table.finish();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "copy_tick_bench: %s\n", e.what());
    return 1;
  }
}
