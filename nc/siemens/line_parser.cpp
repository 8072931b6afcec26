#include "nc/siemens/line_parser.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace camber::nc::siemens {
namespace {

bool is_name_start(std::string_view text, std::size_t at, std::size_t end) {
  const char c = at < end ? text[at] : '\0', next = at + 1 < end ? text[at + 1] : '\0';
  if (c == '_' || c == '$') return true;
  return is_letter(c) && (is_letter(next) || next == '_');
}

constexpr std::array<std::string_view, 5> kJumps = {"GOTO", "GOTOF", "GOTOB", "GOTOC", "GOTOS"};

bool is_jump(std::string_view name) { return std::ranges::find(kJumps, name) != kJumps.end(); }

/// Whole frames and axis moves that a synchronized action may ask for.
bool moves_something(std::string_view text) {
  std::string upper_text;
  for (const char c : text) upper_text += upper(c);
  for (const char* word : {"POS[", "MOV[", "POSA[", "SPOS", "CORROF", "PRESETON", "$AA_OFF", "DELDTG"})
    if (upper_text.find(word) != std::string::npos) return true;
  return false;
}

}  // namespace

std::uint32_t NameTable::index(std::string upper_name) {
  const auto [at, added] = known_.try_emplace(std::move(upper_name), static_cast<std::uint32_t>(tree_.names.size()));
  if (added) tree_.names.push_back(at->first);
  return at->second;
}

// --- characters

void LineParser::skip_blanks() {
  while (at_ < end_ && is_blank(text_[at_])) ++at_;
}

bool LineParser::take(char c) {
  skip_blanks();
  if (peek() != c) return false;
  ++at_;
  return true;
}

bool LineParser::at_end() {
  skip_blanks();
  return at_ >= end_ || text_[at_] == ';';
}

void LineParser::fail(std::size_t at, std::string_view check, const std::string& message) const {
  throw ParseError(at, check, message);
}

/// Returns the text at a place, for messages.
std::string LineParser::quoted(std::size_t begin) const {
  if (begin >= end_ || text_[begin] == ';') return "the end of the block";
  std::size_t to = begin;
  while (to < end_ && in_name(text_[to])) ++to;
  if (to == begin) ++to;
  const auto c = static_cast<unsigned char>(text_[begin]);
  if (c < 32 || c > 126) return fmt::format("byte 0x{:02X}", c);
  return fmt::format("`{}`", text_.substr(begin, std::min<std::size_t>(to - begin, 40)));
}

void LineParser::expect(char c, std::string_view what) {
  if (!take(c)) fail(std::min(at_, end_), "syntax", fmt::format("{} {}; `{}` was expected", quoted(at_), what, c));
}

void LineParser::expect_end() {
  if (!at_end())
    fail(at_, "syntax", fmt::format("{} behind the statement; the end of the block was expected", quoted(at_)));
}

std::string LineParser::read_name() {
  std::string out;
  while (at_ < end_ && in_name(text_[at_])) out += upper(text_[at_++]);
  return out;
}

std::string LineParser::name_ahead() const {
  std::string out;
  for (std::size_t i = at_; i < end_ && in_name(text_[i]); ++i) out += upper(text_[i]);
  return out;
}

// --- the block

Statement LineParser::parse(std::uint32_t block, std::string& number) {
  out_.block = block;
  skip_blanks();
  if (take('/')) {
    skip_ = 1;
    if (is_digit(peek())) skip_ = static_cast<std::uint8_t>(1 + (text_[at_++] - '0'));
    skip_blanks();
  }
  const bool main_block = peek() == ':' && is_digit(peek(1));
  if (main_block || (upper(peek()) == 'N' && is_digit(peek(1)))) {
    number = main_block ? ":" : "N";
    ++at_;
    std::size_t first = at_;
    while (is_digit(peek())) ++at_;
    while (first + 1 < at_ && text_[first] == '0') ++first;
    number += std::string(text_.substr(first, at_ - first));
    if (peek() == '.') fail(at_, "block-number", "a block number with a point; a whole number was expected");
  }
  skip_blanks();
  if (peek() == '/' && skip_ == 0) {  // N10 /G1 is read too
    ++at_;
    skip_ = 1;
  }
  parse_items();
  return std::move(out_);
}

