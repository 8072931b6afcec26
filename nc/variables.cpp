#include "nc/variables.h"

#include <cmath>

#include <fmt/format.h>

#include "nc/system_variables.h"

namespace camber::nc {

Variables::Scope Variables::place_of(double number, std::size_t offset) const {
  if (number != std::floor(number) || std::abs(number) > 1e9)
    throw MacroError(offset, "variable", fmt::format("#{}: the number of a variable is not a whole one", number));
  if (dialect_.local.holds(number)) return Scope::local;
  for (const NumberRange& range : dialect_.common)
    if (range.holds(number) && !system_.owns(static_cast<int>(number))) return Scope::common;
  return Scope::system;
}

Value Variables::get(double number, std::size_t offset) {
  if (number == 0 && dialect_.has_null) return std::nullopt;
  const Value vacant = dialect_.has_null ? Value() : Value(0.0);
  switch (place_of(number, offset)) {
    case Scope::local: {
      const Value value = levels_.back().numbered[static_cast<std::size_t>(number)];
      return value ? value : vacant;
    }
    case Scope::common: {
      const auto found = common_.find(static_cast<int>(number));
      return found != common_.end() ? Value(found->second) : vacant;
    }
    case Scope::system:
      break;
  }
  return system_.get(static_cast<int>(number), offset);
}

Value Variables::get(const std::string& name, std::size_t offset) {
  const auto& names = name.front() == '_' ? global_ : levels_.back().named;
  const auto found = names.find(name);
  if (found != names.end()) return found->second;
  if (const Value predefined = system_.get(name)) return predefined;
  throw MacroError(offset, "variable", fmt::format("#<{}> was never set; a value was expected before", name));
}

bool Variables::known(double number) {
  if (!dialect_.local.holds(number)) return number > 0;
  return levels_.back().numbered[static_cast<std::size_t>(number)].has_value();
}

bool Variables::known(const std::string& name) {
  const auto& names = name.front() == '_' ? global_ : levels_.back().named;
  return names.count(name) > 0 || system_.get(name).has_value();
}

void Variables::set(double number, Value value, std::size_t offset) {
  if (number == 0) throw MacroError(offset, "variable", "#0 cannot be set");
  switch (place_of(number, offset)) {
    case Scope::local:
      levels_.back().numbered[static_cast<std::size_t>(number)] = value;
      return;
    case Scope::common:
      if (value)
        common_[static_cast<int>(number)] = *value;
      else
        common_.erase(static_cast<int>(number));
      return;
    case Scope::system:
      system_.set(static_cast<int>(number), value, offset);
  }
}

void Variables::set(const std::string& name, Value value, std::size_t offset) {
  if (name.front() == '_' && system_.get(name) && !system_.may_be_set(name))
    throw MacroError(offset, "variable", fmt::format("#<{}> belongs to the control and cannot be set", name));
  (name.front() == '_' ? global_ : levels_.back().named)[name] = value.value_or(0);
}

}  // namespace camber::nc
