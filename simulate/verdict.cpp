#include "simulate/verdict.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "simulate/setup_checks.h"

namespace camber::simulate {
namespace {

std::string slender_sentence(const machine::Job& job, int number) {
  const machine::Tool& tool = job.tools.at(number);
  return fmt::format(
      "T{} with overhang_mm = {:g} is {:.1f} times as long as its diameter; the model covers up to {:g} times: no "
      "figures",
      number, tool.overhang_mm, slenderness(tool), kMaxSlenderness);
}

std::string deflection_sentence(const SimulatedProgram& program, const Prediction& p) {
  constexpr std::size_t kNamed = 5;
  const std::vector<std::size_t> lines = lines_beyond_model(program, p);
  return fmt::format(
      "in {} tooth passings the tool deflects further than the model covers, by up to {:.0f} um where {:.0f} um are "
      "covered, in line{} {}{}: no figures; a shorter or thicker tool or a smaller cut was expected",
      p.cut.beyond, 1000 * p.cut.deflection_max_mm, 1000 * p.cut.deflection_limit_mm, lines.size() > 1 ? "s" : "",
      fmt::join(std::span(lines).first(std::min(lines.size(), kNamed)), ", "),
      lines.size() > kNamed ? fmt::format(" and {} more", lines.size() - kNamed) : "");
}

}  // namespace

double imbalance(double chip_mm3, double stock_mm3, double voxel_mm) {
  constexpr double kVoxels = 1000;
  if (std::max(chip_mm3, stock_mm3) < kVoxels * voxel_mm * voxel_mm * voxel_mm) return 0;
  return stock_mm3 > 0 ? chip_mm3 / stock_mm3 - 1 : 1;
}

bool beyond_model(const Prediction& p) { return p.cut.beyond > 0 || !p.slender_tools.empty(); }

std::vector<std::size_t> lines_beyond_model(const SimulatedProgram& program, const Prediction& p) {
  std::vector<std::size_t> lines;
  for (const std::uint32_t move : p.cut.beyond_moves) lines.push_back(program.moves.moves[move].block + 1);
  std::ranges::sort(lines);
  const auto again = std::ranges::unique(lines);
  lines.erase(again.begin(), again.end());
  return lines;
}

std::string imbalance_sentence(double chip_mm3, double stock_mm3) {
  return fmt::format(
      "the chips add up to {:.3f} mm3, but the stock loses {:.3f} mm3; no more than {:g} % between them was expected, "
      "so "
      "the forces are uncertain (a smaller voxel_mm may help)",
      chip_mm3, stock_mm3, 100 * kMaxImbalance);
}

std::vector<std::string> doubts(const machine::Job& job, const SimulatedProgram& program, const Prediction& p) {
  std::vector<std::string> out;
  for (const int tool : p.slender_tools) out.push_back(slender_sentence(job, tool));
  if (p.cut.beyond > 0) out.push_back(deflection_sentence(program, p));
  if (std::abs(imbalance(p.cut.chip_mm3, p.cut.stock_mm3, job.simulation.voxel_mm)) > kMaxImbalance)
    out.push_back(imbalance_sentence(p.cut.chip_mm3, p.cut.stock_mm3));
  if (p.surface.empty() && p.holes.surface_mm2 <= 0)
    out.push_back(
        "the program leaves no surface in the stock, so there is no form error to judge; a stock of which material "
        "remains was expected");
  return out;
}

}  // namespace camber::simulate
