#include "simulate/verdict.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "simulate/validity.h"

namespace camber::simulate {
namespace {

/// "3.2 % of the surface and 1.5 % of the tooth passings are left out of the figures"; "no figures".
std::string left_out(const Prediction& p) {
  if (beyond_model(p) && forces_beyond_model(p)) return "no figures";
  const Validity& v = p.validity;
  if (v.surface_mm2 <= 0)
    return fmt::format("{:.2g} % of the tooth passings are in no figure", 100 * v.passing_fraction());
  return fmt::format("{:.2g} % of the surface and {:.2g} % of the tooth passings are in no figure",
                     100 * v.surface_fraction(), 100 * v.passing_fraction());
}

std::string deflection_sentence(const SimulatedProgram& program, const Prediction& p) {
  constexpr std::size_t kNamed = 5;
  const std::vector<std::size_t> lines = lines_of(program, p.cut.beyond_stamps);
  return fmt::format(
      "in {} tooth passings the tool deflects further than the model covers, by up to {:.0f} um where {:.0f} um are "
      "covered, in line{} {}{}: {}; a shorter or thicker tool or a smaller cut was expected",
      p.cut.beyond_stamps.size(), 1000 * p.cut.deflection_max_mm, 1000 * p.cut.deflection_limit_mm,
      lines.size() > 1 ? "s" : "", fmt::join(std::span(lines).first(std::min(lines.size(), kNamed)), ", "),
      lines.size() > kNamed ? fmt::format(" and {} more", lines.size() - kNamed) : "", left_out(p));
}

std::string chatter_doubt(const Prediction& p) {
  return fmt::format("in {} tooth passings the cut chatters: {}; a stable spindle speed or depth was expected",
                     p.chatter.invalid_stamps.size(), left_out(p));
}

}  // namespace

double imbalance(double chip_mm3, double stock_mm3, double voxel_mm) {
  constexpr double kVoxels = 1000;
  if (std::max(chip_mm3, stock_mm3) < kVoxels * voxel_mm * voxel_mm * voxel_mm) return 0;
  return stock_mm3 > 0 ? chip_mm3 / stock_mm3 - 1 : 1;
}

bool beyond_model(const Prediction& p) { return p.validity.surface_fraction() > kMaxInvalid; }
bool forces_beyond_model(const Prediction& p) { return p.validity.passing_fraction() > kMaxInvalid; }

const char* no_equilibrium_text(deflection::NoEquilibrium reason) {
  switch (reason) {
    case deflection::NoEquilibrium::pulled_in:
      return "the tool is pulled into its cut (the force grows faster with the chip than the tool is stiff)";
    case deflection::NoEquilibrium::pushed_out:
      return "the tool is pushed out of its cut by more than 0.5 mm";
    case deflection::NoEquilibrium::swings:
      break;
  }
  return "the tool swings between two deflections";
}

std::string no_rest_sentence(const SimulatedProgram& program, const NoRest& given_up) {
  return fmt::format(
      "the static deflection does not converge, from line {} on: {}; given up after {} of {} tooth passings; a shorter "
      "or thicker tool or a smaller cut was expected (or coupling = \"rigid\", which does not feed the deflection back "
      "into the chip)",
      program.moves_in_part().moves[given_up.move].block + 1, no_equilibrium_text(given_up.reason), given_up.unsettled,
      given_up.readings);
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
  if (!p.cut.beyond_stamps.empty()) out.push_back(deflection_sentence(program, p));
  if (!p.chatter.invalid_stamps.empty() && (beyond_model(p) || forces_beyond_model(p))) out.push_back(chatter_doubt(p));
  const double milled_mm3 = p.cut.milled_mm3();
  if (p.validity.all() && std::abs(imbalance(p.cut.chip_mm3, milled_mm3, job.simulation.voxel_mm)) > kMaxImbalance)
    out.push_back(imbalance_sentence(p.cut.chip_mm3, milled_mm3));
  if (p.surface.empty() && p.holes.surface_mm2 <= 0)
    out.push_back(
        "the program leaves no surface in the stock, so there is no form error to judge; a stock of which material "
        "remains was expected");
  return out;
}

}  // namespace camber::simulate