void LineParser::parse_items() {
  while (!at_end()) parse_item();
}

void LineParser::parse_item() {
  if (out_.items.size() > 2000) fail(at_, "too-many-words", "more than 2000 words in one block");
  if (is_name_start(text_, at_, end_)) return parse_name();
  if (is_letter(peek())) return parse_letter();
  fail(at_, "syntax", fmt::format("{} begins no word; an address, a name or a statement was expected", quoted(at_)));
}

void LineParser::set_flow(FlowKind kind, std::size_t begin) {
  if (out_.flow != FlowKind::none)
    fail(begin, "syntax", "a second statement of flow control in one block; a block of its own was expected");
  out_.flow = kind;
  out_.flow_offset = static_cast<std::uint32_t>(begin);
}

void LineParser::parse_name() {
  const std::size_t begin = at_;
  const std::string name = read_name();
  Item item;
  item.offset = static_cast<std::uint32_t>(begin);
  item.length = static_cast<std::uint32_t>(at_ - begin);
  const bool only_labels = std::ranges::all_of(out_.items, [](const Item& i) { return i.kind == ItemKind::label; });
  if (peek() == ':' && peek(1) != '=' && only_labels && name[0] != '$') {
    ++at_;
    item.kind = ItemKind::label;
    item.name = names_.index(name);
    out_.items.push_back(item);
    return;
  }
  if (parse_flow(name, begin) || parse_macro(name, begin)) return;
  if (name == "PCALL") {  // the folders of its path are those of the control
    skip_blanks();
    for (std::size_t i = at_; i < end_ && !is_blank(text_[i]) && text_[i] != '('; ++i)
      if (text_[i] == '/') at_ = i + 1;
    return parse_name();
  }
  item.row = find_word(name);
  item.name = names_.index(name);
  skip_blanks();
  const bool sets = peek() == '=' && peek(1) != '=';
  if (item.row && item.row->kind == WordKind::address) return parse_address(item);
  if (name == "CALL" || name == "EXTCALL") {
    item.kind = ItemKind::call;
    item.value = parse_expression();
    item.length = static_cast<std::uint32_t>(at_ - begin);
    out_.items.push_back(item);
    return;
  }
  if (name == "ISOCALL")
    while (!at_end()) ++at_;
  if (item.row && !sets) {
    item.kind = item.row->kind == WordKind::command ? ItemKind::command : ItemKind::call;
    if (peek() == '(') return parse_call(item);
    out_.items.push_back(item);
    return;
  }
  if (sets || peek() == '[') return parse_assignment(item);
  item.kind = ItemKind::call;
  parse_call(item);
}

/// ADIS=0.5, ACC[X]=50, PO[X]=(1,2).
void LineParser::parse_address(Item item) {
  if (take('[')) {
    skip_blanks();
    item.index = parse_expression();
    expect(']', "in an index");
  }
  skip_blanks();
  if (peek() != '=') {
    if (item.row->does == Does::refused || item.row->does == Does::noted) {  // some are written without a value too
      item.kind = ItemKind::command;
      out_.items.push_back(item);
      return;
    }
    fail(at_, "syntax",
         fmt::format("{} has no value; {}= and a value was expected", tree_.names[item.name], tree_.names[item.name]));
  }
  ++at_;
  parse_value(item);
  out_.items.push_back(item);
}

/// Behind the `=` of an address.
void LineParser::parse_value(Item& item) {
  skip_blanks();
  const std::string name = name_ahead();
  static const std::unordered_map<std::string, Dimension> kDimensions = {{"AC", Dimension::absolute},
                                                                         {"IC", Dimension::incremental},
                                                                         {"DC", Dimension::nearest},
                                                                         {"ACP", Dimension::positive},
                                                                         {"ACN", Dimension::negative}};
  const auto found = kDimensions.find(name);
  std::size_t behind = at_ + name.size();
  while (behind < end_ && is_blank(text_[behind])) ++behind;
  const bool bracket = behind < end_ && text_[behind] == '(';
  if (found != kDimensions.end() && bracket) {
    item.dimension = found->second;
    at_ = behind + 1;
    item.value = parse_expression();
    expect(')', fmt::format("in {}(", name));
  } else if (bracket && (name == "CAC" || name == "CIC" || name == "CDC" || name == "CACP" || name == "CACN")) {
    fail(at_, "not-supported", fmt::format("{} (coded positions) is not supported; a coordinate was expected", name));
  } else if (bracket && (name == "QU" || name == "RAC" || name == "RIC")) {
    at_ = behind + 1;
    item.value = parse_expression();
    expect(')', fmt::format("in {}(", name));
  } else {
    item.value = parse_expression();
    // a list: PO[X]=(1,2,3) has been read as a bracket by the expression where it has one value
  }
  const Node& node = tree_.nodes[item.value];
  if (node.kind == NodeKind::number) {
    item.constant = true;
    item.number = node.number;
  }
  item.length = static_cast<std::uint32_t>(at_ - item.offset);
}

