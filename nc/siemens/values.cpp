#include "nc/siemens/values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/numbers.h"
#include "base/units.h"
#include "nc/frames.h"

namespace camber::nc::siemens {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxParameter = 32535;
constexpr std::size_t kMaxElements = 1'000'000;
constexpr std::size_t kMaxText = 10'000;
/// Relative difference up to which numbers count as equal (Job Planning, "Precision correction on comparison errors").
constexpr double kSame = 1e-12;

Value text_value(std::string text) {
  if (text.size() > kMaxText) text.resize(kMaxText);
  return {0, std::make_shared<const std::string>(std::move(text)), {}};
}

std::string text_of(const Value& value) {
  if (value.text) return *value.text;
  if (std::isnan(value.number)) return "?";
  return fmt::format("{:.10g}", value.number);
}

bool same(double a, double b) { return a == b || std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b)); }

std::int64_t whole(double number) { return static_cast<std::int64_t>(std::clamp(std::trunc(number), -9e15, 9e15)); }

/// ROUND, and what an INT takes of a REAL.
double rounded_half(double number) { return std::floor(number + 0.5); }

int axis_of(const std::string& name) { return name == "X" ? 0 : name == "Y" ? 1 : name == "Z" ? 2 : -1; }

}  // namespace

// --- variables

std::shared_ptr<Variable> Evaluator::variable(std::uint32_t name) const {
  return name < level_->variables.size() ? level_->variables[name] : nullptr;
}

std::shared_ptr<Variable> Evaluator::whole_variable(std::uint32_t index) const {
  const Node& n = node(index);
  return n.kind == NodeKind::variable && n.count == 0 ? variable(n.name) : nullptr;
}

double& Evaluator::parameter(double number, std::size_t offset) {
  if (!(number >= 0 && number <= kMaxParameter) || number != std::floor(number))
    throw RunError(
        offset, "variable",
        fmt::format("R[{:g}] is no R parameter; a whole number up to {:g} was expected", number, kMaxParameter));
  const auto index = static_cast<std::size_t>(number);
  if (index >= r_.size()) r_.resize(index + 1, 0.0);
  return r_[index];
}

std::size_t Evaluator::element(const Variable& variable, std::uint32_t first, std::uint32_t count, std::size_t offset) {
  if (count != variable.dimensions)
    throw RunError(offset, "variable",
                   fmt::format("{} indexes for an array of {} dimensions", count, variable.dimensions));
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double index = rounded_half(known_number(tree_->arguments[first + i], "an index"));
    if (!(index >= 0 && index < variable.size[i]))
      throw RunError(offset, "variable",
                     fmt::format("index {:g} is outside the array; 0 to {} was expected", index, variable.size[i] - 1));
    at = at * variable.size[i] + static_cast<std::size_t>(index);
  }
  return at;
}

Value Evaluator::converted(const Value& value, ValueType type, std::size_t offset) const {
  const auto refuse = [&](const char* expected) {
    throw RunError(offset, "type",
                   fmt::format("{} is assigned to a variable of type {}",
                               value.text    ? "a text"
                               : value.frame ? "a frame"
                                             : "a number",
                               expected));
  };
  switch (type) {
    case ValueType::real:
      if (value.text || value.frame) refuse("REAL");
      return value;
    case ValueType::integer:
      if (value.frame) refuse("INT");
      if (value.text)
        return value.text->size() == 1 ? Value{static_cast<double>((*value.text)[0]), {}, {}} : (refuse("INT"), value);
      return {rounded_half(value.number), {}, {}};
    case ValueType::boolean:
      if (value.text || value.frame) refuse("BOOL");
      return {std::isnan(value.number) ? value.number : value.number != 0 ? 1.0 : 0.0, {}, {}};
    case ValueType::text:
      if (value.frame) refuse("STRING");
      return value.text ? value : text_value(text_of(value));
    case ValueType::frame:
      if (!value.frame) refuse("FRAME");
      return value;
    case ValueType::axis:
      break;
  }
  return value;
}

