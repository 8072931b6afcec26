// Time of one tooth passing in simulate/load_probe, over very many, on one core: what a tick of copy milling spends on
// its load. Prints a row every fifty thousand passings: mean, 99th and 99.99th percentile and worst in milliseconds of
// processor time, and the memory that the process holds. Whole ticks: copy_tick_bench.
//
// The first look at the stock, which reads all tiles around the tool, comes before the clock starts.
//
//   load_tick_bench [PASSINGS [DIAMETER_mm [VOXEL_mm [LOOKS [ENVELOPE_mm [ROTATION_deg]]]]]]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <tbb/global_control.h>

#include "bench/copy/process_figures.h"
#include "simulate/load_probe.h"

namespace {

using camber::Vec3;
using camber::removal::Stamp;

/// Levels of rows to and fro over a block; when it is through, all begins again a little lower.
class Rows {
 public:
  Rows(double diameter, double side, double feed) : radial_(0.4 * diameter), side_(side), feed_(feed), z_(-2) {}
  Stamp next() {
    Stamp s;
    s.first = first_;
    first_ = false;
    s.feed_per_tooth_mm = forth_ ? Vec3(feed_, 0, 0) : Vec3(-feed_, 0, 0);
    s.pose.tip_mm = {x_, y_, z_};
    x_ += s.feed_per_tooth_mm.x();
    if (x_ > side_ + radial_ || x_ < -radial_) {
      forth_ = !forth_, first_ = true, y_ += radial_;
      if (y_ > side_) y_ = 0, z_ -= 2;
      if (z_ < kLowest) z_ = -2;
    }
    return s;
  }
  static constexpr double kLowest = -30;

 private:
  double radial_, side_, feed_, z_, x_ = 0, y_ = 0;
  bool forth_ = true, first_ = true;
};

}  // namespace

int main(int argc, char** argv) {
  const auto argument = [&](int i, double otherwise) { return i < argc ? std::atof(argv[i]) : otherwise; };
  const auto passings = static_cast<long>(argument(1, 1e6));
  const double diameter = argument(2, 10), voxel = argument(3, 0.2);
  const int looks = static_cast<int>(argument(4, 0));
  const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
  camber::machine::Tool tool;
  tool.type = camber::machine::ToolType::bull;
  tool.diameter_mm = diameter, tool.corner_radius_mm = 1, tool.flutes = 4, tool.helix_rad = 0.5, tool.overhang_mm = 50;
  camber::simulate::LoadProbeOptions options;
  options.envelope_step_mm = argument(5, 0.2), options.rotation_step_rad = argument(6, 2) * camber::kPi / 180;
  const camber::machine::Material material{1800, 600, 300, 20, 25, 2};
  const double side = 120;
  const Vec3 lo(0, 0, -40), hi(side, side, 0);
  camber::removal::Stock stock([&](const Vec3& p) { return camber::removal::box_distance_mm(p, lo, hi); }, lo, hi,
                               voxel, 4);
  const camber::removal::TipBox box{{-diameter, -diameter, Rows::kLowest - 2}, {side + diameter, side + diameter, 0}};
  camber::simulate::LoadProbe probe(stock, tool, material, box, options);
  probe.look(Rows(diameter, side, 0.08).next());
  Rows rows(diameter, side, 0.08);
  std::vector<double> ms;
  double worst_of_all = 0, sum_of_all = 0;
  std::printf("%10s %9s %9s %9s %9s %9s %12s\n", "passings", "mean_ms", "p99_ms", "p9999_ms", "worst_ms", "over_half",
              "resident_MB");
  constexpr std::size_t kARow = 50000;
  for (long k = 0; k < passings; ++k) {
    const Stamp stamp = rows.next();
    const double before = processor_ms();
    for (int l = 1; l <= looks; ++l) {
      Stamp ahead = stamp;
      ahead.pose.tip_mm += 10.0 * l * stamp.feed_per_tooth_mm;
      if (box.contains(ahead.pose.tip_mm)) probe.look(ahead);
    }
    probe.append({&stamp, 1});
    ms.push_back(processor_ms() - before);
    if (ms.size() < kARow && k + 1 < passings) continue;
    double sum = 0;
    for (const double t : ms) sum += t;
    std::ranges::sort(ms);
    const auto over = ms.end() - std::ranges::lower_bound(ms, 0.5);
    std::printf("%10ld %9.4f %9.4f %9.4f %9.4f %9ld %12.1f\n", k + 1, sum / static_cast<double>(ms.size()),
                ms[ms.size() * 99 / 100], ms[ms.size() * 9999 / 10000], ms.back(), static_cast<long>(over),
                resident_MB());
    std::fflush(stdout);
    worst_of_all = std::max(worst_of_all, ms.back());
    sum_of_all += sum;
    ms.clear();
  }
  std::printf("%10ld %9.4f %9s %9s %9.4f\n", passings, sum_of_all / static_cast<double>(passings), "", "",
              worst_of_all);
}
