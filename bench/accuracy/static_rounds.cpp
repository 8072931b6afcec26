// Readings that the static solution takes: slots and shoulders of stiff and slender tools, both laws, and a tool that
// is pulled into its cut.
#include <cmath>
#include <cstdio>
#include <ctime>

#include "simulate/cut.h"
#include "tests/support/cutting.h"

using namespace camber;
using testing::add_row;
using testing::make_box;
using testing::make_tool;

namespace {

struct Tool {
  const char* name;
  machine::ToolType type;
  double diameter, overhang, young;
};

void row(const Tool& t, bool slot, double depth, const char* law, const machine::Material& material) {
  auto tool = make_tool(t.type, t.diameter, 2, 30);
  tool.overhang_mm = t.overhang;
  tool.youngs_modulus_MPa = t.young;
  const double r = t.diameter / 2;
  // A ball is narrower than its diameter at the top of what it cuts.
  const double half = t.type == machine::ToolType::ball ? std::sqrt(depth * (t.diameter - depth)) : r;
  auto stock = make_box({0, slot ? -r - 1 : half - 0.4, -depth - 0.7}, {6, r + 1.5, 0}, 0.1);
  std::vector<removal::Stamp> stamps;
  add_row(stamps, {-r - 0.1, 0, -depth}, {6 + r, 0, -depth}, 0.05);
  simulate::CutOptions options;
  options.envelope_step_mm = 0.06;
  const std::clock_t begin = std::clock();
  const auto result = simulate::cut(stock, tool, material, stamps, {}, 0, options);
  std::printf("%-20s %-8s %g mm %-8s rounds %2d unsettled %zu, chips/stock %.4f, %.2f s of processor\n", t.name,
              slot ? "slot" : "shoulder", depth, law, result.rounds_max, result.unsettled,
              result.chip_mm3 / result.stock_mm3, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  std::fflush(stdout);
}

}  // namespace

int main() {
  const machine::Material linear{1860, 700, 0, 15, 15, 0}, pulling{1860, -900, 0, 15, 15, 0};
  machine::Material kienzle;
  kienzle.law = machine::ForceLaw::kienzle;
  kienzle.kc1_1_MPa = 1410, kienzle.mc = 0.128, kienzle.kr1_1_MPa = 564, kienzle.mr = 0.128;
  const Tool slender{"flat D6 HSS 32", machine::ToolType::flat, 6, 32, 210000};
  for (const Tool& t : {Tool{"ball D6 carbide 40", machine::ToolType::ball, 6, 40, 600000},
                        Tool{"ball D6 HSS 32", machine::ToolType::ball, 6, 32, 210000}, slender,
                        Tool{"flat D10 carbide 40", machine::ToolType::flat, 10, 40, 600000}})
    for (const bool slot : {true, false}) {
      row(t, slot, slot ? 0.3 : 0.5, "linear", linear);
      row(t, slot, slot ? 0.3 : 0.5, "Kienzle", kienzle);
    }
  for (const double depth : {1.0, 3.0}) {
    row(slender, true, depth, "linear", linear);
    row(slender, true, depth, "Kienzle", kienzle);
  }
  row(slender, true, 3, "pulling", pulling);
}
