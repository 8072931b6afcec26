#include "repath/compress/chain_window.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>

namespace camber::repath {
namespace {

constexpr double kNearer = 0.7;
constexpr std::size_t kStates = 6;  ///< chains to a point that are kept where kinks are bounded
constexpr int kFailures = 4;        ///< ends in a row that nothing reaches

}  // namespace

bool ChainCost::operator<(const ChainCost& other) const {
  constexpr double kSame = 1e-6;
  if (primitives_per_line_mm > 0) {
    const auto sum = [&](const ChainCost& c) {
      return static_cast<double>(c.primitives) + primitives_per_line_mm * c.lines_mm;
    };
    return sum(*this) < sum(other) - kSame;
  }
  return primitives != other.primitives ? primitives < other.primitives : lines_mm < other.lines_mm - kSame;
}

ChainCost ChainCost::with(const Polyline& path, const Primitive& p) const {
  return {primitives + 1, lines_mm + (p.arc ? 0 : (path.at(p.last) - path.at(p.first)).norm()), primitives_per_line_mm};
}

std::array<std::optional<Bent>, 2> line_or_arc(const Bends& bends, const Bent& before, const Bends::Section& stretch) {
  const auto line = bends.line(before, stretch), arc = bends.arc(before, stretch);
  if (line && arc && arc->primitive.deviation_mm > kNearer * line->primitive.deviation_mm) return {line, std::nullopt};
  return {line, arc};
}

std::vector<Primitive> ChainWindow::best(const Primitive& before, const Primitive* behind,
                                         std::span<const std::uint32_t> ends, const Limits& limits, ChainCost& cost) {
  assert(!ends.empty() && before.last < ends.front());
  assert(std::ranges::adjacent_find(ends, std::greater_equal{}) == ends.end() && ends.back() < path_.points.size());
  states_.assign(1, State{{.primitives_per_line_mm = limits.primitives_per_line_mm}, fixed(before), 0});
  if (at_.size() < ends.size() + 1) at_.resize(ends.size() + 1);
  for (std::size_t k = 0; k <= ends.size(); ++k) at_[k].clear();
  at_[0].push_back(0);
  for (std::size_t from = 0; from < ends.size(); ++from) {
    std::erase_if(at_[from], [&](std::size_t s) { return states_[s].cost.primitives >= limits.max_primitives; });
    if (at_[from].empty()) continue;
    const std::uint32_t begin = from == 0 ? before.last : ends[from - 1];
    const auto limit = std::upper_bound(path_.ends.begin(), path_.ends.end(), begin);
    int failures = 0;
    for (std::size_t to = from + 1; to <= ends.size() && failures < kFailures; ++to) {
      const std::uint32_t end = ends[to - 1];
      if (limit != path_.ends.end() && end > *limit) break;
      failures = reach(from, to, begin, end, limits) || end - begin < options_.arc_points ? 0 : failures + 1;
    }
  }
  return chain_to(at_[ends.size()], behind, cost);
}

bool ChainWindow::reach(std::size_t from, std::size_t to, std::uint32_t begin, std::uint32_t end,
                        const Limits& limits) {
  const Bends::Section stretch = bends_.stretch(begin, end);
  bool reached = stretch.room.has_value();
  for (const std::size_t s : at_[from]) {
    const std::array<std::optional<Bent>, 2> bents = line_or_arc(bends_, states_[s].bent, stretch);
    for (const auto& bent : bents) {
      if (!bent || bent->primitive.deviation_mm > limits.max_deviation_mm) continue;
      reached = true;
      keep(at_[to], {states_[s].cost.with(path_, bent->primitive), *bent, s});
    }
  }
  return reached;
}

void ChainWindow::keep(std::vector<std::size_t>& here, const State& state) {
  const auto covers = [&](const State& a, const State& b) {
    return !(b.cost < a.cost) && bends_.covers(a.bent, b.bent);
  };
  for (const std::size_t s : here)
    if (covers(states_[s], state)) return;
  std::erase_if(here, [&](std::size_t s) { return covers(state, states_[s]); });
  if (here.size() >= kStates) {
    const auto dearest = std::max_element(
        here.begin(), here.end(), [&](std::size_t a, std::size_t b) { return states_[a].cost < states_[b].cost; });
    if (!(state.cost < states_[*dearest].cost)) return;
    here.erase(dearest);
  }
  here.push_back(states_.size());
  states_.push_back(state);
}

std::vector<Primitive> ChainWindow::chain_to(const std::vector<std::size_t>& here, const Primitive* behind,
                                             ChainCost& cost) const {
  cost = {std::numeric_limits<std::size_t>::max() / 2, 0, states_[0].cost.primitives_per_line_mm};
  std::size_t last = 0;
  for (const std::size_t s : here) {
    const State& state = states_[s];
    if (!(state.cost < cost)) continue;
    if (behind != nullptr && !joints_.behind(state.bent.primitive, state.bent.sweeps, *behind, fixed(*behind).sweeps))
      continue;
    cost = state.cost;
    last = s;
  }
  std::vector<Bent> bent;
  for (std::size_t s = last; s != 0; s = states_[s].before) bent.push_back(states_[s].bent);
  std::reverse(bent.begin(), bent.end());
  return bends_.settled(bent, behind);
}

}  // namespace camber::repath
