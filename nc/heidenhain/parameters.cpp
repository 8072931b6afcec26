#include "nc/heidenhain/parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/units.h"

namespace camber::nc::heidenhain {

std::string ParameterName::text() const {
  return kind == 'Q' ? fmt::format("Q{}", number) : fmt::format("Q{}{}", kind, number);
}

std::map<int, double>& Parameters::values_of(char kind) { return kind == 'L' ? local_.back() : kind == 'R' ? r_ : q_; }

double Parameters::value(const ParameterName& name, std::size_t offset) {
  auto& values = values_of(name.kind);
  if (const auto found = values.find(name.number); found != values.end()) {
    if (std::isnan(found->second))
      if (const auto why = unknown_.find(name); why != unknown_.end()) why_ = why->second;
    return found->second;
  }
  if (name.kind == 'Q' && system)
    if (const auto known = system(name.number)) {
      if (std::isnan(*known))
        why_ = fmt::format("{} is {}", name.text(),
                           name.number == 108   ? "the radius of the tool, which nothing gives"
                           : name.number == 114 ? "the length of the tool, which nothing gives"
                                                : "known to the machine alone");
      return *known;
    }
  throw FormulaError(offset, "undefined-parameter",
                     fmt::format("{} has no value here; FN 0 or {} = was expected before", name.text(), name.text()));
}

void Parameters::set(const ParameterName& name, double value) {
  values_of(name.kind)[name.number] = value;
  if (std::isnan(value))
    unknown_[name] = why_;
  else if (!unknown_.empty())
    unknown_.erase(name);
}

bool Parameters::is_defined(const ParameterName& name) const {
  if (name.kind == 'S') return texts_.contains(name.number);
  const auto& values = name.kind == 'L' ? local_.back() : name.kind == 'R' ? r_ : q_;
  return values.contains(name.number) || (name.kind == 'Q' && system && system(name.number));
}

void Parameters::set_unknown(const ParameterName& name, std::string why) {
  values_of(name.kind)[name.number] = std::numeric_limits<double>::quiet_NaN();
  unknown_[name] = std::move(why);
}

double Parameters::of_control(Cursor& at, const std::string& name) {
  while (at.more() && !at.accept(')')) at.advance();
  why_ = name + " is read from the control";
  return std::numeric_limits<double>::quiet_NaN();
}

const std::string& Parameters::text(int number) const {
  static const std::string kEmpty;
  const auto found = texts_.find(number);
  return found == texts_.end() ? kEmpty : found->second;
}

std::optional<ParameterName> read_parameter(Cursor& at) {
  if (at.peek() != 'Q') return std::nullopt;
  const std::size_t begin = at.offset();
  ParameterName name;
  at.advance();
  const char second = at.behind(0);
  if (second == 'L' || second == 'R' || second == 'S') {
    name.kind = second;
    at.advance();
  }
  while (at.behind(0) == ' ') at.advance();
  if (!is_digit(at.behind(0))) return at.go_to(begin), std::nullopt;
  const auto number = at.integer();
  if (!number) return at.go_to(begin), std::nullopt;
  name.number = *number;
  return name;
}

double read_value(Cursor& at, Parameters& parameters) {
  if (const auto number = at.number()) return *number;
  const std::size_t begin = at.offset();
  double sign = 1;
  if (at.accept('-'))
    sign = -1;
  else
    at.accept('+');
  if (const auto name = read_parameter(at)) return sign * parameters.value(*name, begin);
  throw FormulaError(begin, "expression",
                     fmt::format("{}: a number or a Q parameter was expected",
                                 at.more() ? at.word() : std::string("nothing follows")));
}

namespace {

/// SRC_QS1, SEA_QS2: `function` says whose argument it is.
const std::string& marked_text(Cursor& at, const Parameters& parameters, const char* mark, const char* function,
                               std::size_t begin) {
  const bool marked = at.accept_prefix(mark);
  const auto name = marked ? read_parameter(at) : std::nullopt;
  if (!name || name->kind != 'S')
    throw FormulaError(begin, "expression", fmt::format("{0} without {1}; {1}QS1 was expected", function, mark));
  return parameters.text(name->number);
}

/// A place or a length that a text has room for.
std::size_t place_in(const std::string& text, double value) {
  return static_cast<std::size_t>(std::clamp(value, 0.0, static_cast<double>(text.size())));
}

/// SUBSTR (SRC_QS1 BEG2 LEN4): the place counts from 0.
std::string part_of_text(Cursor& at, Parameters& parameters, std::size_t begin) {
  at.accept('(');
  const std::string& text = marked_text(at, parameters, "SRC_", "SUBSTR", begin);
  const std::size_t from = at.accept_prefix("BEG") ? place_in(text, read_value(at, parameters)) : 0;
  const std::size_t length = at.accept_prefix("LEN") ? place_in(text, read_value(at, parameters)) : text.size();
  at.accept(')');
  return text.substr(from, length);
}

class Formula {
 public:
  Formula(Cursor& at, Parameters& parameters) : at_(at), parameters_(parameters) {}

