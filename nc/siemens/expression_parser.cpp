// Expressions. Priority, highest first: NOT; * / DIV MOD; + -; B_AND; B_XOR; B_OR; AND; XOR; OR; <<; comparisons
// (Programming Manual, Job Planning, "Priority of the operations").
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "nc/siemens/line_parser.h"

namespace camber::nc::siemens {
namespace {

constexpr int kLevels = 10;
constexpr int kMaxDepth = 100;

struct OperatorRow {
  int level;
  std::string_view text;
  NodeKind kind;
};

constexpr OperatorRow kOperators[] = {
    {0, "==", NodeKind::equal},         {0, "<>", NodeKind::not_equal},  {0, "<=", NodeKind::less_equal},
    {0, ">=", NodeKind::greater_equal}, {0, "<", NodeKind::less},        {0, ">", NodeKind::greater},
    {1, "<<", NodeKind::join},          {2, "OR", NodeKind::logical_or}, {3, "XOR", NodeKind::logical_xor},
    {4, "AND", NodeKind::logical_and},  {5, "B_OR", NodeKind::bit_or},   {6, "B_XOR", NodeKind::bit_xor},
    {7, "B_AND", NodeKind::bit_and},    {8, "+", NodeKind::add},         {8, "-", NodeKind::subtract},
    {9, "*", NodeKind::multiply},       {9, "/", NodeKind::divide},      {9, "DIV", NodeKind::whole_divide},
    {9, "MOD", NodeKind::modulo},       {9, ":", NodeKind::chain}};

}  // namespace

std::uint32_t LineParser::add(Node node) {
  tree_.nodes.push_back(node);
  return static_cast<std::uint32_t>(tree_.nodes.size() - 1);
}

void LineParser::set_children(Node& node, const std::vector<std::uint32_t>& children) {
  node.first = static_cast<std::uint32_t>(tree_.arguments.size());
  node.count = static_cast<std::uint32_t>(children.size());
  tree_.arguments.insert(tree_.arguments.end(), children.begin(), children.end());
}

std::uint32_t LineParser::add(NodeKind kind, std::size_t begin, std::initializer_list<std::uint32_t> children) {
  Node node{.kind = kind, .offset = static_cast<std::uint32_t>(begin)};
  set_children(node, children);
  node.length = static_cast<std::uint32_t>(at_ - begin);
  return add(node);
}

bool LineParser::take_operator(int level, NodeKind& kind) {
  skip_blanks();
  const std::string_view rest = text_.substr(at_, end_ - at_);
  for (const OperatorRow& row : kOperators) {
    if (row.level != level || rest.size() < row.text.size()) continue;
    const bool word = is_letter(row.text[0]);
    if (word ? name_ahead() != row.text : !rest.starts_with(row.text)) continue;
    if (row.text == "<" && rest.starts_with("<<")) continue;
    kind = row.kind;
    at_ += row.text.size();
    return true;
  }
  return false;
}

std::uint32_t LineParser::parse_binary(int level) {
  if (level == kLevels) return parse_unary();
  skip_blanks();
  const std::size_t begin = at_;
  std::uint32_t left = parse_binary(level + 1);
  NodeKind kind{};
  for (int count = 0; take_operator(level, kind); ++count) {
    if (count > 1000) fail(begin, "expression", "an expression of more than 1000 operations");
    const std::uint32_t right = parse_binary(level + 1);
    left = add(kind, begin, {left, right});
  }
  return left;
}

std::uint32_t LineParser::parse_unary() {
  skip_blanks();
  const std::size_t begin = at_;
  if (++depth_ > kMaxDepth) fail(begin, "expression", "brackets more than 100 deep");
  struct Leave {
    int& depth;
    ~Leave() { --depth; }
  } const leave{depth_};
  const std::string name = name_ahead();
  if (name == "NOT" || name == "B_NOT") {
    at_ += name.size();
    const std::uint32_t operand = parse_unary();
    return add(name == "NOT" ? NodeKind::logical_not : NodeKind::bit_not, begin, {operand});
  }
  if (take('+')) return parse_unary();
  if (take('-')) {
    const std::uint32_t operand = parse_unary();
    Node& node = tree_.nodes[operand];
    if (node.kind != NodeKind::number) return add(NodeKind::negate, begin, {operand});
    node.number = -node.number;
    node.length += node.offset - static_cast<std::uint32_t>(begin);
    node.offset = static_cast<std::uint32_t>(begin);
    return operand;
  }
  return parse_primary();
}

/// 12, .5, 1.5EX-3 at the place; false where none stands there.
bool LineParser::parse_number(double& value) {
  const std::size_t begin = at_;
  std::size_t i = at_;
  while (i < end_ && is_digit(text_[i])) ++i;
  std::size_t digits = i - at_;
  if (i < end_ && text_[i] == '.') {
    const std::size_t point = i++;
    while (i < end_ && is_digit(text_[i])) ++i;
    digits += i - point - 1;
  }
  if (digits == 0) return false;
  std::string number(text_.substr(begin, i - begin));
  at_ = i;
  if (i + 2 < end_ && upper(text_[i]) == 'E' && upper(text_[i + 1]) == 'X') {
    std::size_t j = i + 2;
    std::string exponent;
    if (text_[j] == '-' || text_[j] == '+') {
      if (text_[j] == '-') exponent = "-";
      ++j;
    }
    const std::size_t first = j;
    while (j < end_ && is_digit(text_[j])) exponent += text_[j++];
    if (j > first) {
      number += "e" + exponent;
      at_ = j;
    }
  }
  const auto result = std::from_chars(number.data(), number.data() + number.size(), value);
  if (result.ec != std::errc() || !std::isfinite(value))
    fail(begin, "number", fmt::format("{} is too large a number", number.substr(0, 40)));
  return true;
}

std::uint32_t LineParser::parse_primary() {
  skip_blanks();
  const std::size_t begin = at_;
  double number = 0;
  if (is_digit(peek()) || peek() == '.') {
    if (!parse_number(number)) fail(begin, "expression", "`.` is no number");
    return add({.kind = NodeKind::number,
                .offset = static_cast<std::uint32_t>(begin),
                .length = static_cast<std::uint32_t>(at_ - begin),
                .number = number});
  }
  if (peek() == '"' || peek() == '\'') return parse_quoted();
  if (take('(')) {
    const std::uint32_t inner = parse_expression();
    skip_blanks();
    if (peek() == ',')  // PO[X]=(1,2): of a list, the first one
      while (take(',')) parse_expression();
    expect(')', "in an expression");
    return inner;
  }
  if (is_letter(peek()) || peek() == '_' || peek() == '$') return parse_named_value();
  fail(begin, "expression", fmt::format("{} in an expression; a value was expected", quoted(begin)));
}

/// "text", 'H1F', 'B101'.
std::uint32_t LineParser::parse_quoted() {
  const std::size_t begin = at_;
  const char mark = text_[at_++];
  std::string content;
  for (;;) {
    if (at_ >= end_) fail(begin, "text-open", fmt::format("the text has no closing `{}` in its block", mark));
    const char c = text_[at_++];
    if (c == mark && peek() == mark && mark == '"') {
      ++at_;
      content += mark;
    } else if (c == mark) {
      break;
    } else {
      content += c;
    }
  }
  Node node{.kind = NodeKind::number,
            .offset = static_cast<std::uint32_t>(begin),
            .length = static_cast<std::uint32_t>(at_ - begin)};
  if (mark == '\'') {
    if (content.size() == 1) {  // 'A': a character
      node.number = static_cast<unsigned char>(content[0]);
      return add(node);
    }
    const char base = content.empty() ? '\0' : upper(content[0]);
    std::uint64_t value = 0;
    const char* first = content.data() + 1;
    const char* last = content.data() + content.size();
    const auto result = std::from_chars(first, last, value, base == 'H' ? 16 : 2);
    if ((base != 'H' && base != 'B') || content.size() < 2 || result.ec != std::errc() || result.ptr != last)
      fail(begin, "number", fmt::format("'{}' is no number; 'H1F' or 'B101' was expected", content.substr(0, 40)));
    node.number = static_cast<double>(value);
    return add(node);
  }
  node.kind = NodeKind::text;
  node.name = static_cast<std::uint32_t>(tree_.texts.size());
  tree_.texts.push_back(std::move(content));
  return add(node);
}

/// R1, R[...], SIN(...), a variable, a system variable, TRUE.
std::uint32_t LineParser::parse_named_value() {
  const std::size_t begin = at_;
  Node node{.kind = NodeKind::variable, .offset = static_cast<std::uint32_t>(begin)};
  const bool parameter = upper(peek()) == 'R' && (is_digit(peek(1)) || peek(1) == '[');
  if (parameter) {
    ++at_;
    node.kind = NodeKind::parameter;
    if (take('[')) {
      const std::uint32_t index = parse_expression();
      expect(']', "in an index");
      set_children(node, {index});
    } else {
      double number = 0;
      std::size_t digits = at_;
      while (digits < end_ && is_digit(text_[digits])) ++digits;
      const auto result = std::from_chars(text_.data() + at_, text_.data() + digits, number);
      if (result.ec != std::errc()) number = 1e9;
      at_ = digits;
      set_children(node, {add({.kind = NodeKind::number, .offset = node.offset, .number = number})});
    }
    node.length = static_cast<std::uint32_t>(at_ - begin);
    return add(node);
  }
  // A single letter is an axis, whose name ends there: X in X=X1... and [X]
  std::string name;
  const char next = peek(1);
  if (is_letter(peek()) && !is_letter(next) && next != '_' && next != '$' && !is_digit(next))
    name = std::string(1, upper(text_[at_++]));
  else
    name = read_name();
  if (name == "TRUE" || name == "FALSE" || name == "PI") {
    node.kind = NodeKind::number;
    node.number = name == "PI" ? 3.14159265358979323846 : name == "TRUE" ? 1 : 0;
    node.length = static_cast<std::uint32_t>(at_ - begin);
    return add(node);
  }
  node.name = names_.index(name);
  if (name[0] == '$') node.kind = NodeKind::system;
  if (take('[')) {
    std::vector<std::uint32_t> indexes;
    do indexes.push_back(parse_expression());
    while (take(','));
    expect(']', "in an index");
    set_children(node, indexes);
  } else if (peek() == '(') {
    const FunctionRow* function = find_function(name);  // of others the value is not known
    ++at_;
    node.kind = NodeKind::call;
    const auto values = parse_list(')');
    if (function && (values.size() < function->least || values.size() > function->most))
      fail(begin, "function",
           fmt::format("{} with {} values; {} was expected", name, values.size(),
                       function->least == function->most ? fmt::format("{}", function->least)
                                                         : fmt::format("{} to {}", function->least, function->most)));
    set_children(node, values);
  }
  node.length = static_cast<std::uint32_t>(at_ - begin);
  return add(node);
}

}  // namespace camber::nc::siemens
