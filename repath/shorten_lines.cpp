#include "repath/shorten_lines.h"

#include <algorithm>
#include <limits>

namespace camber::repath {
namespace {

constexpr std::size_t kBefore = 2, kBehind = 2;  ///< primitives beside a line that are laid out anew with it
constexpr std::uint32_t kMostPoints = 64;
constexpr double kNearer = 0.7;
constexpr double kExact = 0.25;  ///< of the tolerance: so near lies only what was drawn so
constexpr int kFailures = 4;     ///< ends in a row that nothing reaches

class Window {
 public:
  Window(const Polyline& path, const FitOptions& options, const Fitter& fitter)
      : path_(path), options_(options), fitter_(fitter) {}

  /// The best chain from one point to another without a corner between them, of no more primitives than `most`; a cost
  /// beyond that where there is none.
  std::vector<Primitive> best(std::uint32_t begin, std::uint32_t end, double most_deviation_mm, std::size_t most,
                              ChainCost& cost) {
    most_deviation_ = most_deviation_mm;
    const std::size_t n = end - begin + 1;
    costs_.assign(n, {std::numeric_limits<std::size_t>::max() / 2, 0});
    via_.assign(n, {});
    costs_[0] = {};
    for (std::uint32_t from = begin; from < end; ++from) {
      if (costs_[from - begin].primitives >= most) continue;
      int failures = 0;
      for (std::uint32_t to = from + 1; to <= end && failures < kFailures; ++to)
        failures = reach(begin, from, to) || to - from < options_.arc_points ? 0 : failures + 1;
    }
    cost = costs_[n - 1];
    std::vector<Primitive> chain;
    if (cost.primitives > most) return chain;
    for (std::uint32_t at = end; at > begin; at = chain.back().first) chain.push_back(via_[at - begin]);
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

 private:
  bool reach(std::uint32_t begin, std::uint32_t from, std::uint32_t to) {
    bool reached = false;
    for (const auto& p : line_or_arc(fitter_, options_, from, to)) {
      if (!p || p->deviation_mm > most_deviation_) continue;
      reached = true;
      const ChainCost cost = costs_[from - begin].with(path_, *p);
      if (!(cost < costs_[to - begin])) continue;
      costs_[to - begin] = cost;
      via_[to - begin] = *p;
    }
    return reached;
  }

  const Polyline& path_;
  const FitOptions& options_;
  const Fitter& fitter_;
  double most_deviation_ = 0;
  std::vector<ChainCost> costs_;
  std::vector<Primitive> via_;
};

}  // namespace

bool ChainCost::operator<(const ChainCost& other) const {
  constexpr double kSame = 1e-6;
  return primitives != other.primitives ? primitives < other.primitives : lines_mm < other.lines_mm - kSame;
}

ChainCost ChainCost::with(const Polyline& path, const Primitive& p) const {
  return {primitives + 1, lines_mm + (p.arc ? 0 : (path.at(p.last) - path.at(p.first)).norm())};
}

std::array<std::optional<Primitive>, 2> line_or_arc(const Fitter& fitter, const FitOptions& options,
                                                    std::uint32_t first, std::uint32_t last) {
  const auto line = fitter.line(first, last);
  if (!options.arcs || (line && line->deviation_mm <= options.increment_mm)) return {line, std::nullopt};
  const auto arc = fitter.arc(first, last);
  if (line && arc && arc->deviation_mm > kNearer * line->deviation_mm) return {line, std::nullopt};
  return {line, arc};
}

void shorten_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain) {
  Window window(path, options, fitter);
  std::vector<Primitive> out;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    out.push_back(chain[k]);
    if (chain[k].arc) continue;
    // The window: what was decided before the line, the line, and what comes behind.
    std::size_t first = out.size() - 1, last = k;
    while (first > 0 && out.size() - 1 - first < kBefore && !corners[out[first].first]) --first;
    while (last + 1 < chain.size() && last - k < kBehind && !corners[chain[last].last]) ++last;
    const std::uint32_t begin = out[first].first, end = chain[last].last;
    if (end - begin >= kMostPoints || out.size() - first + (last - k) < 2) continue;
    ChainCost was, now;
    double deviation = 0;
    const auto count = [&](const Primitive& p) {
      was = was.with(path, p);
      deviation = std::max(deviation, p.deviation_mm);
    };
    for (std::size_t i = first; i < out.size(); ++i) count(out[i]);
    for (std::size_t i = k + 1; i <= last; ++i) count(chain[i]);
    // A line and an arc as they were drawn; else fewer; else shorter lines.
    const double exact = std::max(options.increment_mm, kExact * options.tolerance_mm);
    std::vector<Primitive> better = window.best(begin, end, exact, was.primitives, now);
    const bool drawn = now.primitives <= was.primitives && deviation > exact;
    if (!drawn) {
      better = window.best(begin, end, options.tolerance_mm, was.primitives, now);
      if (now.primitives == was.primitives && now < was)
        better = window.best(begin, end, deviation, was.primitives, now);
      if (!(now < was)) continue;
    }
    out.resize(first);
    out.insert(out.end(), better.begin(), better.end());
    k = last;
  }
  chain = std::move(out);
}

}  // namespace camber::repath