void Evaluator::declare(const Declared& declared) {
  auto made = std::make_shared<Variable>();
  made->type = declared.type;
  made->dimensions = declared.dimensions;
  std::size_t count = 1;
  for (std::uint32_t i = 0; i < declared.dimensions; ++i) {
    const double size =
        declared.dimension[i] == kNone ? 0 : known_number(declared.dimension[i], "the size of an array");
    if (!(size >= 1) || size * static_cast<double>(count) > kMaxElements)
      throw RunError(declared.offset, "variable",
                     fmt::format("an array of size {:g}; 1 to {} elements were expected", size, kMaxElements));
    made->size[i] = static_cast<std::uint32_t>(size);
    count *= made->size[i];
  }
  Value initial;
  if (declared.type == ValueType::text || declared.type == ValueType::axis) initial = text_value({});
  if (declared.type == ValueType::frame) initial.frame = std::make_shared<const Affine>();
  if (declared.value != kNone) initial = converted(value(declared.value), declared.type, declared.offset);
  made->values.assign(count, initial);
  for (std::size_t i = 0; i < declared.values.size() && i < count; ++i)
    if (declared.values[i] != kNone)
      made->values[i] = converted(value(declared.values[i]), declared.type, declared.offset);
  if (level_->variables.size() < tree_->names.size()) level_->variables.resize(tree_->names.size());
  level_->variables[declared.name] = std::move(made);
}

void Evaluator::assign(const Item& item) {
  const std::string& name = tree_->names[item.name];
  const Node& right = node(item.value);
  const bool list =
      right.kind == NodeKind::call && (tree_->names[right.name] == "SET" || tree_->names[right.name] == "REP");
  if (name == "R") {
    const double number = known_number(tree_->arguments[item.first], "the number of an R parameter");
    const Value given = value(item.value);
    if (given.text || given.frame)
      throw RunError(item.offset, "type", "a text or frame is assigned to an R parameter; a number was expected");
    parameter(number, item.offset) = given.number;
    return;
  }
  const auto target = variable(item.name);
  if (!target)
    throw RunError(item.offset, "variable",
                   fmt::format("{} is not declared here; DEF REAL {} or the like was expected before", name, name));
  if (list) {
    std::size_t at = item.count == 0 ? 0 : element(*target, item.first, item.count, item.offset);
    const bool repeated = tree_->names[right.name] == "REP";
    for (std::uint32_t i = 0; at < target->count() && right.count > 0; ++at) {
      const std::uint32_t which = tree_->argument(right, i);
      if (which != kNone) target->values[at] = converted(value(which), target->type, item.offset);
      if (!repeated && ++i == right.count) break;
    }
    return;
  }
  const std::size_t at = element(*target, item.first, item.count, item.offset);
  target->values[at] = converted(value(item.value), target->type, item.offset);
}

void Evaluator::set_by_node(std::uint32_t index, const Value& given) {
  const Node& n = node(index);
  if (n.kind == NodeKind::parameter) {
    parameter(known_number(tree_->argument(n, 0), "the number of an R parameter"), n.offset) = given.number;
  } else if (n.kind == NodeKind::variable) {
    if (const auto target = variable(n.name))
      target->values[element(*target, n.first, n.count, n.offset)] = converted(given, target->type, n.offset);
  }
}

// --- expressions

void Evaluator::unknown(std::size_t offset, std::string_view what) const {
  throw RunError(offset, "unknown-value",
                 fmt::format("{} depends on {}, which is not known outside the machine; a value was expected", what,
                             unknown_name_.empty() ? "a value" : unknown_name_));
}

double Evaluator::number(std::uint32_t index) {
  const Node& n = node(index);
  if (n.kind == NodeKind::number) return n.number;
  const Value v = value(index);
  if (v.text || v.frame)
    throw RunError(n.offset, "type", fmt::format("a {} where a number was expected", v.text ? "text" : "frame"));
  return v.number;
}

double Evaluator::known_number(std::uint32_t index, std::string_view what) {
  const double out = number(index);
  if (std::isnan(out)) unknown(node(index).offset, what);
  return out;
}

bool Evaluator::is_undeclared(std::uint32_t index) const {
  const Node& n = node(index);
  return n.kind == NodeKind::variable && n.count == 0 && tree_->names[n.name].size() > 2 && !variable(n.name);
}

std::string Evaluator::text(std::uint32_t index) { return text_of(value(index)); }

bool Evaluator::truth(std::uint32_t index) {
  const double out = number(index);
  if (std::isnan(out)) unknown(node(index).offset, "the condition");
  return out != 0;
}

std::string Evaluator::axis_name(std::uint32_t index) {
  const Node& n = node(index);
  if (n.kind == NodeKind::variable && n.count == 0 && !variable(n.name)) return tree_->names[n.name];
  return text(index);
}

/// A name of the control in the second value of CYCLE832; its ones are the kind of machining.
static std::optional<double> cycle832_kind(std::string_view name) {
  constexpr std::array<std::string_view, 5> kKinds{"_OFF", "_FINISH", "_SEMIFIN", "_ROUGH", "_PRECISION"};
  if (name == "_TOP_SURFACE_SMOOTH_ON" || name == "_TOP_SURFACE_SMOOTH_OFF") return 0;
  const auto found = std::ranges::find(kKinds, name.starts_with("_ORI_") ? name.substr(4) : name);
  return found == kKinds.end() ? std::nullopt : std::optional<double>(found - kKinds.begin());
}

