#include "repath/fastest.h"

#include <algorithm>
#include <limits>

namespace camber::repath {
namespace {

constexpr double kLengths[] = {1, 1.25, 1.6, 2, 2.5, 3.2, 4, 6.3, 10};
constexpr double kFeeds[] = {1, 0.85, 0.7, 0.6, 0.5};
constexpr double kMoreContour = 1.05;  ///< that the old blocks' contour error may grow by, unless told otherwise
constexpr double kLeastGain = 1.002;   ///< less is not worth another program
constexpr double kSameTime = 1.001;    ///< what is no faster than this has no say: the path with the smaller error has
constexpr double kAlmostSameTime = 1.005;  ///< is worth fewer blocks

nc::Interpretation interpreted(const std::string& name, const std::string& text,
                               const nc::InterpreterOptions& options) {
  Diagnostics diagnostics;  // what it says of the text was said of the old one; an error is ours
  const nc::Program program = nc::read_program(SourceText(name, text), diagnostics);
  nc::Interpretation moves = nc::interpret(program, options, diagnostics);
  diagnostics.throw_if_errors();
  return moves;
}

bool better(const ContourFigures& a, const ContourFigures& b) {
  if (a.time_s * kSameTime < b.time_s || b.time_s * kSameTime < a.time_s) return a.time_s < b.time_s;
  return a.contour_max_mm < b.contour_max_mm;
}

}  // namespace

Fastest find_fastest(const nc::Program& program, const nc::Interpretation& moves, const machine::Machine& machine,
                     const ContourFigures& before, const FastestOptions& options) {
  Fastest out;
  out.contour_limit_mm = options.contour_mm > 0
                             ? options.contour_mm
                             : std::max(kMoreContour * before.contour_max_mm, options.layout.tolerance_mm);
  out.within_limit = false;
  std::size_t nearest = 0;
  double fastest_s = std::numeric_limits<double>::infinity();
  ResegmentOptions layout = options.layout;
  layout.block_time_s = machine.control.block_time_s;
  for (const double feed : kFeeds) {
    for (const double length : kLengths) {
      layout.length_factor = length;
      layout.feed_factor = feed;
      Resegmentation path = resegment(program, moves, layout);
      const ContourFigures figures =
          contour_figures(interpreted(program.source.name(), path.text, options.interpreter), moves, machine);
      out.tried.push_back({length, feed, figures});
      const std::size_t now = out.tried.size() - 1;
      const bool keeps = figures.contour_max_mm <= out.contour_limit_mm;
      const bool first = now == 0;
      const bool strays_least = first || figures.contour_max_mm < out.tried[nearest].figures.contour_max_mm;
      if (strays_least) nearest = now;
      // The lengths ascend.
      const auto beats_chosen = [&] {
        return options.fewest_blocks ? figures.time_s <= kAlmostSameTime * fastest_s
                                     : better(figures, out.tried[out.chosen].figures);
      };
      const bool take = keeps ? !out.within_limit || beats_chosen() : !out.within_limit && strays_least;
      if (keeps) fastest_s = std::min(fastest_s, figures.time_s);
      out.within_limit |= keeps;
      if (take) {
        out.chosen = now;
        out.path = std::move(path);
      }
      if (options.layout.length_mm > 0) break;
    }
    if (out.within_limit) break;
  }
  const bool asked_for = options.layout.length_mm > 0 || !options.keep_old;
  out.gains = asked_for || out.tried[out.chosen].figures.time_s * kLeastGain < before.time_s;
  if (!out.gains) {
    out.path = {};
    out.path.text = program.source.text();
    out.within_limit = true;
  }
  return out;
}

}  // namespace camber::repath
