#include "simulate/turn.h"

#include <algorithm>

#include <fmt/format.h>

namespace camber::simulate {
namespace {

void report(const SimulatedProgram& program, std::size_t line, Severity severity, std::string message,
            Diagnostics& diagnostics) {
  const auto& source = program.text().source;
  const bool there = line >= 1 && line <= source.line_count();
  diagnostics.add({severity,
                   {source.name(), there ? line : 0, there ? std::size_t{1} : 0},
                   std::move(message),
                   "forces-at",
                   there ? std::string(source.line(line)) : std::string()});
}

}  // namespace

std::size_t turn_at_line(const SimulatedProgram& program, const machine::Job& job, std::size_t line,
                         Diagnostics& diagnostics) {
  const auto& stamps = program.path.stamps;
  const auto on_line = [&](std::size_t k) {
    return program.moves_in_part().moves[stamps[k].move].block + 1 == line &&
           program.holes[stamps[k].move] != removal::HoleMove::tapped;
  };
  std::size_t first = stamps.size(), last = 0;
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (on_line(k)) {
      first = std::min(first, k);
      last = k;
    }
  if (first == stamps.size()) {
    report(program, line, Severity::error,
           fmt::format("--forces-at {}: line {} {}; a line that the job's operations cut was expected", line, line,
                       line > program.text().source.line_count()
                           ? fmt::format("is not in the program, which has {}", program.text().source.line_count())
                           : "cuts nothing"),
           diagnostics);
    return 0;
  }
  const std::size_t middle = (first + last) / 2;
  const auto run = std::ranges::find_if(program.path.runs,
                                        [&](const auto& r) { return middle >= r.from && middle < r.from + r.count; });
  // The uninterrupted cut around it.
  std::size_t begin = middle, end = middle + 1;
  while (begin > run->from && !stamps[begin].first) --begin;
  while (end < run->from + run->count && !stamps[end].first) ++end;
  const auto teeth = static_cast<std::size_t>(job.tools.at(run->tool).flutes);
  if (end - begin < teeth) {
    report(program, line, Severity::warning,
           fmt::format("--forces-at {}: the cut around this line lasts {} of the {} tooth passings of a turn; the "
                       "others show no force",
                       line, end - begin, teeth),
           diagnostics);
    return begin;
  }
  const std::size_t wanted = middle >= teeth / 2 ? middle - teeth / 2 : 0;
  return std::clamp(wanted, begin, end - teeth);
}

}  // namespace camber::simulate