Value Evaluator::value(std::uint32_t index) {
  const Node& n = node(index);
  if (depth_ > 200) throw RunError(n.offset, "expression", "an expression too deep to evaluate");
  struct Deeper {
    int& depth;
    explicit Deeper(int& d) : depth(d) { ++depth; }
    ~Deeper() { --depth; }
  } const deeper(depth_);
  switch (n.kind) {
    case NodeKind::number:
      return {n.number, {}, {}};
    case NodeKind::text:
      return text_value(tree_->texts[n.name]);
    case NodeKind::parameter:
      return {parameter(known_number(tree_->argument(n, 0), "the number of an R parameter"), n.offset), {}, {}};
    case NodeKind::variable: {
      const auto found = variable(n.name);
      if (!found) {
        const std::string& name = tree_->names[n.name];
        if (name.size() <= 2) return text_value(name);  // an axis
        if (const auto kind = cycle832_kind(name)) return {*kind, {}, {}};
        throw RunError(n.offset, "variable", fmt::format("{} is not declared here; DEF was expected before", name));
      }
      if (n.count == 0 && found->dimensions > 0)
        throw RunError(n.offset, "variable",
                       fmt::format("{} is an array; an index was expected", tree_->names[n.name]));
      return found->values[element(*found, n.first, n.count, n.offset)];
    }
    case NodeKind::system:
      return system(n);
    case NodeKind::call:
      return call(n);
    case NodeKind::negate:
      return {-number(tree_->argument(n, 0)), {}, {}};
    case NodeKind::plus:
      return {number(tree_->argument(n, 0)), {}, {}};
    case NodeKind::logical_not: {
      const double v = number(tree_->argument(n, 0));
      return {std::isnan(v) ? v : v == 0 ? 1.0 : 0.0, {}, {}};
    }
    case NodeKind::bit_not:
      return {static_cast<double>(~whole(known_number(tree_->argument(n, 0), "B_NOT"))), {}, {}};
    default:
      return binary(n);
  }
}

Value Evaluator::binary(const Node& n) {
  const std::uint32_t left = tree_->argument(n, 0), right = tree_->argument(n, 1);
  const auto truth_value = [](bool b) { return Value{b ? 1.0 : 0.0, {}, {}}; };
  if (n.kind == NodeKind::join) return text_value(text(left) + text(right));
  if (n.kind == NodeKind::chain) {
    const Value a = value(left), b = value(right);
    if (!a.frame || !b.frame)
      throw RunError(n.offset, "type", "`:` chains frames; CTRANS, CROT and the like were expected");
    return {0, {}, std::make_shared<const Affine>(a.frame->then_inside(*b.frame))};
  }
  if (n.kind >= NodeKind::equal && n.kind <= NodeKind::greater_equal) {
    const Value a = value(left), b = value(right);
    if (a.text && b.text) {
      const int order = a.text->compare(*b.text);
      switch (n.kind) {
        case NodeKind::equal:
          return truth_value(order == 0);
        case NodeKind::not_equal:
          return truth_value(order != 0);
        case NodeKind::less:
          return truth_value(order < 0);
        case NodeKind::greater:
          return truth_value(order > 0);
        case NodeKind::less_equal:
          return truth_value(order <= 0);
        default:
          return truth_value(order >= 0);
      }
    }
    if (a.text || b.text || a.frame || b.frame)
      throw RunError(n.offset, "type", "a text is compared with a number; two of a kind were expected");
    if (std::isnan(a.number) || std::isnan(b.number)) return {kUnknown, {}, {}};
    const bool equal = same(a.number, b.number);
    switch (n.kind) {
      case NodeKind::equal:
        return truth_value(equal);
      case NodeKind::not_equal:
        return truth_value(!equal);
      case NodeKind::less:
        return truth_value(a.number < b.number && !equal);
      case NodeKind::greater:
        return truth_value(a.number > b.number && !equal);
      case NodeKind::less_equal:
        return truth_value(a.number < b.number || equal);
      default:
        return truth_value(a.number > b.number || equal);
    }
  }
  const double a = number(left), b = number(right);
  if (std::isnan(a) || std::isnan(b)) return {kUnknown, {}, {}};
  double out = 0;
  switch (n.kind) {
    case NodeKind::add:
      out = a + b;
      break;
    case NodeKind::subtract:
      out = a - b;
      break;
    case NodeKind::multiply:
      out = a * b;
      break;
    case NodeKind::divide:
    case NodeKind::whole_divide:
      if (b == 0) throw RunError(n.offset, "expression", "a division by zero");
      out = n.kind == NodeKind::divide ? a / b : std::trunc(a / b);
      break;
    case NodeKind::modulo:
      if (whole(b) == 0) throw RunError(n.offset, "expression", "MOD by zero");
      out = static_cast<double>(whole(a) % whole(b));
      break;
    case NodeKind::bit_and:
      out = static_cast<double>(whole(a) & whole(b));
      break;
    case NodeKind::bit_or:
      out = static_cast<double>(whole(a) | whole(b));
      break;
    case NodeKind::bit_xor:
      out = static_cast<double>(whole(a) ^ whole(b));
      break;
    case NodeKind::logical_and:
      return truth_value(a != 0 && b != 0);
    case NodeKind::logical_or:
      return truth_value(a != 0 || b != 0);
    case NodeKind::logical_xor:
      return truth_value((a != 0) != (b != 0));
    default:
      break;
  }
  if (!std::isfinite(out)) throw RunError(n.offset, "expression", "the result is too large a number");
  return {out, {}, {}};
}

