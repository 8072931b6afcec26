#include "repath/compress/shorten_lines.h"

#include <algorithm>
#include <numeric>

#include "repath/compress/chain_window.h"

namespace camber::repath {
namespace {

constexpr std::size_t kBefore = 2, kBehind = 2;  ///< primitives beside a line that are laid out anew with it
constexpr std::uint32_t kMaxPoints = 64;
constexpr double kExact = 0.25;  ///< of the tolerance: so near lies only what was drawn so

}  // namespace

void shorten_lines(const Polyline& path, const FitOptions& options, const Fitter& fitter,
                   const std::vector<bool>& corners, std::vector<Primitive>& chain) {
  FitOptions any_kink = options;
  any_kink.max_kink_rad = std::numeric_limits<double>::infinity();
  const PieceJoints joints(path, any_kink, corners);
  ChainWindow window(path, any_kink, fitter, joints);
  std::vector<std::uint32_t> ends;
  std::vector<Primitive> out;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    out.push_back(chain[k]);
    if (chain[k].arc) continue;
    // The window: what was decided before the line, the line, and what comes behind.
    std::size_t first = out.size() - 1, last = k;
    while (first > 0 && out.size() - 1 - first < kBefore && !corners[out[first].first]) --first;
    while (last + 1 < chain.size() && last - k < kBehind && !corners[chain[last].last]) ++last;
    const std::uint32_t begin = out[first].first, end = chain[last].last;
    if (end - begin >= kMaxPoints || out.size() - first + (last - k) < 2) continue;
    ChainCost was, now;
    double deviation = 0;
    const auto count = [&](const Primitive& p) {
      was = was.with(path, p);
      deviation = std::max(deviation, p.deviation_mm);
    };
    for (std::size_t i = first; i < out.size(); ++i) count(out[i]);
    for (std::size_t i = k + 1; i <= last; ++i) count(chain[i]);
    ends.resize(end - begin);
    std::iota(ends.begin(), ends.end(), begin + 1);
    const auto best = [&](double max_deviation_mm) {
      return window.best({.first = begin, .last = begin}, nullptr, ends, {max_deviation_mm, was.primitives}, now);
    };
    // A line and an arc as they were drawn; else fewer; else shorter lines.
    const double exact = std::max(options.increment_mm, kExact * options.tolerance_mm);
    std::vector<Primitive> better = best(exact);
    const bool drawn = now.primitives <= was.primitives && deviation > exact;
    if (!drawn) {
      better = best(options.tolerance_mm);
      if (now.primitives == was.primitives && now < was) better = best(deviation);
      if (!(now < was)) continue;
    }
    out.resize(first);
    out.insert(out.end(), better.begin(), better.end());
    k = last;
  }
  chain = std::move(out);
}

}  // namespace camber::repath