void LineParser::parse_indexes(Item& item) {
  std::vector<std::uint32_t> indexes;
  if (!take('[')) return;
  do indexes.push_back(parse_expression());
  while (take(','));
  expect(']', "in an index");
  item.first = static_cast<std::uint32_t>(tree_.arguments.size());
  item.count = static_cast<std::uint32_t>(indexes.size());
  tree_.arguments.insert(tree_.arguments.end(), indexes.begin(), indexes.end());
}

/// Parses an assignment from the [ or = behind the name of its variable on.
void LineParser::parse_assignment(Item item) {
  item.kind = ItemKind::assign;
  parse_indexes(item);
  if (!take('=') || peek() == '=')
    fail(at_, "syntax", fmt::format("{} behind {}; `=` was expected", quoted(at_), tree_.names[item.name]));
  skip_blanks();
  const std::string name = name_ahead();
  if (name == "SET" || name == "REP") {
    const std::size_t begin = at_;
    at_ += name.size();
    expect('(', fmt::format("behind {}", name));
    Node node{.kind = NodeKind::call, .offset = static_cast<std::uint32_t>(begin), .name = names_.index(name)};
    set_children(node, parse_list(')'));
    item.value = add(node);
  } else {
    item.value = parse_expression();
  }
  item.length = static_cast<std::uint32_t>(at_ - item.offset);
  out_.items.push_back(item);
}

/// Values up to the closing bracket; kNone for one that is left out.
std::vector<std::uint32_t> LineParser::parse_list(char close) {
  std::vector<std::uint32_t> out;
  if (take(close)) return out;
  for (;;) {
    skip_blanks();
    if (peek() == ',' || peek() == close)
      out.push_back(kNone);
    else
      out.push_back(parse_expression());
    if (take(close)) return out;
    expect(',', "in a list");
    if (out.size() > 200) fail(at_, "syntax", "more than 200 values in a list");
  }
}

/// Behind the name of a cycle or subprogram.
void LineParser::parse_call(Item item) {
  std::vector<std::uint32_t> arguments;
  if (take('(')) {
    item.brackets = true;
    arguments = parse_list(')');
  }
  item.first = static_cast<std::uint32_t>(tree_.arguments.size());
  item.count = static_cast<std::uint32_t>(arguments.size());
  tree_.arguments.insert(tree_.arguments.end(), arguments.begin(), arguments.end());
  item.length = static_cast<std::uint32_t>(at_ - item.offset);
  out_.items.push_back(item);
}

