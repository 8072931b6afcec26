// What a path that is not upright costs: the same path, upright and by the code for any pose (the tool turned about its
// axis by nothing that counts).
//
//     bench/tilted_bench [CUTTER]
#include <ctime>

#include <cstdio>
#include <string_view>
#include <vector>

#include "removal/engagement.h"
#include "simulate/cut.h"

namespace {

using namespace camber;

constexpr double kVoxel = 0.1;

double processor_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

machine::Tool tool_of(machine::ToolType type) {
  machine::Tool tool;
  tool.number = 1;
  tool.type = type;
  tool.diameter_mm = 6;
  tool.corner_radius_mm = type == machine::ToolType::bull ? 1 : 0;
  tool.taper_rad = type == machine::ToolType::tapered_ball ? 0.1 : 0;
  tool.flutes = 2;
  tool.helix_rad = 0.5;
  tool.overhang_mm = 40;
  return tool;
}

/// Rows 0.3 mm apart on a plane that climbs, 0.1 mm a tooth.
std::vector<removal::Stamp> rows() {
  std::vector<removal::Stamp> out;
  for (double y = 0; y < 1.2; y += 0.3)
    for (int i = 0; i <= 140; ++i) {
      removal::Stamp s;
      s.pose.tip_mm = {15 - 0.1 * i, y, -0.3 + 0.1 * y};
      s.feed_per_tooth_mm = {-0.1, 0, 0};
      s.first = i == 0;
      out.push_back(s);
    }
  return out;
}

struct Seconds {
  double carve, rigid, static_;
};

Seconds cut(const machine::Tool& tool, double spin_rad) {
  auto stamps = rows();
  for (auto& s : stamps) s.pose.spin_rad = spin_rad;
  const Vec3 lo(0, -4, -3), hi(14, 7, 0.05);
  const removal::Stock blank([&](const Vec3& p) { return removal::box_distance_mm(p, lo, hi); }, lo, hi, kVoxel, 5);
  const machine::Material material{2000, 700, 0, 15, 15, 0};
  const auto time = [&](auto work) {
    removal::Stock stock(blank);
    const double from = processor_s();
    work(stock);
    return processor_s() - from;
  };
  const auto cut_in = [&](machine::Coupling coupling) {
    return time([&](removal::Stock& stock) {
      simulate::CutOptions options;
      options.coupling = coupling;
      simulate::cut(stock, tool, material, stamps, {}, 0, options);
    });
  };
  return {time([&](removal::Stock& stock) { simulate::sweep(stock, tool, stamps, 0, 0); }),
          cut_in(machine::Coupling::rigid), cut_in(machine::Coupling::static_)};
}

}  // namespace

int main(int argc, char** argv) {
  const double passings = static_cast<double>(rows().size());
  std::printf("passings a second of processor, upright / any pose (ratio)\n%-13s %24s %24s %24s\n", "cutter", "carving",
              "rigid", "static");
  for (const auto& [type, name] : {std::pair{machine::ToolType::ball, "ball"},
                                   {machine::ToolType::flat, "flat"},
                                   {machine::ToolType::bull, "bull"},
                                   {machine::ToolType::tapered_ball, "tapered ball"}}) {
    if (argc > 1 && std::string_view(argv[1]) != name) continue;
    const machine::Tool tool = tool_of(type);
    const Seconds upright = cut(tool, 0), any = cut(tool, 1e-9);
    std::printf("%-13s", name);
    for (const auto& [a, b] :
         {std::pair{upright.carve, any.carve}, {upright.rigid, any.rigid}, {upright.static_, any.static_}})
      std::printf(" %9.0f /%7.0f (%4.2f)", passings / a, passings / b, a / b);
    std::printf("\n");
    std::fflush(stdout);
  }
}