Value Evaluator::system(const Node& n) {
  std::vector<Value> indexes;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < n.count; ++i) {
    const std::uint32_t argument = tree_->argument(n, i);
    const Node& a = node(argument);
    const bool bare = a.kind == NodeKind::variable && a.count == 0 && !variable(a.name);
    names.push_back(bare ? tree_->names[a.name] : std::string());
    indexes.push_back(bare ? Value{} : value(argument));
    if (!bare && indexes.back().text) names.back() = *indexes.back().text;
  }
  if (const auto found = system_.system_value(tree_->names[n.name], indexes, names)) return *found;
  unknown_name_ = tree_->names[n.name];
  return {kUnknown, {}, {}};
}

Value Evaluator::call(const Node& n) {
  const std::string& name = tree_->names[n.name];
  if (name.size() >= 4 && name[0] == 'C' &&
      (name == "CTRANS" || name == "CROT" || name == "CSCALE" || name == "CMIRROR" || name == "CRPL"))
    return frame_function(n, name);
  if (!find_function(name)) {
    unknown_name_ = name;
    return {kUnknown, {}, {}};
  }
  const auto argument = [&](std::uint32_t i) {
    const std::uint32_t at = i < n.count ? tree_->argument(n, i) : kNone;
    if (at == kNone) throw RunError(n.offset, "function", fmt::format("{} lacks a value", name));
    return at;
  };
  if (name == "ISVAR") {
    const Value v = value(argument(0));
    return {v.text ? 0.0 : 1.0, {}, {}};
  }
  if (name == "AXNAME") return value(argument(0));
  if (name == "STRLEN") return {static_cast<double>(text(argument(0)).size()), {}, {}};
  if (name == "TOUPPER" || name == "TOLOWER") {
    std::string t = text(argument(0));
    for (char& c : t)
      c = static_cast<char>(name == "TOUPPER" ? std::toupper(static_cast<unsigned char>(c))
                                              : std::tolower(static_cast<unsigned char>(c)));
    return text_value(std::move(t));
  }
  if (name == "NUMBER" || name == "ISNUMBER") {
    const auto parsed = parse_number(text(argument(0)));
    if (name == "ISNUMBER") return {parsed ? 1.0 : 0.0, {}, {}};
    if (!parsed) throw RunError(n.offset, "function", "NUMBER of a text that is no number");
    return {*parsed, {}, {}};
  }
  if (name == "INDEX" || name == "RINDEX" || name == "MINDEX") {
    const std::string t = text(argument(0)), wanted = text(argument(1));
    const std::size_t at = name == "RINDEX"  ? t.rfind(wanted)
                           : name == "INDEX" ? t.find(wanted)
                                             : t.find_first_of(wanted);
    return {at == std::string::npos ? -1.0 : static_cast<double>(at), {}, {}};
  }
  if (name == "SUBSTR") {
    const std::string t = text(argument(0));
    const double from = known_number(argument(1), "SUBSTR");
    if (!(from >= 0 && from <= static_cast<double>(t.size()))) return text_value({});
    const double count = n.count > 2 ? known_number(argument(2), "SUBSTR") : 1e9;
    return text_value(t.substr(static_cast<std::size_t>(from), static_cast<std::size_t>(std::clamp(count, 0.0, 1e9))));
  }
  const double a = number(argument(0));
  const double b = n.count > 1 ? number(argument(1)) : 0, c = n.count > 2 ? number(argument(2)) : 0;
  if (std::isnan(a) || std::isnan(b) || std::isnan(c)) return {kUnknown, {}, {}};
  const auto in_range = [&](bool good, const char* expected) {
    if (!good) throw RunError(n.offset, "function", fmt::format("{}({:g}); {} was expected", name, a, expected));
  };
  double out = 0;
  if (name == "SIN" || name == "COS") {
    // Quarter turns exactly.
    const double quarters = a / 90, turns = std::round(quarters);
    if (quarters == turns && std::abs(turns) < 1e9) {
      const int q = ((static_cast<int>(std::fmod(turns, 4)) + 4) % 4 + (name == "COS" ? 1 : 0)) % 4;
      out = q == 1 ? 1 : q == 3 ? -1 : 0;
    } else {
      out = name == "SIN" ? std::sin(rad_from_deg(a)) : std::cos(rad_from_deg(a));
    }
  } else if (name == "TAN") {
    out = std::tan(rad_from_deg(a));
  } else if (name == "ASIN" || name == "ACOS") {
    in_range(std::abs(a) <= 1, "-1 to 1");
    out = deg_from_rad(name == "ASIN" ? std::asin(a) : std::acos(a));
  } else if (name == "ATAN2" || name == "ATAN") {
    out = deg_from_rad(n.count > 1 ? std::atan2(a, b) : std::atan(a));
  } else if (name == "SQRT") {
    in_range(a >= 0, "zero or more");
    out = std::sqrt(a);
  } else if (name == "ABS") {
    out = std::abs(a);
  } else if (name == "POT") {
    out = a * a;
  } else if (name == "TRUNC") {
    out = std::trunc(a);
  } else if (name == "ROUND") {
    out = rounded_half(a);
  } else if (name == "ROUNDUP") {
    out = std::ceil(a);
  } else if (name == "LN") {
    in_range(a > 0, "more than zero");
    out = std::log(a);
  } else if (name == "EXP") {
    out = std::exp(a);
  } else if (name == "MINVAL") {
    out = std::min(a, b);
  } else if (name == "MAXVAL") {
    out = std::max(a, b);
  } else if (name == "BOUND") {
    out = std::min(std::max(c, a), b);
  } else if (name == "QU" || name == "AC" || name == "IC") {
    out = a;
  } else {
    throw RunError(n.offset, "not-supported", fmt::format("{} is not supported in expressions", name));
  }
  if (!std::isfinite(out)) throw RunError(n.offset, "expression", "the result is too large a number");
  return {out, {}, {}};
}

