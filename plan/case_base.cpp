#include "plan/case_base.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/geometry.h"
#include "machine/number_key.h"
#include "machine/toml_table.h"

namespace camber::plan {
namespace {

using machine::kNotNegative;
using machine::kPositive;
using machine::TomlTable;

constexpr machine::NumberRange kShare{.min = 0, .max = 1};
constexpr machine::NumberRange kCount{.min = 1, .max = 1000, .whole = true};

void read_groups(TomlTable& top, CaseBase& base) {
  auto table = top.table("groups");
  if (!table) return;
  for (const std::string& name : table->keys()) {
    auto group = table->table(name);
    if (!group) continue;
    MaterialGroup out{.name = name, .materials = {}};
    if (!group->has("materials")) group->missing("materials", "a list of materials, as in [\"S45C\", \"S55C\"],");
    out.materials = group->text_list("materials", "a list of texts").value_or(std::vector<std::string>{});
    out.usual_m_per_min = group->required_number("usual", kPositive);
    out.fast_m_per_min = group->required_number("fast", kPositive);
    group->finish();
    base.groups.push_back(std::move(out));
  }
}

void read_similarity(TomlTable& top, CaseBase& base) {
  auto table = top.table("similarity");
  if (!table) return;
  base.material_weight = table->number("material", kShare, base.material_weight);
  base.tool_weight = table->number("tool", kShare, base.tool_weight);
  base.tool_material_weight = table->number("tool_material", kShare, base.tool_material_weight);
  base.coating_weight = table->number("coating", kShare, base.coating_weight);
  base.finish_weight = table->number("finish", kShare, base.finish_weight);
  base.least_similarity = table->number("least", kShare, base.least_similarity);
  base.most_cases = static_cast<std::size_t>(table->number("cases", kCount, static_cast<double>(base.most_cases)));
  if (base.material_weight + base.tool_weight + base.tool_material_weight + base.coating_weight + base.finish_weight <=
      0)
    table->error_at("", "the weights add up to zero; at least one greater than zero was expected", "value-range");
  table->finish();
}

void read_modification(TomlTable& top, CaseBase& base) {
  if (auto table = top.table("feed_exponent"))
    for (const std::string& tool : table->keys())
      base.feed_exponent[tool] = table->number(tool, machine::kAnyNumber, 0);
  auto table = top.table("depth_share");
  if (!table) return;
  for (const std::string& tool : table->keys())
    if (const auto v = table->numbers(tool, 2, kPositive, "[axial, radial], shares of the diameter,"))
      base.depth_share[tool] = {(*v)[0], (*v)[1]};
}

Case read_case(TomlTable table) {
  Case out;
  out.content.material = table.required_text("material");
  out.content.tool = table.required_text("tool");
  out.content.tool_material = table.required_text("tool_material");
  out.content.coated = table.boolean("coated", false);
  out.content.fine = table.choice("finish", kFinishWords, 0) == 1;
  out.content.fast = table.choice("machining", kMachiningWords, 0) == 1;
  out.content.diameter_mm = table.required_number("diameter_mm", kPositive);
  out.speed_m_per_min = table.required_number("speed_m_per_min", kPositive);
  out.feed_mm_per_min = table.optional_number("feed_mm_per_min", kPositive);
  out.axial_depth_mm = table.optional_number("axial_depth_mm", kPositive);
  out.radial_depth_mm = table.optional_number("radial_depth_mm", kPositive);
  table.ignore("flutes");
  table.ignore("note");
  out.line = table.place_of("material").location.line;
  table.finish();
  return out;
}

}  // namespace

CaseBase read_case_base(const std::string& path, Diagnostics& diagnostics) {
  const auto file = machine::read_toml(path, "a case base ([[case]], [groups], [similarity] ...)", diagnostics);
  diagnostics.throw_if_errors();
  TomlTable top = TomlTable::top(*file, diagnostics);
  CaseBase base;
  base.path = path;
  read_groups(top, base);
  read_similarity(top, base);
  read_modification(top, base);
  if (!top.has("case")) top.missing("[[case]]", "a table for each earlier job");
  for (TomlTable& table : top.tables("case")) base.cases.push_back(read_case(std::move(table)));
  top.finish();
  return base;
}

std::string to_toml(const Case& of) {
  const CaseContent& c = of.content;
  std::string out = "[[case]]\n" + machine::toml_line("material", c.material) + machine::toml_line("tool", c.tool) +
                    machine::toml_line("tool_material", c.tool_material);
  out += fmt::format("coated = {}\n", c.coated);
  out += machine::toml_line("finish", kFinishWords[c.fine ? 1 : 0]);
  out += machine::toml_line("machining", kMachiningWords[c.fast ? 1 : 0]);
  const auto number = [&](const char* key, double v) { out += fmt::format("{} = {:.6g}\n", key, v); };
  number("diameter_mm", c.diameter_mm);
  number("speed_m_per_min", of.speed_m_per_min);
  if (of.feed_mm_per_min) number("feed_mm_per_min", *of.feed_mm_per_min);
  if (of.axial_depth_mm) number("axial_depth_mm", *of.axial_depth_mm);
  if (of.radial_depth_mm) number("radial_depth_mm", *of.radial_depth_mm);
  return out;
}

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

/// Ratio of the usual or fast speeds of the materials' groups; 1 where one is not known.
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