/// An address of one letter: X10, X=R1, M3=3, R5=1, L140(2), I1=30.
void LineParser::parse_letter() {
  const std::size_t begin = at_;
  const char letter = upper(text_[at_++]);
  Item item;
  item.offset = static_cast<std::uint32_t>(begin);
  std::size_t digits = at_;
  while (digits < end_ && is_digit(text_[digits])) ++digits;
  std::size_t behind = digits;
  while (behind < end_ && is_blank(text_[behind])) ++behind;
  const bool sets = behind < end_ && text_[behind] == '=' && !(behind + 1 < end_ && text_[behind + 1] == '=');
  if (behind < end_ && text_[behind] == ':' && digits > at_ && out_.items.empty())
    fail(begin, "label",
         fmt::format("{} is no label; a name that begins with two letters was expected", quoted(begin)));
  if (letter == 'L' && digits > at_ && !sets) {
    item.name = names_.index("L" + std::string(text_.substr(at_, digits - at_)));
    item.kind = ItemKind::call;
    at_ = digits;
    return parse_call(item);
  }
  if (letter == 'R' && (sets || peek() == '[')) {
    item.name = names_.index("R");
    if (peek() != '[') {
      if (digits == at_) fail(begin, "syntax", "R= has no number; R1= or R[1]= was expected");
      double number = 0;
      parse_number(number);
      const std::uint32_t node = add({.kind = NodeKind::number, .offset = item.offset, .number = number});
      item.first = static_cast<std::uint32_t>(tree_.arguments.size());
      item.count = 1;
      tree_.arguments.push_back(node);
    }
    return parse_assignment(item);
  }
  if (sets && digits > at_) {  // an extended address
    const std::string name = letter + std::string(text_.substr(at_, digits - at_));
    item.row = find_word(name);
    if (item.row || std::string_view("XYZABCUVWIJKEPQ").find(letter) != std::string_view::npos) {
      item.name = names_.index(name);
    } else {
      item.name = names_.index(std::string(1, letter));
      double number = 0;
      const std::size_t at = at_;
      parse_number(number);
      item.index = add({.kind = NodeKind::number, .offset = static_cast<std::uint32_t>(at), .number = number});
    }
    at_ = behind + 1;
    parse_value(item);
    out_.items.push_back(item);
    return;
  }
  item.name = names_.index(std::string(1, letter));
  if (names_.is_declared(letter) && (peek() == '[' || (sets && digits == at_))) return parse_assignment(item);
  if (peek() == '[') {  // G[1]=3, S[2]=500
    ++at_;
    item.index = parse_expression();
    expect(']', "in an index");
    expect('=', "behind an index");
    parse_value(item);
    out_.items.push_back(item);
    return;
  }
  skip_blanks();
  if (peek() == '=' && peek(1) != '=') {
    ++at_;
    parse_value(item);
    out_.items.push_back(item);
    return;
  }
  const std::size_t number_at = at_;
  double number = 0;
  const bool minus = peek() == '-';
  if (minus || peek() == '+') ++at_;
  skip_blanks();
  if (!parse_number(number))
    fail(begin, "no-number", fmt::format("{} has no number; a number, or = and an expression, was expected", letter));
  item.constant = true;
  item.number = minus ? -number : number;
  item.value = add({.kind = NodeKind::number,
                    .offset = static_cast<std::uint32_t>(number_at),
                    .length = static_cast<std::uint32_t>(at_ - number_at),
                    .number = item.number});
  if (letter == 'M' && take('(')) parse_list(')');  // a function of the machine with arguments
  item.length = static_cast<std::uint32_t>(at_ - begin);
  out_.items.push_back(item);
}

// --- flow control

bool LineParser::parse_flow(const std::string& name, std::size_t begin) {
  if (name == "IF") return parse_if(begin), true;
  if (name == "ELSE") return set_flow(FlowKind::else_branch, begin), expect_end(), true;
  if (name == "ENDIF") return set_flow(FlowKind::end_if, begin), expect_end(), true;
  if (is_jump(name)) {
    set_flow(FlowKind::jump, begin);
    out_.constants.push_back(kNone);
    out_.jumps.push_back(parse_jump(name, begin));
    expect_end();
    return true;
  }
  if (name == "CASE") return parse_case(begin), true;
  if (name == "FOR") return parse_for(begin), true;
  if (name == "ENDFOR") return set_flow(FlowKind::end_for, begin), expect_end(), true;
  if (name == "WHILE" || name == "UNTIL") {
    set_flow(name == "WHILE" ? FlowKind::while_loop : FlowKind::until, begin);
    out_.condition = parse_expression();
    expect_end();
    return true;
  }
  if (name == "ENDWHILE") return set_flow(FlowKind::end_while, begin), expect_end(), true;
  if (name == "LOOP") return set_flow(FlowKind::endless_loop, begin), expect_end(), true;
  if (name == "ENDLOOP") return set_flow(FlowKind::end_loop, begin), expect_end(), true;
  if (name == "REPEAT" || name == "REPEATB") return parse_repeat(name, begin), true;
  if (name == "DEF") return parse_definition(begin), true;
  if (name == "PROC") return parse_procedure(begin), true;
  if (name == "EXTERN") {
    set_flow(FlowKind::external, begin);
    while (!at_end()) ++at_;
    return true;
  }
  if (name == "DEFINE") return define_macro(begin), true;
  if (name == "WHEN" || name == "WHENEVER" || name == "EVERY" || name == "FROM" || name == "DO" || name == "ID" ||
      name == "IDS") {
    skip_blanks();
    if ((name == "ID" || name == "IDS") && peek() != '=') return false;
    pass_synchronized_action(begin);
    return true;
  }
  return false;
}

