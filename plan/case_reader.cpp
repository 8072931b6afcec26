// case_base.toml, in and out.
#include <fmt/format.h>

#include "machine/number_key.h"
#include "machine/toml_table.h"
#include "plan/cases.h"
#include "plan/plan_words.h"

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

}  // namespace camber::plan
