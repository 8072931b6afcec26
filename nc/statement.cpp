// Text to statements.
#include "nc/statement.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace camber::nc {
namespace {

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }

constexpr std::size_t kMaxArguments = 30;

/// Statements that a Fanuc control knows by their first two letters.
constexpr std::array<std::string_view, 9> kAbbreviable{"WHILE", "GOTO",  "END",   "THEN", "DPRNT",
                                                       "BPRNT", "POPEN", "PCLOS", "SETVN"};

std::string unabbreviated(const std::string& word) {
  if (word.size() == 2)
    for (const std::string_view full : kAbbreviable)
      if (full.starts_with(word)) return std::string(full);
  return word;
}

struct OKeyword {
  std::string_view word;
  StatementKind kind;
  int values;  ///< in brackets: 0, 1, -1: one at most, -2: any number
};
constexpr std::array kOKeywords{
    OKeyword{"SUB", StatementKind::sub, 0},
    OKeyword{"ENDSUB", StatementKind::sub_end, -1},
    OKeyword{"RETURN", StatementKind::sub_return, -1},
    OKeyword{"CALL", StatementKind::call, -2},
    OKeyword{"IF", StatementKind::branch_if, 1},
    OKeyword{"ELSEIF", StatementKind::branch_elseif, 1},
    OKeyword{"ELSE", StatementKind::branch_else, 0},
    OKeyword{"ENDIF", StatementKind::branch_end, 0},
    OKeyword{"WHILE", StatementKind::loop, 1},
    OKeyword{"ENDWHILE", StatementKind::loop_end, 0},
    OKeyword{"DO", StatementKind::loop, 0},
    OKeyword{"REPEAT", StatementKind::loop, 1},
    OKeyword{"ENDREPEAT", StatementKind::loop_end, 0},
    OKeyword{"BREAK", StatementKind::leave_loop, 0},
    OKeyword{"CONTINUE", StatementKind::next_turn, 0},
};

}  // namespace

void StatementReader::skip_blanks() {
  while (at_ < end_ && is_blank(text_[at_])) ++at_;
}

bool StatementReader::at_block_end() {
  skip_blanks();
  return at_ >= end_ || text_[at_] == '(' || text_[at_] == ';';
}

/// The whole word, blanks before it left out; no letter may follow.
bool StatementReader::take(std::string_view word) {
  std::size_t i = at_;
  while (i < end_ && is_blank(text_[i])) ++i;
  if (end_ - i < word.size()) return false;
  for (std::size_t k = 0; k < word.size(); ++k)
    if (upper(text_[i + k]) != word[k]) return false;
  at_ = i + word.size();
  return true;
}

Statement& StatementReader::add(StatementKind kind, std::size_t offset, std::uint32_t label) {
  Statement s;
  s.kind = kind;
  s.block = block_;
  s.offset = static_cast<std::uint32_t>(offset);
  s.label = label;
  s.first_value = static_cast<std::uint32_t>(out_.values.size());
  out_.statements.push_back(s);
  return out_.statements.back();
}

void StatementReader::add_value(std::uint32_t expression) {
  out_.values.push_back(expression);
  ++out_.statements.back().value_count;
}

std::uint32_t StatementReader::label_index(std::string label) {
  const auto found = std::find(out_.labels.begin(), out_.labels.end(), label);
  if (found != out_.labels.end()) return static_cast<std::uint32_t>(found - out_.labels.begin());
  out_.labels.push_back(std::move(label));
  return static_cast<std::uint32_t>(out_.labels.size() - 1);
}

std::uint32_t StatementReader::whole_number(std::string_view what) {
  skip_blanks();
  const std::size_t begin = at_;
  std::uint64_t value = 0;
  while (at_ < end_ && is_digit(text_[at_]) && at_ - begin < 10)
    value = value * 10 + static_cast<std::uint64_t>(text_[at_++] - '0');
  if (begin == at_ || value > 0xFFFFFFFEu) throw MacroError(begin, "statement", fmt::format("{} has no number", what));
  return static_cast<std::uint32_t>(value);
}

// --- Fanuc's statements -------------------------------------------------------------------------------------------

StatementReader::Found StatementReader::read_keyword() {
  const std::size_t begin = at_;
  std::size_t letters = begin;
  while (letters < end_ && is_letter(text_[letters])) ++letters;
  std::string word;
  for (std::size_t i = begin; i < letters && word.size() < 9; ++i) word += upper(text_[i]);
  at_ = letters;
  if (const auto full = unabbreviated(word); full != word) {
    out_.expressions.note_abbreviation(begin);
    word = full;
  }
  if (word == "IF") {
    read_if(begin);
  } else if (word == "WHILE") {
    read_while(begin);
  } else if (word == "DO") {
    read_loop_number(StatementKind::loop, begin, "DO");
  } else if (word == "END") {
    read_loop_number(StatementKind::loop_end, begin, "END");
  } else if (word == "GOTO") {
    const std::uint32_t target = expressions().read_value();
    add(StatementKind::go_to, begin);
    add_value(target);
  } else if (word == "ELSE") {
    add(StatementKind::branch_else, begin);
  } else if (word == "ENDIF") {
    add(StatementKind::branch_end, begin);
  } else if (word == "THEN") {
    throw MacroError(begin, "statement", "THEN without IF; IF [condition] THEN was expected");
  } else if (word == "DPRNT" || word == "BPRNT" || word == "POPEN" || word == "PCLOS" || word == "SETVN") {
    at_ = end_;
    return Found::ignored;
  } else {
    at_ = begin;
    return Found::nothing;
  }
  return Found::statement;
}