/// DEFINE NAME AS words: what stands behind AS is read where the name stands.
void LineParser::define_macro(std::size_t begin) {
  set_flow(FlowKind::external, begin);
  skip_blanks();
  const bool named = is_name_start(text_, at_, end_);
  const std::string name = read_name();
  skip_blanks();
  if (!named || read_name() != "AS")
    fail(begin, "not-supported",
         "DEFINE without a name of two letters and AS is not supported; the words were expected");
  names_.macros[name] = {at_, end_};
  at_ = end_;
}

/// The words of a macro, none of which can be edited.
bool LineParser::parse_macro(const std::string& name, std::size_t begin) {
  const auto macro = names_.macros.find(name);
  if (macro == names_.macros.end()) return false;
  if (++depth_ > 20) fail(begin, "macro", fmt::format("the macro {} leads to itself", name));
  const std::pair behind(at_, end_);
  const std::size_t first = out_.items.size();
  std::tie(at_, end_) = macro->second;
  parse_items();
  std::tie(at_, end_) = behind;
  --depth_;
  for (std::size_t i = first; i < out_.items.size(); ++i) {
    out_.items[i].offset = static_cast<std::uint32_t>(begin);
    out_.items[i].length = 0;
    out_.items[i].constant = false;
  }
  return true;
}

/// The rest of the block acts beside the path. What moves is refused.
void LineParser::pass_synchronized_action(std::size_t begin) {
  std::size_t to = at_;
  bool in_text = false;
  while (to < end_ && (in_text || text_[to] != ';')) in_text ^= text_[to++] == '"';
  const std::string_view rest = text_.substr(at_, to - at_);
  at_ = to;
  if (moves_something(rest))
    fail(begin, "not-supported",
         "a synchronized action that moves an axis is not supported; the moves as blocks of their own were expected");
  Item item;
  item.kind = ItemKind::command;
  item.name = names_.index("WHEN");
  static const WordRow kRow{"WHEN", WordKind::command, Does::noted, "synchronized action"};
  item.row = &kRow;
  item.offset = static_cast<std::uint32_t>(begin);
  item.length = static_cast<std::uint32_t>(to - begin);
  out_.items.push_back(item);
}

Jump LineParser::parse_jump(const std::string& keyword, std::size_t begin) {
  Jump jump;
  jump.offset = static_cast<std::uint32_t>(begin);
  jump.search = keyword == "GOTOF"   ? Jump::Search::forward
                : keyword == "GOTOB" ? Jump::Search::backward
                : keyword == "GOTOS" ? Jump::Search::start
                                     : Jump::Search::both;
  jump.silent = keyword == "GOTOC";
  skip_blanks();
  if (jump.search == Jump::Search::start) return jump;
  if (at_end()) fail(begin, "jump", fmt::format("{} has no target; a label or a block number was expected", keyword));
  const bool block_number = (upper(peek()) == 'N' || peek() == ':') && is_digit(peek(1));
  if (block_number) {
    std::string target(1, upper(text_[at_++]));
    std::size_t first = at_;
    while (is_digit(peek())) ++at_;
    while (first + 1 < at_ && text_[first] == '0') ++first;
    jump.target = names_.index(target + std::string(text_.substr(first, at_ - first)));
    return jump;
  }
  if (in_name(peek()) && !is_digit(peek())) {
    const std::size_t behind = at_ + name_ahead().size();
    const bool plain = behind >= end_ || (text_[behind] != '[' && text_[behind] != '(' &&
                                          text_.substr(behind, 2) != "<<" && peek() != '$');
    if (plain) {
      jump.target = names_.index(read_name());
      return jump;
    }
  }
  jump.value = parse_expression();
  return jump;
}