/// CTRANS(X,10,Y,20), CROT(Z,45), CSCALE, CMIRROR(X), CRPL(0,45).
Value Evaluator::frame_function(const Node& n, const std::string& name) {
  Affine out;
  if (name == "CRPL") {
    const double plane = known_number(tree_->argument(n, 0), name), angle = known_number(tree_->argument(n, 1), name);
    out.linear = rotation_in(plane == 1 ? Plane::zx : plane == 2 ? Plane::yz : Plane::xy, rad_from_deg(angle));
    return {0, {}, std::make_shared<const Affine>(out)};
  }
  Vec3 angles = Vec3::Zero();
  for (std::uint32_t i = 0; i < n.count;) {
    const std::uint32_t at = tree_->argument(n, i++);
    const int axis = at == kNone ? -1 : axis_of(axis_name(at));
    if (axis < 0) throw RunError(n.offset, "function", fmt::format("{} of an axis other than X, Y, Z", name));
    if (name == "CMIRROR") {
      out.linear(axis, axis) = -1;
      continue;
    }
    if (i >= n.count || tree_->argument(n, i) == kNone)
      throw RunError(n.offset, "function", fmt::format("{} lacks a value", name));
    const double v = known_number(tree_->argument(n, i++), name);
    if (name == "CTRANS") out.shift_mm[axis] = v * system_.unit_mm();
    if (name == "CSCALE") out.linear(axis, axis) = v;
    if (name == "CROT") angles[axis] = rad_from_deg(v);
  }
  if (name == "CROT")
    out.linear =
        rotation_in(Plane::xy, angles.z()) * rotation_in(Plane::zx, angles.y()) * rotation_in(Plane::yz, angles.x());
  if (name == "CSCALE" && out.linear.determinant() == 0) throw RunError(n.offset, "scaling", "CSCALE by zero");
  return {0, {}, std::make_shared<const Affine>(out)};
}

}  // namespace camber::nc::siemens