void StatementReader::read_if(std::size_t begin) {
  const std::uint32_t condition = expressions().read_bracketed();
  bool then = take("THEN");
  if (!then && take("TH")) {
    out_.expressions.note_abbreviation(at_ - 2);
    then = true;
  }
  const bool alone = at_block_end();
  if (alone && !then)
    throw MacroError(begin, "statement", "IF [condition] with nothing after it; GOTO or THEN was expected");
  add(alone ? StatementKind::branch_if : StatementKind::condition, begin);
  add_value(condition);
}

void StatementReader::read_while(std::size_t begin) {
  const std::uint32_t condition = expressions().read_bracketed();
  if (!take("DO"))
    throw MacroError(at_, "statement", "WHILE [condition] without DO; WHILE [condition] DO 1 was expected");
  read_loop_number(StatementKind::loop, begin, "DO");
  add_value(condition);
}

void StatementReader::read_loop_number(StatementKind kind, std::size_t begin, std::string_view what) {
  const std::uint32_t number = whole_number(what);
  add(kind, begin, label_index(fmt::format("DO {}", number)));
}

void StatementReader::read_assignment() {
  const std::size_t begin = at_++;
  skip_blanks();
  const bool named = at_ < end_ && text_[at_] == '<';
  const std::uint32_t target = named ? expressions().read_name() : expressions().read_variable_number();
  skip_blanks();
  if (at_ >= end_ || text_[at_] != '=')
    throw MacroError(begin, "statement", "a variable without an assignment; #number = value was expected");
  ++at_;
  const std::uint32_t value = expressions().read_open();
  add(named ? StatementKind::assign_name : StatementKind::assign_number, begin, named ? target : Statement::kNoLabel);
  if (!named) add_value(target);
  add_value(value);
}

// --- O-words --------------------------------------------------------------------------------------------------------

StatementReader::Found StatementReader::read_o_word() {
  const std::size_t begin = at_++;
  skip_blanks();
  const char c = at_ < end_ ? text_[at_] : '\0';
  std::uint32_t label = Statement::kNoLabel, computed = Statement::kNone;
  if (c == '<') {
    const std::uint32_t names = static_cast<std::uint32_t>(out_.expressions.names.size());
    label = label_index(out_.expressions.names[expressions().read_name()]);
    if (out_.expressions.names.size() > names) out_.expressions.names.pop_back();
  } else if (c == '#' || c == '[') {
    computed = expressions().read_value();
  } else if (is_digit(c)) {
    std::size_t digits = at_;
    while (digits < end_ && (is_digit(text_[digits]) || is_blank(text_[digits]))) ++digits;
    if (digits >= end_ || !is_letter(text_[digits])) return at_ = begin, Found::nothing;
    label = label_index(fmt::format("{}", whole_number("O")));
  } else {
    return at_ = begin, Found::nothing;
  }
  skip_blanks();
  const std::size_t first = out_.statements.size();
  if (!read_o_keyword(begin, label, computed != Statement::kNone)) {
    if (c == '<') return Found::ignored;
    if (computed != Statement::kNone)
      throw MacroError(begin, "statement", "a computed O number may only be called; CALL was expected after it");
    return at_ = begin, Found::nothing;
  }
  if (computed != Statement::kNone) {
    Statement& call = out_.statements[first];
    out_.values.insert(out_.values.begin() + call.first_value, computed);
    ++call.value_count;
  }
  return Found::statement;
}

bool StatementReader::read_o_keyword(std::size_t begin, std::uint32_t label, bool computed) {
  std::size_t letters = at_;
  std::string word;
  while (letters < end_ && is_letter(text_[letters]) && word.size() < 12) word += upper(text_[letters++]);
  const auto k = std::find_if(kOKeywords.begin(), kOKeywords.end(), [&](const OKeyword& o) { return o.word == word; });
  if (k == kOKeywords.end() || (computed && k->kind != StatementKind::call)) return false;
  at_ = letters;
  std::vector<std::uint32_t> values;
  const std::size_t most = k->values == -2 ? kMaxArguments : k->values == 0 ? 0 : 1;
  for (skip_blanks(); at_ < end_ && text_[at_] == '[' && values.size() <= most; skip_blanks()) {
    if (values.size() == most && k->kind == StatementKind::call)
      throw MacroError(at_, "statement", fmt::format("more than {} arguments of a call", kMaxArguments));
    if (values.size() == most) break;
    values.push_back(expressions().read_bracketed());
  }
  if (k->values == 1 && values.empty()) throw MacroError(begin, "statement", fmt::format("{} has no [value]", word));
  Statement& s = add(k->kind, begin, label);
  s.o_word = true;
  s.repeats = word == "REPEAT";
  for (const std::uint32_t v : values) add_value(v);
  return true;
}

}  // namespace camber::nc
