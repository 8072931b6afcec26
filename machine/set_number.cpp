#include "machine/set_number.h"

#include <fmt/format.h>

#include "machine/machine_keys.h"

namespace camber::machine {
namespace {

/// Calls visit(table, key list, struct of the machine) for every table of numbers.
template <class Visit>
void for_each_table(Machine& machine, const Visit& visit) {
  visit(std::string("control"), std::span(kControlKeys), machine.control);
  visit(std::string("control.corner"), std::span(kCornerKeys), machine.control.corner);
  for (std::size_t i = 0; i < machine.axis.size(); ++i)
    visit(fmt::format("axis.{}", kAxisNames[i]), std::span(kAxisKeys), machine.axis[i]);
  for (std::size_t i = 0; i < machine.rotary.size(); ++i)
    visit(fmt::format("axis.{}", kRotaryAxisNames[i]), std::span(kRotaryAxisKeys), machine.rotary[i]);
  visit(std::string("spindle"), std::span(kSpindleKeys), machine.spindle);
  visit(std::string("cycle"), std::span(kCycleKeys), machine.cycle);
  visit(std::string("tool_change"), std::span(kToolChangeKeys), machine.tool_change);
  for (std::size_t i = 0; i < machine.reference_points.size(); ++i)
    visit(fmt::format("reference_point.{}", kReferencePointNames[i]), std::span(kReferencePointKeys),
          machine.reference_points[i]);
  visit(std::string("index"), std::span(kIndexKeys), machine.index);
}

}  // namespace

std::string set_number(Machine& machine, std::string_view key, double value) {
  constexpr std::string_view kAll = "axis.all.";
  if (key.starts_with(kAll)) {
    for (const std::string_view axis : kAxisNames) {
      std::string wrong = set_number(machine, fmt::format("axis.{}.{}", axis, key.substr(kAll.size())), value);
      if (!wrong.empty()) return wrong;
    }
    return {};
  }
  bool found = false;
  std::string wrong;
  for_each_table(machine, [&](const std::string& table, const auto& keys, auto& into) {
    for (const auto& k : keys) {
      if (found || key != fmt::format("{}.{}", table, k.key)) continue;
      found = true;
      if (!k.range.holds(value))
        wrong = fmt::format("{} is {}; {} was expected", key, value, k.range.wanted());
      else
        into.*k.field = k.unit.inside_from_file(value);
    }
  });
  if (found) return wrong;
  const std::string near = nearest_word(key, number_keys());
  return fmt::format("{} is not a machine parameter{}", key,
                     near.empty() ? "; a key such as axis.x.acceleration_mm_per_s2 was expected"
                                  : fmt::format("; did you mean {}?", near));
}

std::optional<double> number_of(const Machine& machine, std::string_view key) {
  std::optional<double> found;
  Machine copy = machine;
  for_each_table(copy, [&](const std::string& table, const auto& keys, auto& from) {
    for (const auto& k : keys)
      if (!found && key == fmt::format("{}.{}", table, k.key)) found = k.unit.file_from_inside(from.*k.field);
  });
  return found;
}

std::vector<std::string> number_keys() {
  std::vector<std::string> out;
  Machine machine;
  for_each_table(machine, [&](const std::string& table, const auto& keys, auto&) {
    for (const auto& k : keys) out.push_back(fmt::format("{}.{}", table, k.key));
  });
  return out;
}

}  // namespace camber::machine