/// IF condition GOTOF label [IF ...], or the beginning of a branch.
void LineParser::parse_if(std::size_t begin) {
  set_flow(FlowKind::if_block, begin);
  out_.condition = parse_expression();
  if (at_end()) return;
  out_.flow = FlowKind::jump;
  std::uint32_t condition = out_.condition;
  for (;;) {
    skip_blanks();
    const std::size_t jump_at = at_;
    const std::string keyword = name_ahead();
    if (!is_jump(keyword))
      fail(jump_at, "syntax",
           fmt::format("{} behind the condition of IF; GOTOF, GOTOB, GOTO or the end of the block was expected",
                       quoted(at_)));
    at_ += keyword.size();
    out_.constants.push_back(condition);
    out_.jumps.push_back(parse_jump(keyword, jump_at));
    if (at_end()) return;
    if (name_ahead() != "IF") return expect_end();
    at_ += 2;
    condition = parse_expression();
  }
}

void LineParser::parse_case(std::size_t begin) {
  set_flow(FlowKind::select, begin);
  out_.condition = parse_expression();
  skip_blanks();
  if (name_ahead() != "OF") fail(at_, "syntax", fmt::format("{} behind CASE; OF was expected", quoted(at_)));
  at_ += 2;
  while (!at_end()) {
    skip_blanks();
    std::uint32_t constant = kNone;
    if (name_ahead() == "DEFAULT")
      at_ += 7;
    else
      constant = parse_expression();
    skip_blanks();
    const std::size_t jump_at = at_;
    const std::string keyword = name_ahead();
    if (!is_jump(keyword)) fail(at_, "syntax", fmt::format("{} in CASE; GOTOF or GOTOB was expected", quoted(at_)));
    at_ += keyword.size();
    out_.constants.push_back(constant);
    out_.jumps.push_back(parse_jump(keyword, jump_at));
  }
}

void LineParser::parse_for(std::size_t begin) {
  set_flow(FlowKind::for_loop, begin);
  skip_blanks();
  const std::size_t before = out_.items.size();
  const bool r_parameter = upper(peek()) == 'R' && (is_digit(peek(1)) || peek(1) == '[');
  const bool named = is_name_start(text_, at_, end_);
  if (r_parameter || (!named && names_.is_declared(upper(peek())))) {
    parse_letter();
  } else if (named) {
    Item item;
    item.offset = static_cast<std::uint32_t>(at_);
    item.name = names_.index(read_name());
    parse_assignment(item);
  }
  if (out_.items.size() == before || out_.items.back().kind != ItemKind::assign)
    fail(begin, "syntax", "FOR has no variable; FOR name = first TO last was expected");
  out_.variable = static_cast<std::uint32_t>(before);
  skip_blanks();
  if (name_ahead() != "TO") fail(at_, "syntax", fmt::format("{} in FOR; TO was expected", quoted(at_)));
  at_ += 2;
  out_.last = parse_expression();
  expect_end();
}

void LineParser::parse_repeat(const std::string& name, std::size_t begin) {
  if (at_end()) return set_flow(FlowKind::repeat_loop, begin);
  set_flow(FlowKind::repeat_part, begin);
  out_.named_number = name == "REPEATB";
  while (!at_end()) {
    if (upper(peek()) == 'P' && (peek(1) == '=' || is_digit(peek(1)) || (is_blank(peek(1)) && !out_.labels.empty()))) {
      ++at_;
      take('=');
      out_.last = parse_expression();
      return expect_end();
    }
    if (!in_name(peek()) || is_digit(peek()))
      fail(at_, "syntax", fmt::format("{} behind {}; a label was expected", quoted(at_), name));
    std::string label = read_name();
    if (label.size() > 1 && label[0] == 'N' && is_digit(label[1]))
      label.erase(1, std::min(label.find_first_not_of('0', 1), label.size() - 1) - 1);
    out_.labels.push_back(names_.index(label));
    if (out_.labels.size() > 2) fail(begin, "syntax", fmt::format("{} with more than two labels", name));
  }
}

