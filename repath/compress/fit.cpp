// The chain of fewest primitives: a search by number of primitives, breadth first.
#include "repath/compress/fit.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "repath/compress/block_joints.h"
#include "repath/compress/chain_window.h"
#include "repath/compress/shorten_lines.h"
#include "repath/compress/tangent.h"

namespace camber::repath {
namespace {

struct Node {
  std::uint32_t vertex = 0;
  std::int64_t before = -1;  ///< index of the node that it was reached from
  Primitive primitive{};
};

/// Chains of n primitives are kept by where they end: the `width` ends that lie farthest. A chain of n + 1 begins with
/// one of n, and the farther that one came the farther the next comes, but for small differences: the pencil of arcs is
/// pinned at its ends, so an end a few points short may carry farther. That is what the width is for.
class Search {
 public:
  Search(const Polyline& path, const FitOptions& options, FitMemory* memory)
      : path_(path), points_(path.points), options_(options), fitter_(path, options, memory) {}

  std::vector<Primitive> run() {
    const auto n = static_cast<std::uint32_t>(points_.size());
    const std::vector<bool> corners = corners_of(path_, options_), ends = ends_of(path_, corners);
    std::vector<Primitive> chain;
    std::uint32_t begin = 0;
    for (std::uint32_t k = 1; k < n; ++k) {
      if (k + 1 < n && !ends[k]) continue;
      fit_piece(begin, k, chain);
      begin = k;
    }
    if (options_.arcs) shorten_lines(path_, options_, fitter_, ends, chain);
    if (options_.tangent) {
      std::vector<Primitive> smoother = chain;
      move_joints(path_, fitter_, ends, smoother);
      make_tangent(points_, options_, fitter_, corners, smoother);
      if (kink_squares(smoother, corners) < kink_squares(chain, corners)) chain = std::move(smoother);
    }
    smooth_joints(path_, options_, fitter_, corners, chain);
    if (options_.arcs && options_.primitives_per_line_mm > 0) spare_lines(path_, options_, fitter_, corners, chain);
    return chain;
  }

 private:
  double kink_squares(const std::vector<Primitive>& chain, const std::vector<bool>& corners) const {
    const std::vector<double> kinks = kinks_of(path_, chain);
    double sum = 0;
    for (std::size_t k = 0; k < kinks.size(); ++k)
      if (!corners[chain[k].last]) sum += kinks[k] * kinks[k];
    return sum;
  }

  void fit_piece(std::uint32_t begin, std::uint32_t end, std::vector<Primitive>& chain) {
    nodes_.assign(1, Node{begin});
    std::vector<std::int64_t> frontier{0};
    while (nodes_[static_cast<std::size_t>(frontier.front())].vertex != end) frontier = next(frontier, end);
    std::vector<Primitive> back;
    for (std::int64_t i = frontier.front(); nodes_[static_cast<std::size_t>(i)].before >= 0;
         i = nodes_[static_cast<std::size_t>(i)].before)
      back.push_back(nodes_[static_cast<std::size_t>(i)].primitive);
    chain.insert(chain.end(), back.rbegin(), back.rend());
  }

  /// The ends one primitive farther, farthest first.
  std::vector<std::int64_t> next(const std::vector<std::int64_t>& frontier, std::uint32_t end) {
    std::vector<std::int64_t> out;
    farthest_ = 0;
    const auto add = [&](std::int64_t from, const Primitive& primitive) {
      farthest_ = std::max(farthest_, primitive.last);
      for (const std::int64_t o : out)
        if (nodes_[static_cast<std::size_t>(o)].vertex == primitive.last) return;
      nodes_.push_back({primitive.last, from, primitive});
      out.push_back(static_cast<std::int64_t>(nodes_.size()) - 1);
    };
    for (const std::int64_t from : frontier) {
      const std::uint32_t vertex = nodes_[static_cast<std::size_t>(from)].vertex;
      std::uint32_t line_end = vertex + 1;
      const auto line_ends = fitter_.line_ends(vertex, end, options_.width);
      for (auto e = line_ends.rbegin(); e != line_ends.rend(); ++e)
        if (const auto line = fitter_.line(vertex, *e)) {
          add(from, *line);
          line_end = std::max(line_end, *e);
        }
      if (farthest_ == end) break;
      if (options_.arcs) add_arcs(from, vertex, line_end, end, from == frontier.front(), add);
      if (farthest_ == end) break;
    }
    std::sort(out.begin(), out.end(), [&](std::int64_t a, std::int64_t b) {
      return nodes_[static_cast<std::size_t>(a)].vertex > nodes_[static_cast<std::size_t>(b)].vertex;
    });
    if (out.size() > options_.width) out.resize(options_.width);
    return out;
  }

