// Rounds of the static solution: slots and shoulders of stiff and slender tools, both laws.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "deflection/cut.h"
#include "tests/support/cutting.h"

using namespace camber;
using testing::add_row;
using testing::make_box;
using testing::make_tool;

int main() {
  struct Tool {
    const char* name;
    machine::ToolType type;
    double diameter, overhang, young;
  };
  const machine::Material linear{1860, 700, 0, 15, 15, 0};
  machine::Material kienzle;
  kienzle.law = machine::ForceLaw::kienzle;
  kienzle.kc1_1_MPa = 1410, kienzle.mc = 0.128, kienzle.kr1_1_MPa = 564, kienzle.mr = 0.128;
  for (const Tool& t : {Tool{"ball D6 carbide 40", machine::ToolType::ball, 6, 40, 600000},
                        Tool{"ball D6 HSS 32", machine::ToolType::ball, 6, 32, 210000},
                        Tool{"flat D6 HSS 32", machine::ToolType::flat, 6, 32, 210000},
                        Tool{"flat D10 carbide 40", machine::ToolType::flat, 10, 40, 600000}})
    for (const bool slot : {true, false})
      for (const machine::Material* m : {&linear, static_cast<const machine::Material*>(&kienzle)}) {
        auto tool = make_tool(t.type, t.diameter, 2, 30);
        tool.overhang_mm = t.overhang;
        tool.youngs_modulus_MPa = t.young;
        const double depth = slot ? 0.3 : 0.5, r = t.diameter / 2;
        // A ball is narrower than its diameter at the top of what it cuts.
        const double half = t.type == machine::ToolType::ball ? std::sqrt(depth * (t.diameter - depth)) : r;
        auto stock = make_box({0, slot ? -r - 1 : half - 0.4, -depth - 0.7}, {6, r + 1.5, 0}, 0.1);
        std::vector<removal::Stamp> stamps;
        add_row(stamps, {-r - 0.1, 0, -depth}, {6 + r, 0, -depth}, 0.05);
        deflection::CutOptions options;
        options.envelope_step_mm = 0.06;
        const auto begin = std::chrono::steady_clock::now();
        const auto result = deflection::cut(stock, tool, *m, stamps, {}, 0, options);
        std::printf("%-20s %-8s %-8s rounds %2d unsettled %zu, chips/stock %.4f, %.1f s\n", t.name,
                    slot ? "slot" : "shoulder", m == &linear ? "linear" : "Kienzle", result.rounds_max,
                    result.unsettled, result.chip_mm3 / result.stock_mm3,
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
        std::fflush(stdout);
      }
}