bool LineParser::parse_type(ValueType& type) {
  skip_blanks();
  static const std::unordered_map<std::string, ValueType> kTypes = {
      {"REAL", ValueType::real},    {"INT", ValueType::integer}, {"BOOL", ValueType::boolean},
      {"CHAR", ValueType::integer}, {"STRING", ValueType::text}, {"AXIS", ValueType::axis},
      {"FRAME", ValueType::frame}};
  const std::string name = name_ahead();
  const auto found = kTypes.find(name);
  if (found == kTypes.end()) return false;
  at_ += name.size();
  type = found->second;
  skip_blanks();
  if (type == ValueType::text && take('[')) {
    parse_expression();
    expect(']', "in the length of STRING");
  }
  return true;
}

/// name[3]=value; of parameters `name[]` too.
Declared LineParser::parse_declared(ValueType type, bool parameter) {
  Declared out;
  out.type = type;
  skip_blanks();
  out.offset = static_cast<std::uint32_t>(at_);
  if (!in_name(peek()) || is_digit(peek()))
    fail(at_, "syntax", fmt::format("{} in a declaration; a name was expected", quoted(at_)));
  const std::string name_text = read_name();
  if (name_text.size() == 1) {
    constexpr std::string_view kFixedAddresses = "DFGHLMNRSTXYZ";
    if (kFixedAddresses.find(name_text[0]) != std::string_view::npos)
      fail(out.offset, "variable",
           fmt::format("{} is an address; a name of two letters or more was expected", name_text));
    names_.declare(name_text[0]);
  }
  out.name = names_.index(name_text);
  if (take('[')) {
    do {
      skip_blanks();
      if (out.dimensions == 3) fail(at_, "syntax", "an array of more than three dimensions");
      out.dimension[out.dimensions++] = peek() == ']' || peek() == ',' ? kNone : parse_expression();
    } while (take(','));
    expect(']', "in the size of an array");
  }
  skip_blanks();
  if (peek() != '=') return out;
  ++at_;
  skip_blanks();
  const std::string name = name_ahead();
  if (name == "SET" || name == "REP" || (peek() == '(' && out.dimensions > 0)) {
    if (peek() != '(') at_ += name.size();
    expect('(', "in a list of values");
    out.values = parse_list(')');
    if (name == "REP" && !out.values.empty()) {
      out.value = out.values.front();
      out.values.clear();
    }
  } else if (!parameter || (peek() != ',' && peek() != ')')) {
    out.value = parse_expression();
  }
  return out;
}

void LineParser::parse_definition(std::size_t begin) {
  set_flow(FlowKind::declaration, begin);
  ValueType type{};
  skip_blanks();
  for (std::string name = name_ahead();
       name == "NCK" || name == "CHAN" || name == "SYNR" || name == "SYNW" || name == "SYNRW" || name == "APX";
       skip_blanks(), name = name_ahead())
    at_ += name.size();
  if (!parse_type(type))
    fail(at_, "syntax",
         fmt::format("{} behind DEF; REAL, INT, BOOL, CHAR, STRING, AXIS or FRAME was expected", quoted(at_)));
  do out_.declared.push_back(parse_declared(type, false));
  while (take(','));
  expect_end();
}

void LineParser::parse_procedure(std::size_t begin) {
  set_flow(FlowKind::procedure, begin);
  names_.forget_letters();
  skip_blanks();
  if (!in_name(peek())) fail(at_, "syntax", "PROC has no name");
  out_.name = names_.index(read_name());
  if (take('(') && !take(')')) {
    do {
      skip_blanks();
      bool by_reference = false;
      if (name_ahead() == "VAR") by_reference = true, at_ += 3;
      ValueType type{};
      if (!parse_type(type))
        fail(at_, "syntax", fmt::format("{} in the parameters of PROC; a type was expected", quoted(at_)));
      out_.declared.push_back(parse_declared(type, true));
      out_.declared.back().by_reference = by_reference;
    } while (take(','));
    expect(')', "in the parameters of PROC");
  }
  while (!at_end()) {
    const std::size_t at = at_;
    const std::string name = read_name();
    if (name == "SAVE") out_.saves = true;
    if (name.empty())
      fail(at, "syntax",
           fmt::format("{} behind PROC; SAVE, DISPLOF, SBLOF or the end of the block was expected", quoted(at)));
  }
}

}  // namespace camber::nc::siemens
