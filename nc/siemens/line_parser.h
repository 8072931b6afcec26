#pragma once
// Parses one block of a Sinumerik program that has more than plain words.
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "nc/siemens/siemens_tree.h"

namespace camber::nc::siemens {

/// An error in a block.
struct ParseError : std::runtime_error {
  ParseError(std::size_t at, std::string_view name, const std::string& message)
      : std::runtime_error(message), offset(at), check(name) {}
  std::size_t offset;
  std::string check;
};

/// Finds or adds names of a tree.
class NameTable {
 public:
  explicit NameTable(Tree& tree) : tree_(tree) {}
  std::uint32_t index(std::string upper_name);

  /// Letters that the program declares as variables (DEF INT I); they are addresses before a number all the same.
  void declare(char letter) { letters_ += letter; }
  void forget_letters() { letters_.clear(); }
  bool is_declared(char upper_letter) const { return letters_.find(upper_letter) != std::string::npos; }
  /// DEFINE: where the words begin and end that a name stands for.
  std::map<std::string, std::pair<std::size_t, std::size_t>> macros;

 private:
  Tree& tree_;
  std::string letters_;
  std::unordered_map<std::string, std::uint32_t> known_;
};

class LineParser {
 public:
  LineParser(Tree& tree, NameTable& names, std::string_view text, std::size_t begin, std::size_t end)
      : tree_(tree), names_(names), text_(text), at_(begin), end_(end) {}

  /// The whole block behind its skip sign; `number`: the text of N10 or :10, empty where there is none.
  Statement parse(std::uint32_t block, std::string& number);
  std::uint8_t skip() const { return skip_; }

 private:
  // line_parser.cpp: items and flow control
  void parse_items();
  void parse_item();
  void parse_name();
  bool parse_flow(const std::string& name, std::size_t begin);
  void parse_letter();
  void parse_address(Item item);
  void parse_call(Item item);
  void parse_assignment(Item item);
  void parse_value(Item& item);
  void parse_indexes(Item& item);
  void parse_if(std::size_t begin);
  void parse_case(std::size_t begin);
  Jump parse_jump(const std::string& keyword, std::size_t begin);
  void parse_for(std::size_t begin);
  void parse_repeat(const std::string& name, std::size_t begin);
  void parse_definition(std::size_t begin);
  void parse_procedure(std::size_t begin);
  Declared parse_declared(ValueType type, bool parameter);
  bool parse_type(ValueType& type);
  std::vector<std::uint32_t> parse_list(char close);
  void pass_synchronized_action(std::size_t begin);
  void define_macro(std::size_t begin);
  bool parse_macro(const std::string& name, std::size_t begin);
  void set_flow(FlowKind kind, std::size_t begin);
  void expect_end();

  // expression_parser.cpp
  std::uint32_t parse_expression() { return parse_binary(0); }
  std::uint32_t parse_binary(int level);
  std::uint32_t parse_unary();
  std::uint32_t parse_primary();
  std::uint32_t parse_named_value();
  std::uint32_t parse_quoted();
  std::uint32_t add(Node node);
  std::uint32_t add(NodeKind kind, std::size_t begin, std::initializer_list<std::uint32_t> children);
  void set_children(Node& node, const std::vector<std::uint32_t>& children);
  bool take_operator(int level, NodeKind& kind);
  bool parse_number(double& value);

  char peek(std::size_t ahead = 0) const { return at_ + ahead < end_ ? text_[at_ + ahead] : '\0'; }
  void skip_blanks();
  bool take(char c);
  void expect(char c, std::string_view what);
  bool at_end();
  std::string read_name();
  std::string name_ahead() const;
  [[noreturn]] void fail(std::size_t at, std::string_view check, const std::string& message) const;
  std::string quoted(std::size_t begin) const;

  Tree& tree_;
  NameTable& names_;
  std::string_view text_;
  std::size_t at_, end_;
  std::uint8_t skip_ = 0;
  Statement out_;
  int depth_ = 0;
};

inline bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\0' || c == '\f' || c == '\v'; }
inline char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
inline bool in_name(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '$'; }

}  // namespace camber::nc::siemens
