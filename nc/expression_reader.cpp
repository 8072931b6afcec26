// Text to postfix form.
#include <array>

#include <fmt/format.h>

#include "base/numbers.h"
#include "nc/expression.h"

namespace camber::nc {
namespace {

constexpr int kMaxDepth = 100;  ///< brackets in brackets; controls stop at 5 to 10

struct Spelling {
  std::string_view text;
  Op op;
  bool abbreviated = false;  ///< its first two letters, as Fanuc accepts them
};

/// The longer of two that begin alike comes first.
constexpr std::array kFunctions{
    Spelling{"ASIN", Op::arc_sine},
    Spelling{"ACOS", Op::arc_cosine},
    Spelling{"ATAN", Op::arc_tangent},
    Spelling{"SIN", Op::sine},
    Spelling{"COS", Op::cosine},
    Spelling{"TAN", Op::tangent},
    Spelling{"SQRT", Op::square_root},
    Spelling{"SQR", Op::square_root},
    Spelling{"ABS", Op::absolute},
    Spelling{"ROUND", Op::round},
    Spelling{"RND", Op::round},
    Spelling{"FIX", Op::fix},
    Spelling{"FUP", Op::fup},
    Spelling{"LN", Op::logarithm},
    Spelling{"EXP", Op::exponential},
    Spelling{"EXISTS", Op::name_known},
    Spelling{"POW", Op::power},
    Spelling{"BIN", Op::from_bcd},
    Spelling{"BCD", Op::to_bcd},
    Spelling{"NOT", Op::logic_not},
    Spelling{"AS", Op::arc_sine, true},
    Spelling{"AC", Op::arc_cosine, true},
    Spelling{"AT", Op::arc_tangent, true},
    Spelling{"SI", Op::sine, true},
    Spelling{"CO", Op::cosine, true},
    Spelling{"TA", Op::tangent, true},
    Spelling{"SQ", Op::square_root, true},
    Spelling{"AB", Op::absolute, true},
    Spelling{"RO", Op::round, true},
    Spelling{"FI", Op::fix, true},
    Spelling{"FU", Op::fup, true},
    Spelling{"EX", Op::exponential, true},
    Spelling{"PO", Op::power, true},
    Spelling{"BI", Op::from_bcd, true},
    Spelling{"BC", Op::to_bcd, true},
};
constexpr std::array kOperators{
    Spelling{"**", Op::power},           Spelling{"*", Op::multiply},
    Spelling{"/", Op::divide},           Spelling{"+", Op::add},
    Spelling{"-", Op::subtract},         Spelling{"MOD", Op::modulo},
    Spelling{"AND", Op::logic_and},      Spelling{"XOR", Op::logic_xor},
    Spelling{"OR", Op::logic_or},        Spelling{"EQ", Op::equal},
    Spelling{"NE", Op::not_equal},       Spelling{"GT", Op::greater},
    Spelling{"GE", Op::greater_equal},   Spelling{"LT", Op::less},
    Spelling{"LE", Op::less_equal},      Spelling{"AN", Op::logic_and, true},
    Spelling{"XO", Op::logic_xor, true}, Spelling{"MO", Op::modulo, true},
};

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool stands_at(std::string_view text, std::size_t at, std::size_t end, std::string_view word) {
  if (end - at < word.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (upper(text[at + i]) != word[i]) return false;
  return true;
}

}  // namespace

void ExpressionReader::skip_blanks() {
  while (at_ < end_ && is_blank(text_[at_])) ++at_;
}

char ExpressionReader::peek() {
  skip_blanks();
  return at_ < end_ ? text_[at_] : '\0';
}

void ExpressionReader::push(Op op, std::size_t offset, double operand) {
  out_.ops.push_back({op, static_cast<std::uint32_t>(offset), operand});
}

void ExpressionReader::expect(char c, std::string_view where) {
  if (peek() != c) throw MacroError(at_, "expression", fmt::format("`{}` was expected {}", c, where));
  ++at_;
}

std::optional<Op> ExpressionReader::function_here(std::size_t& length, bool* abbreviated) const {
  for (const Spelling& s : kFunctions) {
    if (!stands_at(text_, at_, end_, s.text)) continue;
    std::size_t i = at_ + s.text.size();
    while (i < end_ && is_blank(text_[i])) ++i;
    if (i >= end_ || text_[i] != '[') continue;
    length = s.text.size();
    if (abbreviated) *abbreviated = s.abbreviated;
    return s.op;
  }
  return std::nullopt;
}

std::optional<Op> ExpressionReader::operator_here(std::size_t& length, bool* abbreviated) const {
  for (const Spelling& s : kOperators) {
    if (!stands_at(text_, at_, end_, s.text)) continue;
    length = s.text.size();
    if (abbreviated) *abbreviated = s.abbreviated;
    return s.op;
  }
  return std::nullopt;
}

int ExpressionReader::priority(Op op) const {
  switch (op) {
    case Op::power:
      return 6;
    case Op::multiply:
    case Op::divide:
    case Op::modulo:
      return 5;
    case Op::add:
    case Op::subtract:
      return 4;
    case Op::logic_and:
      return and_as_product_ ? 5 : 2;
    case Op::logic_or:
    case Op::logic_xor:
      return and_as_product_ ? 4 : 2;
    default:
      return 3;
  }
}

bool ExpressionReader::begins_value() const {
  std::size_t i = at_;
  while (i < end_ && (is_blank(text_[i]) || text_[i] == '-' || text_[i] == '+')) ++i;
  if (i >= end_) return false;
  if (text_[i] == '#' || text_[i] == '[') return true;
  std::size_t at = i, length = 0;
  Expressions none;
  return ExpressionReader(none, text_, at, end_).function_here(length).has_value();
}

std::uint32_t ExpressionReader::read_value() { return read(What::value); }
std::uint32_t ExpressionReader::read_open() { return read(What::open); }
std::uint32_t ExpressionReader::read_bracketed() { return read(What::bracketed); }
std::uint32_t ExpressionReader::read_variable_number() { return read(What::variable_number); }

std::uint32_t ExpressionReader::read(What what) {
  skip_blanks();
  Expression e;
  const std::size_t begin = at_;
  e.offset = static_cast<std::uint32_t>(begin);
  e.first = static_cast<std::uint32_t>(out_.ops.size());
  has_logic_ = and_as_product_ = false;
  read_as(what);
  e.count = static_cast<std::uint32_t>(out_.ops.size()) - e.first;
  e.product_first = e.first;
  e.product_count = e.count;
  if (has_logic_) {
    and_as_product_ = true;
    at_ = begin;
    e.product_first = static_cast<std::uint32_t>(out_.ops.size());
    read_as(what);
    e.product_count = static_cast<std::uint32_t>(out_.ops.size()) - e.product_first;
  }
  out_.list.push_back(e);
  return static_cast<std::uint32_t>(out_.list.size() - 1);
}

void ExpressionReader::read_as(What what) {
  depth_ = 0;
  switch (what) {
    case What::value:
      return operand();
    case What::open:
      return binary(0);
    case What::bracketed:
      skip_blanks();
      return bracketed();
    case What::variable_number:
      return variable_number();
  }
}

/// Operators of the same priority go from left to right, ** too.
void ExpressionReader::binary(int min_priority) {
  operand();
  for (;;) {
    skip_blanks();
    std::size_t length = 0;
    bool abbreviated = false;
    const auto op = at_ < end_ ? operator_here(length, &abbreviated) : std::nullopt;
    if (!op || priority(*op) < min_priority) return;
    const std::size_t at = at_;
    if (abbreviated) out_.note_abbreviation(at);
    at_ += length;
    has_logic_ |= *op == Op::logic_and || *op == Op::logic_or || *op == Op::logic_xor;
    binary(priority(*op) + 1);
    push(*op, at);
  }
}

void ExpressionReader::operand() {
  if (++depth_ > kMaxDepth) throw MacroError(at_, "expression", fmt::format("more than {} nested brackets", kMaxDepth));
  const char c = peek();
  const std::size_t begin = at_;
  std::size_t length = 0;
  bool abbreviated = false;
  if (c == '-' || c == '+') {
    ++at_;
    operand();
    push(c == '-' ? Op::negate : Op::plus, begin);
  } else if (c == '#') {
    ++at_;
    parameter();
  } else if (c == '[') {
    bracketed();
  } else if (is_digit(c) || c == '.') {
    number();
  } else if (const auto op = at_ < end_ ? function_here(length, &abbreviated) : std::nullopt) {
    if (abbreviated) out_.note_abbreviation(at_);
    at_ += length;
    function(*op, begin);
  } else if (c == '\0') {
    throw MacroError(at_, "expression", "the expression ends; a number, a variable (#) or [ was expected");
  } else {
    throw MacroError(at_, "expression", "a number, a variable (#), a function or [ was expected here");
  }
  --depth_;
}

/// Behind a #.
void ExpressionReader::parameter() {
  const std::size_t begin = at_ - 1;
  if (peek() == '<') {
    push(Op::named, begin, read_name());
    return;
  }
  variable_number();
  push(Op::variable, begin);
}

void ExpressionReader::variable_number() {
  const char c = peek();
  if (c != '#' && c != '[' && !is_digit(c))
    throw MacroError(at_, "expression", "# has no number; a number, [ or <name> was expected after it");
  operand();
}

std::uint32_t ExpressionReader::read_name() {
  const std::size_t begin = at_++;
  std::string name;
  while (at_ < end_ && text_[at_] != '>') {
    const char c = text_[at_++];
    if (!is_blank(c)) name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (at_ >= end_) throw MacroError(begin, "expression", "the name has no closing `>`");
  ++at_;
  if (name.empty()) throw MacroError(begin, "expression", "<> has no name");
  for (std::size_t i = 0; i < out_.names.size(); ++i)
    if (out_.names[i] == name) return static_cast<std::uint32_t>(i);
  out_.names.push_back(name);
  return static_cast<std::uint32_t>(out_.names.size() - 1);
}

void ExpressionReader::number() {
  const std::size_t begin = at_;
  bool point = false;
  while (at_ < end_ && (is_digit(text_[at_]) || (text_[at_] == '.' && !point))) point |= text_[at_++] == '.';
  std::string_view digits = text_.substr(begin, at_ - begin);
  const std::string padded = "0" + std::string(digits) + (digits.back() == '.' ? "0" : "");
  const auto value = digits == "." ? std::nullopt : parse_number(padded);
  if (!value) throw MacroError(begin, "expression", fmt::format("{} is not a number", digits));
  push(Op::number, begin, *value);
}

void ExpressionReader::bracketed() {
  const std::size_t begin = at_;
  expect('[', "here");
  binary(0);
  if (peek() != ']') {
    if (at_ >= end_) throw MacroError(begin, "expression", "the bracket `[` is not closed in its block");
    throw MacroError(at_, "expression",
                     "an operator (+ - * / MOD ** AND OR XOR EQ NE GT GE LT LE) or `]` was expected");
  }
  ++at_;
}

void ExpressionReader::function(Op op, std::size_t begin) {
  if (op == Op::name_known) {
    expect('[', "behind EXISTS");
    expect('#', "in EXISTS[#100] or EXISTS[#<name>]");
    if (peek() == '<') {
      push(Op::name_known, begin, read_name());
    } else {
      variable_number();
      push(Op::variable_known, begin);
    }
    expect(']', "to close EXISTS[#100] or EXISTS[#<name>]");
    return;
  }
  if (op != Op::arc_tangent && op != Op::power) {
    skip_blanks();
    bracketed();
    push(op, begin);
    return;
  }
  expect('[', "behind the function");
  binary(0);
  if (peek() == ',') {
    ++at_;
    binary(0);
    expect(']', "to close the function");
    push(op == Op::power ? Op::power : Op::arc_tangent_2, begin);
    return;
  }
  if (op == Op::power) throw MacroError(at_, "expression", "`,` was expected in POW[a,b]");
  expect(']', "to close the function");
  if (peek() != '/') return push(Op::arc_tangent, begin);
  const std::size_t slash = at_++;
  if (peek() != '[') {
    at_ = slash;  // ATAN[a] / 2: a quotient
    return push(Op::arc_tangent, begin);
  }
  bracketed();
  push(Op::arc_tangent_2, begin);
}

}  // namespace camber::nc
