#include "ui/bench.h"

#include <algorithm>
#include <unordered_map>

namespace camber::ui {
namespace {

using Lines = std::vector<std::string_view>;

Lines lines_of(std::string_view text) {
  Lines out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

struct Pair {
  std::size_t before = 0, after = 0;
};

/// Lines that both have exactly once, in the order of the first.
std::vector<Pair> unique_pairs(const Lines& before, const Lines& after) {
  struct Seen {
    std::size_t count_before = 0, count_after = 0, at_after = 0;
  };
  std::unordered_map<std::string_view, Seen> seen;
  for (const std::string_view line : before) ++seen[line].count_before;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto found = seen.find(after[i]);
    if (found == seen.end()) continue;
    ++found->second.count_after;
    found->second.at_after = i;
  }
  std::vector<Pair> out;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (const Seen& s = seen[before[i]]; s.count_before == 1 && s.count_after == 1) out.push_back({i, s.at_after});
  return out;
}

/// The longest choice of pairs that ascends in both.
std::vector<Pair> ascending(const std::vector<Pair>& pairs) {
  std::vector<std::size_t> ends, from(pairs.size());  // ends[k]: of the chains of k + 1 pairs the one that ends lowest
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto at = std::ranges::lower_bound(ends, pairs[i].after, {}, [&](std::size_t p) { return pairs[p].after; });
    from[i] = at == ends.begin() ? pairs.size() : *(at - 1);
    if (at == ends.end())
      ends.push_back(i);
    else
      *at = i;
  }
  std::vector<Pair> out;
  for (std::size_t i = ends.empty() ? pairs.size() : ends.back(); i < pairs.size(); i = from[i])
    out.push_back(pairs[i]);
  std::ranges::reverse(out);
  return out;
}

}  // namespace

std::vector<Hunk> difference(std::string_view before_text, std::string_view after_text) {
  const Lines before = lines_of(before_text), after = lines_of(after_text);
  std::vector<Pair> anchors = ascending(unique_pairs(before, after));
  anchors.push_back({before.size(), after.size()});
  std::vector<Hunk> out;
  std::size_t b = 0, a = 0;
  for (const Pair& anchor : anchors) {
    if (anchor.before < b || anchor.after < a) continue;  // an equal stretch has passed it
    while (b < anchor.before && a < anchor.after && before[b] == after[a]) ++b, ++a;
    std::size_t b_end = anchor.before, a_end = anchor.after;
    while (b_end > b && a_end > a && before[b_end - 1] == after[a_end - 1]) --b_end, --a_end;
    if (b_end > b || a_end > a) out.push_back({b, b_end - b, a, a_end - a});
    b = anchor.before, a = anchor.after;
    while (b < before.size() && a < after.size() && before[b] == after[a]) ++b, ++a;
  }
  return out;
}

}  // namespace camber::ui