  double sum() {
    if (++depth_ > 200) throw FormulaError(at_.offset(), "expression", "a formula of more than 200 levels");
    double value = product();
    for (;;) {
      const char c = at_.peek();
      if (c == '+')
        at_.advance(), value += product();
      else if (c == '-')
        at_.advance(), value -= product();
      else
        break;
    }
    --depth_;
    return value;
  }

 private:
  double product() {
    double value = signed_power();
    for (;;) {
      const char c = at_.peek();
      const std::size_t here = at_.offset();
      if (c == '*') {
        at_.advance();
        value *= signed_power();
      } else if (c == '/') {
        at_.advance();
        value /= divisor(here);
      } else if (c == '%') {
        at_.advance();
        value = std::fmod(value, divisor(here));
      } else if (at_.accept("DIV")) {
        value /= divisor(here);
      } else {
        return value;
      }
    }
  }

  double divisor(std::size_t sign) {
    const double by = signed_power();
    if (by == 0) throw FormulaError(sign, "expression", "a division by zero");
    return by;
  }

  double signed_power() {
    if (++depth_ > 200) throw FormulaError(at_.offset(), "expression", "a formula of more than 200 levels");
    double value = 0;
    if (at_.accept('-'))
      value = -signed_power();
    else if (at_.accept('+'))
      value = signed_power();
    else
      value = power();
    --depth_;
    return value;
  }

  double power() {
    const double base = primary();
    if (!at_.accept('^')) return base;
    return std::pow(base, signed_power());
  }

  double primary() {
    const std::size_t begin = at_.offset();
    if (at_.accept('(')) {
      const double value = sum();
      if (!at_.accept(')')) throw FormulaError(begin, "expression", "the bracket ( is not closed; ) was expected");
      return value;
    }
    const char c = at_.peek();
    if (is_digit(c) || c == '.' || c == ',')
      if (const auto number = at_.number()) return *number;
    if (c == 'Q')
      if (const auto name = read_parameter(at_)) {
        if (name->kind == 'S') return to_number(parameters_.text(name->number), begin);
        return parameters_.value(*name, begin);
      }
    return function(begin);
  }

  static double to_number(const std::string& text, std::size_t begin) {
    Cursor at(text, 0, text.size());
    if (const auto number = at.number()) return *number;
    throw FormulaError(begin, "expression", fmt::format("\"{}\" is no number", text));
  }

  double function(std::size_t begin) {
    std::string name = at_.letters();
    // SINQ20: the parameter begins without a blank.
    if (const std::size_t q = name.find_last_of('Q');
        q != std::string::npos && q > 0 && name.size() - q <= 2 && name != "SQ" && is_digit(at_.behind(name.size())))
      name.erase(q);
    if (name.empty())
      throw FormulaError(begin, "expression",
                         fmt::format("{} in a formula; a number, a parameter or a function was expected",
                                     at_.more() ? at_.word() : std::string("nothing")));
    at_.advance(name.size());
    if (name == "PI") return kPi;
    if (name == "TONUMB") return tonumb(begin);
    if (name == "STRLEN") return strlen(begin);
    if (name == "STRCOMP") return strcomp(begin);
    if (name == "INSTR") return instr(begin);
    if (name == "CFGREAD" || name == "SYSSTR") return parameters_.of_control(at_, name);
    constexpr std::array<std::string_view, 16> kOfNumber{"SQ", "SQRT", "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN",
                                                         "LN", "LOG",  "EXP", "NEG", "ABS", "INT",  "FRAC", "SGN"};
    if (std::ranges::find(kOfNumber, name) == kOfNumber.end())
      throw FormulaError(begin, "expression",
                         fmt::format("{} is no function of a formula; {} or SGN was expected", name,
                                     fmt::join(kOfNumber.begin(), kOfNumber.end() - 1, ", ")));
    const double x = signed_power();
    if (name == "SQ") return x * x;
    if (name == "SQRT") {
      if (x < 0) throw FormulaError(begin, "expression", "the square root of a negative number");
      return std::sqrt(x);
    }
    if (name == "SIN") return sin_deg(x);
    if (name == "COS") return sin_deg(90 - x);
    if (name == "TAN") return std::tan(rad_from_deg(x));
    if (name == "ASIN" || name == "ACOS") {
      if (std::abs(x) > 1 + 1e-9) throw FormulaError(begin, "expression", fmt::format("{} of a number beyond 1", name));
      const double within = std::clamp(x, -1.0, 1.0);
      return deg_from_rad(name == "ASIN" ? std::asin(within) : std::acos(within));
    }
    if (name == "ATAN") return deg_from_rad(std::atan(x));
    if (name == "LN" || name == "LOG") {
      if (x <= 0) throw FormulaError(begin, "expression", fmt::format("{} of a number that is not positive", name));
      return name == "LN" ? std::log(x) : std::log10(x);
    }
    if (name == "EXP") return std::exp(x);
    if (name == "NEG") return -x;
    if (name == "ABS") return std::abs(x);
    if (name == "INT") return std::trunc(x);
    if (name == "FRAC") return x - std::trunc(x);
    return x > 0 ? 1 : x < 0 ? -1 : 0;  // SGN
  }

