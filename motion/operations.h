#pragma once
// Operations that a job names, in terms of a program's lines.
#include <cstdint>
#include <vector>

#include "machine/simulation_settings.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::motion {

/// The same operations without a regular expression: what it names becomes ranges of lines. Where no
/// line is left, the range [0, 0], which no move stands in.
machine::Operations as_lines(const machine::Operations& operations, const nc::Program& program,
                             const nc::Interpretation& moves);

/// Ranges of the given program's lines where the emitted program has them. `block_of_line`: of the emission.
machine::Operations moved_ranges(const machine::Operations& operations,
                                 const std::vector<std::uint32_t>& block_of_line);

}  // namespace camber::motion