  template <class Add>
  void add_arcs(std::int64_t from, std::uint32_t vertex, std::uint32_t line_end, std::uint32_t end, bool leader,
                const Add& add) {
    if (vertex + options_.arc_points - 1 > end) return;
    if (points_[vertex] == points_[end] && vertex == nodes_.front().vertex)
      if (const auto turn = fitter_.arc(vertex, end)) return add(from, *turn);
    // Doubling: first beyond what a line does (a shorter arc is no gain), for the others beyond what is reached.
    const std::uint32_t base = std::max(vertex + options_.arc_points - 2, leader ? line_end : farthest_);
    std::uint32_t good = 0, bad = end + 1;
    int failures = 0;
    for (std::uint32_t step = 1, max_failures = leader ? 3 : 2; failures < static_cast<int>(max_failures); step *= 2) {
      const std::uint32_t e = std::min(end, base + step);
      if (e <= base) break;
      if (const auto arc = fitter_.arc(vertex, e)) {
        add(from, *arc);
        good = e, bad = end + 1, failures = 0;
      } else {
        if (failures++ == 0) bad = e;
      }
      if (e == end) break;
    }
    if (good == 0) return;
    while (bad > good + 1) {
      const std::uint32_t middle = good + (bad - good) / 2;
      if (const auto arc = fitter_.arc(vertex, middle)) {
        add(from, *arc);
        good = middle;
      } else {
        bad = middle;
      }
    }
    for (std::uint32_t e = good + 2; e <= std::min(end, good + 3); ++e)
      if (const auto arc = fitter_.arc(vertex, e)) add(from, *arc);
    if (!leader) return;
    const std::uint32_t lowest = std::max(base + 1, good - std::min(good, options_.width - 1));
    for (std::uint32_t e = good; e-- > lowest;)
      if (const auto arc = fitter_.arc(vertex, e)) add(from, *arc);
  }

  Polyline path_;
  std::span<const Vec2> points_;
  const FitOptions& options_;
  Fitter fitter_;
  std::vector<Node> nodes_;
  std::uint32_t farthest_ = 0;
};

[[maybe_unused]] bool repeats_a_point(const Polyline& path) {
  for (std::size_t k = 1; k < path.points.size(); ++k)
    if (path.at(k) == path.at(k - 1)) return true;
  return false;
}

}  // namespace

std::vector<Primitive> fit(const Polyline& path, const FitOptions& options, FitMemory* memory) {
  assert(options.tolerance_mm > 0 && options.increment_mm > 0 && options.width > 0);
  assert(path.heights.empty() || path.heights.size() == path.points.size());
  assert(std::ranges::is_sorted(path.ends));
  assert(!repeats_a_point(path));
  if (path.points.size() < 2) return {};
  return Search(path, options, memory).run();
}

std::vector<Primitive> fit_exhaustively(const Polyline& path, const FitOptions& options) {
  const auto n = static_cast<std::uint32_t>(path.points.size());
  if (n < 2) return {};
  const Fitter fitter(path, options);
  assert(!(options.max_kink_rad < kPi));
  const std::vector<bool> corners = corners_of(path, options), ends = ends_of(path, corners);
  const PieceJoints joints(path, options, corners);
  const Bends bends(path, options, fitter, joints);
  constexpr double kFar = 1e12;
  std::vector<ChainCost> cost(n, ChainCost{n, kFar, options.primitives_per_line_mm});
  std::vector<Primitive> best(n);
  cost[0] = {.primitives_per_line_mm = options.primitives_per_line_mm};
  for (std::uint32_t i = 0; i + 1 < n; ++i)
    for (std::uint32_t j = i + 1; j < n; ++j) {
      for (const auto& fitted : line_or_arc(bends, fixed({.first = i, .last = i}), bends.stretch(i, j))) {
        if (!fitted) continue;
        const ChainCost now = cost[i].with(path, fitted->primitive);
        if (!(now < cost[j])) continue;
        cost[j] = now;
        best[j] = fitted->primitive;
      }
      if (ends[j]) break;
    }
  std::vector<Primitive> chain;
  for (std::uint32_t j = n - 1; j > 0; j = best[j].first) chain.push_back(best[j]);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

}  // namespace camber::repath