  /// Multiples of 90 degrees exactly.
  static double sin_deg(double degrees) {
    const double turn = std::fmod(degrees, 360.0);
    if (turn == 0 || std::abs(turn) == 180) return 0;
    if (turn == 90 || turn == -270) return 1;
    if (turn == -90 || turn == 270) return -1;
    return std::sin(rad_from_deg(turn));
  }

  double tonumb(std::size_t begin) {
    at_.accept('(');
    const std::string& text = marked_text(at_, parameters_, "SRC_", "TONUMB", begin);
    at_.accept(')');
    return to_number(text, begin);
  }

  /// 0: the same; -1: the first one stands before the second in the alphabet.
  double strcomp(std::size_t begin) {
    at_.accept('(');
    const std::string& first = marked_text(at_, parameters_, "SRC_", "STRCOMP", begin);
    const std::string& second = marked_text(at_, parameters_, "SEA_", "STRCOMP", begin);
    at_.accept(')');
    return first == second ? 0 : first < second ? -1 : 1;
  }

  /// The place of the second text in the first, from 0; the length of the first where it is not in there.
  double instr(std::size_t begin) {
    at_.accept('(');
    const std::string& text = marked_text(at_, parameters_, "SRC_", "INSTR", begin);
    const std::string& wanted = marked_text(at_, parameters_, "SEA_", "INSTR", begin);
    const std::size_t from = at_.accept_prefix("BEG") ? place_in(text, read_value(at_, parameters_)) : 0;
    at_.accept(')');
    return static_cast<double>(std::min(text.find(wanted, from), text.size()));
  }

  double strlen(std::size_t begin) {
    at_.accept('(');
    at_.accept_prefix("SRC_");
    const auto name = read_parameter(at_);
    if (!name || name->kind != 'S') throw FormulaError(begin, "expression", "STRLEN without a QS parameter");
    at_.accept(')');
    return static_cast<double>(parameters_.text(name->number).size());
  }

  Cursor& at_;
  Parameters& parameters_;
  int depth_ = 0;
};

}  // namespace

double read_formula(Cursor& at, Parameters& parameters) { return Formula(at, parameters).sum(); }

bool is_text(Cursor& at) { return at.peek() == '"' || (at.peek() == 'Q' && at.behind(1) == 'S'); }

std::string read_text_formula(Cursor& at, Parameters& parameters) {
  std::string out;
  for (;;) {
    const std::size_t begin = at.offset();
    if (auto text = at.quoted()) {
      out += *text;
    } else if (at.peek() == 'Q') {
      const auto name = read_parameter(at);
      if (!name) throw FormulaError(begin, "expression", "a text in quotes or a QS parameter was expected");
      out += name->kind == 'S' ? parameters.text(name->number) : fmt::format("{}", parameters.value(*name, begin));
    } else if (at.accept("SUBSTR")) {
      out += part_of_text(at, parameters, begin);
    } else if (at.accept("SYSSTR") || at.accept("CFGREAD")) {
      parameters.of_control(at, "the text");
      out += '\0';
    } else if (at.accept("TOCHAR")) {
      at.accept('(');
      if (!at.accept_prefix("DAT")) throw FormulaError(begin, "expression", "TOCHAR without DAT; DAT+Q1 was expected");
      const double value = read_value(at, parameters);
      int decimals = 0;
      if (at.accept_prefix("DECIMALS")) decimals = at.integer().value_or(0);
      at.accept(')');
      out += fmt::format("{:.{}f}", value, std::min(decimals, 15));
    } else {
      throw FormulaError(begin, "not-supported",
                         fmt::format("{} in a text formula is not supported; texts in quotes, QS parameters, ||, "
                                     "SUBSTR and TOCHAR were expected",
                                     at.more() ? at.word() : std::string("nothing")));
    }
    if (!(at.peek() == '|' && at.behind(1) == '|')) return out;
    at.advance(2);
  }
}

}  // namespace camber::nc::heidenhain
