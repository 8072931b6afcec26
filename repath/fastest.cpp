#include "repath/fastest.h"

#include <algorithm>
#include <iterator>

#include "repath/smoothed_path.h"

namespace camber::repath {
namespace {

constexpr double kLengths[] = {10, 6.3, 4, 3.2, 2.5, 2, 1.6, 1.25, 1};  ///< longest first: they are rarely slower
constexpr double kFeeds[] = {1, 0.85, 0.7, 0.6, 0.5};
constexpr int kNoBetter = 2;                    ///< lengths in a row that keep to the contour and are no better: enough
constexpr std::size_t kLengthsAtLowerFeed = 3;  ///< those that strayed least at the feed before
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

/// Lengths for a lower feed, longest first.
std::vector<double> straying_least(std::vector<Candidate> tried) {
  std::stable_sort(tried.begin(), tried.end(), [](const Candidate& a, const Candidate& b) {
    return a.figures.contour_max_mm < b.figures.contour_max_mm;
  });
  std::vector<double> lengths;
  for (const Candidate& c : tried)
    if (lengths.size() < kLengthsAtLowerFeed) lengths.push_back(c.length_factor);
  std::sort(lengths.rbegin(), lengths.rend());
  return lengths;
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
  Resegmenter resegmenter(program, moves, options.layout);
  const MeantPath meant(moves);
  ResegmentOptions layout = options.layout;
  layout.block_time_s = machine.control.block_time_s;
  std::vector<double> lengths(std::begin(kLengths), std::end(kLengths));
  if (options.layout.length_mm > 0) lengths = {1};
  for (const double feed : kFeeds) {
    const std::size_t first_of_feed = out.tried.size();
    int no_better = 0;
    for (const double length : lengths) {
      layout.length_factor = length;
      layout.feed_factor = feed;
      Resegmentation path = resegmenter.lay_out(layout);
      const ContourFigures figures =
          contour_figures(interpreted(program.source.name(), path.text, options.interpreter), meant, machine);
      out.tried.push_back({length, feed, figures});
      const std::size_t now = out.tried.size() - 1;
      const bool keeps = figures.contour_max_mm <= out.contour_limit_mm;
      const bool strays_least = now == 0 || figures.contour_max_mm < out.tried[nearest].figures.contour_max_mm;
      if (strays_least) nearest = now;
      // The lengths descend: what follows has more blocks.
      const auto beats_chosen = [&] {
        const ContourFigures& chosen = out.tried[out.chosen].figures;
        return options.fewest_blocks ? figures.time_s * kAlmostSameTime < chosen.time_s : better(figures, chosen);
      };
      const bool take = keeps ? !out.within_limit || beats_chosen() : !out.within_limit && strays_least;
      out.within_limit |= keeps;
      if (take) {
        out.chosen = now;
        out.path = std::move(path);
      }
      if (keeps) no_better = take ? 0 : no_better + 1;
      if (no_better >= kNoBetter && !options.fewest_blocks) break;
    }
    if (out.within_limit) break;
    lengths = straying_least({out.tried.begin() + static_cast<std::ptrdiff_t>(first_of_feed), out.tried.end()});
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
