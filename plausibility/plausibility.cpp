#include "plausibility/plausibility.h"

#include <array>

#include "motion/machine_checks.h"
#include "plausibility/evidence.h"
#include "plausibility/rules.h"

namespace camber::plausibility {

namespace {

constexpr std::array kRules{
    Rule{"tool-comment", "tool table with the program's comments", look_at_comments},
    Rule{"tool-slender", "overhang with the diameter", look_at_overhang},
    Rule{"tool-proportions", "numbers of a tool with each other and with commonplace values", look_at_proportions},
    Rule{"tool-path", "shape of the cutter with the shape of its path", look_at_path_shape},
    Rule{"chip-load", "feed per tooth with the diameter", look_at_chips},
    Rule{"cutting-speed", "cutting speed with the material and the tool", look_at_speed},
    Rule{"cut-depth", "depth of cut with the diameter", look_at_depth},
    Rule{"cut-power", "power of the cut with spindle and tool", look_at_power},
    Rule{"material-values", "coefficients with commonplace values", look_at_material},
    Rule{"stock-top", "top of the stock with the heights of the path", look_at_stock_top},
    Rule{"stock-place", "stock with the path across", look_at_stock_place},
    Rule{"stock-left", "what is removed with what there is", look_at_removal},
    Rule{"allowance-size", "allowance with the diameter", look_at_allowance},
    Rule{"part-place", "part with the cutters along the path", look_at_part},
    Rule{"part-in-stock", "part with the stock", look_at_part_in_stock},
    Rule{"travel", "extent of the path with the travel of the axes", look_at_travel},
};

}  // namespace

std::span<const Rule> rules() { return kRules; }

void check_plausibility(const machine::Job& job, const simulate::SimulatedProgram& program, Diagnostics& diagnostics) {
  const Evidence evidence(job, program);
  for (const Rule& rule : kRules) rule.look(evidence, diagnostics);
}

void check_job_values(const machine::Job& job, Diagnostics& diagnostics) {
  const Evidence evidence(job);
  for (const Rule& rule : kRules) rule.look(evidence, diagnostics);
}

void check_program(const machine::Job& job, const simulate::SimulatedProgram& program, Diagnostics& diagnostics) {
  motion::check_machine(job.machine, program.text(), program.moves_in_program(), diagnostics);
  check_plausibility(job, program, diagnostics);
}

}  // namespace camber::plausibility
