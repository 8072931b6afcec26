#include "plan/cases.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/geometry.h"

namespace camber::plan {

double Case::spindle_rpm() const { return 1000 * speed_m_per_min / (kPi * content.diameter_mm); }

std::optional<double> Case::feed_per_turn_mm() const {
  return feed_mm_per_min ? std::optional(*feed_mm_per_min / spindle_rpm()) : std::nullopt;
}

const MaterialGroup* CaseBase::group_of(std::string_view material) const {
  for (const MaterialGroup& g : groups)
    if (std::ranges::find(g.materials, material) != g.materials.end()) return &g;
  return nullptr;
}

double similarity(const CaseBase& base, const CaseContent& a, const CaseContent& b) {
  if (a.tool != b.tool || a.fast != b.fast) return 0;
  double sum = base.tool_weight;
  const MaterialGroup* group = base.group_of(a.material);
  if (a.material == b.material)
    sum += base.material_weight;
  else if (group != nullptr && group == base.group_of(b.material))
    sum += base.material_weight / 2;
  if (a.tool_material == b.tool_material) sum += base.tool_material_weight;
  if (a.coated == b.coated) sum += base.coating_weight;
  if (a.fine == b.fine) sum += base.finish_weight;
  return sum / (base.tool_weight + base.material_weight + base.tool_material_weight + base.coating_weight +
                base.finish_weight);
}

namespace {

/// Of the usual or fast speed of the materials' groups; 1 where one is not known.
double speed_factor(const CaseBase& base, const CaseContent& query, const CaseContent& from) {
  const MaterialGroup *to = base.group_of(query.material), *of = base.group_of(from.material);
  if (to == nullptr || of == nullptr) return 1;
  return query.fast ? to->fast_m_per_min / of->fast_m_per_min : to->usual_m_per_min / of->usual_m_per_min;
}

double exponent_of(const CaseBase& base, std::string_view tool) {
  const auto at = base.feed_exponent.find(tool);
  return at == base.feed_exponent.end() ? 0 : at->second;
}

Neighbour neighbour_of(const CaseBase& base, const CaseContent& query, const Case& c) {
  Neighbour out{&c, similarity(base, query, c.content), c.speed_m_per_min * speed_factor(base, query, c.content), {}};
  if (const auto feed = c.feed_per_turn_mm())
    out.feed_per_turn_mm = *feed * std::pow(query.diameter_mm / c.content.diameter_mm, exponent_of(base, query.tool));
  return out;
}

/// All cases of the tool's type, the most similar first.
std::vector<Neighbour> all_neighbours(const CaseBase& base, const CaseContent& query, const Case* without) {
  std::vector<Neighbour> out;
  for (const Case& c : base.cases)
    if (&c != without && similarity(base, query, c.content) > 0) out.push_back(neighbour_of(base, query, c));
  const auto apart = [&](const Neighbour& n) {
    return std::abs(std::log(n.of->content.diameter_mm / query.diameter_mm));
  };
  constexpr double kEqual = 1e-9;
  std::ranges::stable_sort(out, [&](const Neighbour& a, const Neighbour& b) {
    if (std::abs(a.similarity - b.similarity) > kEqual) return a.similarity > b.similarity;
    return apart(a) < apart(b) - kEqual;
  });
  return out;
}

/// Mean over the neighbours that tell a quantity; of the others the most similar one's where none does.
template <class Value>
std::optional<double> mean_of(const std::vector<Neighbour>& near, const std::vector<Neighbour>& all, Value value) {
  double sum = 0, count = 0;
  for (const Neighbour& n : near)
    if (const std::optional<double> v = value(n)) sum += *v, count += 1;
  if (count > 0) return sum / count;
  for (const Neighbour& n : all)
    if (const std::optional<double> v = value(n)) return v;
  return std::nullopt;
}

std::optional<double> share(const std::optional<double>& depth, const Neighbour& n) {
  return depth ? std::optional(*depth / n.of->content.diameter_mm) : std::nullopt;
}

}  // namespace

std::optional<CaseAnswer> conditions_by_cases(const CaseBase& base, const CaseContent& query, const Case* without) {
  const std::vector<Neighbour> all = all_neighbours(base, query, without);
  if (all.empty()) return std::nullopt;
  CaseAnswer out;
  out.similar = all.front().similarity >= base.least_similarity - 1e-9;
  const double least = out.similar ? base.least_similarity : all.front().similarity;
  for (const Neighbour& n : all)
    if (n.similarity >= least - 1e-9 && out.neighbours.size() < base.most_cases) out.neighbours.push_back(n);
  const auto mean = [&](auto value) { return mean_of(out.neighbours, all, value); };
  out.speed_m_per_min = *mean([](const Neighbour& n) { return std::optional(n.speed_m_per_min); });
  const auto feed = mean([](const Neighbour& n) { return n.feed_per_turn_mm; });
  if (!feed) return std::nullopt;
  out.feed_per_turn_mm = *feed;
  const auto shares = base.depth_share.find(query.tool);
  const std::array<double, 2> fallback = shares == base.depth_share.end() ? std::array{1.0, 1.0} : shares->second;
  // Depths of roughing say nothing of finishing, and the other way round.
  const auto alike = [&](const Neighbour& n) { return n.of->content.fine == query.fine; };
  const auto axial = mean([&](const Neighbour& n) { return alike(n) ? share(n.of->axial_depth_mm, n) : std::nullopt; });
  const auto radial =
      mean([&](const Neighbour& n) { return alike(n) ? share(n.of->radial_depth_mm, n) : std::nullopt; });
  out.axial_depth_mm = query.diameter_mm * axial.value_or(fallback[0]);
  out.radial_depth_mm = query.diameter_mm * radial.value_or(fallback[1]);
  return out;
}

std::vector<LeftOut> leave_one_out(const CaseBase& base) {
  std::vector<LeftOut> out;
  for (const Case& c : base.cases) {
    const auto answer = conditions_by_cases(base, c.content, &c);
    if (!answer) continue;
    LeftOut row{&c, answer->speed_m_per_min / c.speed_m_per_min, {}, answer->similar};
    if (const auto feed = c.feed_per_turn_mm()) row.feed_ratio = answer->feed_per_turn_mm / *feed;
    out.push_back(row);
  }
  return out;
}

}  // namespace camber::plan
