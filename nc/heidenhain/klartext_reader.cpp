#include "nc/heidenhain/klartext_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "nc/heidenhain/cursor.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/heidenhain/parameters.h"
#include "nc/reporter.h"

namespace camber::nc::heidenhain {
namespace {

struct Keyword {
  std::string_view word;
  Kind kind;
};

/// The first word of a statement.
constexpr std::array kKeywords{
    Keyword{"L", Kind::line},          Keyword{"LN", Kind::normal_line},
    Keyword{"LP", Kind::polar_line},   Keyword{"C", Kind::circle},
    Keyword{"CR", Kind::radius_arc},   Keyword{"CT", Kind::tangent_arc},
    Keyword{"CP", Kind::polar_circle}, Keyword{"CTP", Kind::polar_tangent_arc},
    Keyword{"CC", Kind::centre},       Keyword{"RND", Kind::rounding},
    Keyword{"CHF", Kind::chamfer},     Keyword{"APPR", Kind::approach},
    Keyword{"DEP", Kind::departure},   Keyword{"BEGIN", Kind::begin_program},
    Keyword{"END", Kind::end_program}, Keyword{"BLK", Kind::blank_form},
    Keyword{"LBL", Kind::label},       Keyword{"FN", Kind::function},
    Keyword{"PLANE", Kind::plane},     Keyword{"TRANS", Kind::transform},
    Keyword{"PATTERN", Kind::pattern}, Keyword{"STOP", Kind::stop},
    Keyword{"ERROR", Kind::passed},
};

constexpr std::string_view kAxes = "XYZABCUVW";

bool is_axis(char c) { return kAxes.find(upper(c)) != std::string_view::npos && c != '\0'; }

/// A value may begin so.
bool begins_value(char c) { return is_digit(c) || c == '+' || c == '-' || c == '.' || c == ',' || upper(c) == 'Q'; }

constexpr std::array<double, 16> kPowersOfTen = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

class Reader {
 public:
  Reader(Program& program, Tree& tree, Reporter& report)
      : program_(program), tree_(tree), report_(report), text_(program.source.text()) {}

  void run() {
    find_lines();
    const std::size_t first = first_line();
    for (std::size_t i = 0; i < first; ++i) pass_over(i);
    program_.leader_blocks = static_cast<std::uint32_t>(first);
    for (std::size_t i = first; i < program_.blocks.size() && !report_.full();) i = read_statement(i);
  }

 private:
  void find_lines() {
    program_.blocks.reserve(program_.source.line_count());
    std::size_t at = 0;
    while (at < text_.size()) {
      const std::size_t found = text_.find(program_.source.line_end(), at);
      const std::size_t next = found == std::string_view::npos ? text_.size() : found;
      std::size_t end = next;
      while (end > at && text_[end - 1] == '\r') --end;
      Block block;
      block.offset = static_cast<std::uint32_t>(at);
      block.length = static_cast<std::uint32_t>(end - at);
      program_.blocks.push_back(block);
      at = next + 1;
    }
  }

  std::size_t begin_of(std::size_t line) const { return program_.blocks[line].offset; }
  std::size_t end_of(std::size_t line) const { return program_.blocks[line].offset + program_.blocks[line].length; }

  /// The line with BEGIN PGM: what stands before it is no part of the program. 0 where there is none.
  std::size_t first_line() const {
    for (std::size_t i = 0; i < program_.blocks.size(); ++i) {
      Statement statement;
      Cursor at(text_, behind_number(i, statement), end_of(i));
      if (at.accept("BEGIN") && at.accept("PGM")) return i;
    }
    return 0;
  }

  void pass_over(std::size_t line) {
    std::size_t at = begin_of(line);
    if (line == 0 && text_.substr(0, 3) == "\xEF\xBB\xBF") at += 3;
    while (at < end_of(line) && is_blank(text_[at])) ++at;
    if (at < end_of(line) && text_[at] != '(' && text_[at] != ';' && text_[at] != '*')
      report_.warning(at, "before-start", "text before BEGIN PGM is no part of the program and is not read",
                      "before-start");
  }

  /// Offset behind blanks, the / of a block to skip and the block number.
  std::size_t behind_number(std::size_t line, Statement& statement) const {
    std::size_t at = begin_of(line);
    const std::size_t end = end_of(line);
    if (line == 0 && text_.substr(0, 3) == "\xEF\xBB\xBF") at += 3;
    const auto blanks = [&] {
      while (at < end && is_blank(text_[at])) ++at;
    };
    const auto slash = [&] {
      if (at < end && text_[at] == '/') statement.skip = 1, ++at;
      blanks();
    };
    blanks();
    slash();
    std::size_t digits = at + (at < end && upper(text_[at]) == 'N' ? 1 : 0);
    const std::size_t first = digits;
    while (digits < end && is_digit(text_[digits])) ++digits;
    if (digits > first) {
      statement.numbered = true;
      at = digits;
      blanks();
      slash();
    }
    return at;
  }

  /// The line ends in ~, or in ~ and a comment.
  bool goes_on(std::size_t from, std::size_t end) const {
    std::size_t last = end;
    const auto trim = [&] {
      while (last > from && is_blank(text_[last - 1])) --last;
    };
    trim();
    if (last > from && text_[last - 1] == '~') return true;
    const std::size_t comment = from + std::min(text_.substr(from, end - from).find(';'), end - from);
    if (comment >= end) return false;
    last = comment;
    trim();
    return last > from && text_[last - 1] == '~';
  }

  /// A line that begins with a block number, a letter behind it.
  bool is_numbered(std::size_t line) const {
    Statement statement;
    const std::size_t at = behind_number(line, statement);
    return statement.numbered && at < end_of(line) && (is_letter(text_[at]) || text_[at] == ';' || text_[at] == '*');
  }

  /// A line that begins with a keyword: a ~ before it is one too many.
  bool begins_statement(std::size_t line) const {
    Statement statement;
    Cursor at(text_, behind_number(line, statement), end_of(line));
    if (!at.more()) return false;
    const std::string word = at.letters();
    constexpr std::array<std::string_view, 4> kPairs{"CYCL", "CYCLE", "TOOL", "CALL"};
    if (word.size() > 1)
      return std::ranges::find(kPairs, word) != kPairs.end() ||
             (word != "ERROR" && std::ranges::find(kKeywords, word, &Keyword::word) != kKeywords.end());
    return (word == "L" || word == "C") && is_blank(at.behind(1)) &&
           !begins_value_behind_blanks(at.offset() + 1, at.end());
  }

  /// Returns the line behind it.
  std::size_t read_statement(std::size_t line) {
    Statement s;
    s.block = static_cast<std::uint32_t>(line);
    std::size_t at = behind_number(line, s);
    s.begin = s.at = static_cast<std::uint32_t>(at);
    std::size_t end = end_of(line);
    const bool comment = at < end && (text_[at] == ';' || text_[at] == '*' || text_[at] == '(');
    std::size_t next = line + 1;
    for (std::size_t from = at; goes_on(from, end) && next < program_.blocks.size(); ++next) {
      if (!comment && ((s.numbered && is_numbered(next)) || begins_statement(next))) break;
      from = begin_of(next);
      end = end_of(next);
    }
    s.lines = static_cast<std::uint32_t>(next - line);
    s.end = static_cast<std::uint32_t>(end);
    if (!comment) classify(s);
    program_.blocks[line].skip = s.skip;
    s.first_word = static_cast<std::uint32_t>(program_.words.size());
    if (has_words(s.kind)) read_words(s);
    s.word_count = static_cast<std::uint32_t>(program_.words.size() - s.first_word);
    Block& block = program_.blocks[line];
    block.first_word = s.first_word;
    block.word_count = static_cast<std::uint16_t>(std::min<std::size_t>(s.word_count, 65535));
    block.flow = s.kind >= Kind::label && s.kind <= Kind::function;
    if (s.kind == Kind::label) add_label(s);
    if (s.kind == Kind::begin_program) read_begin(s);
    tree_.statements.push_back(s);
    return next;
  }

  void classify(Statement& s) {
    Cursor at(text_, s.begin, s.end);
    if (!at.more() || is_rest_of_file(at.offset())) return;
    const std::string word = at.letters();
    const char first = at.peek(), second = at.behind(1);
    const auto take = [&](Kind kind, std::size_t length) {
      s.kind = kind;
      s.at = static_cast<std::uint32_t>(at.offset() + length);
    };
    if (Cursor ahead = at; read_parameter(ahead)) return take(Kind::assignment, 0);
    if (word.size() == 1 && is_axis(first) && first != 'C' && begins_value_behind_blanks(at.offset() + 1, s.end))
      return take(Kind::line, 0);
    if (word == "C" && begins_value(second)) return take(Kind::line, 0);
    if (word.size() == 2 && word[0] == 'I' && is_axis(word[1])) return take(Kind::line, 0);
    if (word == "M" || word == "F" || word == "FMAX" || word == "R" || word == "RL" || word == "RR" ||
        (word == "S" && begins_value(second)))
      return take(Kind::functions, 0);
    const auto known = std::ranges::find(kKeywords, word, &Keyword::word);
    if (known != kKeywords.end()) return take(known->kind, word.size());
    if (classify_pair(s, at, word)) return;
    // LX+5, CCX+1: no blank behind the keyword.
    for (const Keyword& k : kKeywords)
      if (has_words(k.kind) && word.starts_with(k.word) && word.size() <= k.word.size() + 2 &&
          (is_axis(word[k.word.size()]) || word[k.word.size()] == 'I') && is_axis(word.back()) &&
          begins_value_behind_blanks(at.offset() + word.size(), s.end))
        return take(k.kind, k.word.size());
    s.kind = Kind::refused;
  }

  /// Statements of two words.
  bool classify_pair(Statement& s, Cursor at, const std::string& word) {
    const auto take = [&](Kind kind) {
      s.kind = kind;
      s.at = static_cast<std::uint32_t>(at.offset());
      return true;
    };
    at.advance(word.size());
    if (word == "TOOL") {
      if (at.accept("CALL")) return take(Kind::tool_call);
      if (at.accept("DEF")) return take(Kind::tool_def);
    } else if (word == "CYCL" || word == "CYCLE") {
      if (at.accept("DEF")) return take(Kind::cycle_def);
      if (at.accept("CALL")) return take(Kind::cycle_call);
    } else if (word == "CALL") {
      if (at.accept("LBL")) return take(Kind::call_label);
      if (at.accept("PGM")) return take(Kind::call_program);
      if (at.accept("SELECTED")) return take(Kind::select_program);
    } else if (word == "DECLARE") {
      if (at.accept("STRING")) return take(Kind::assignment);
    } else if (word == "SEL") {
      if (at.accept("PGM")) return take(Kind::select_program);
      if (at.accept("TABLE")) return take(Kind::passed);
      if (at.accept("CORR")) return take(Kind::noted);
    } else if (word == "FUNCTION") {
      if (at.accept("TCPM")) return take(Kind::tcpm);
      const Cursor behind = at;
      const bool reset = at.accept("RESET");
      if (reset && at.accept("TCPM")) {
        at = behind;
        return take(Kind::tcpm);
      }
      if (!reset && at.accept("MODE")) return !at.accept("TURN") && take(Kind::passed);
      if (!reset && at.accept("DWELL")) return take(Kind::dwell);
      for (const char* other : {"FEED", "S", "PROG", "FILE", "COUNT", "LIFTOFF", "CORRDATA"})
        if (at.accept(other)) return take(Kind::noted);
    }
    return false;
  }

  bool begins_value_behind_blanks(std::size_t at, std::size_t end) const {
    while (at < end && is_blank(text_[at])) ++at;
    return at < end && begins_value(text_[at]);
  }

  /// Control characters at the end of a file.
  bool is_rest_of_file(std::size_t at) const {
    return std::all_of(text_.begin() + static_cast<std::ptrdiff_t>(at), text_.end(),
                       [](char c) { return static_cast<unsigned char>(c) <= ' '; });
  }

  void add_label(const Statement& s) {
    Cursor at(text_, s.at, s.end);
    std::string name;
    if (auto text = at.quoted())
      name = *text;
    else if (auto number = at.integer())
      name = fmt::format("{}", *number);
    else
      return report_.error(s.begin, "label",
                           "LBL without a number or a name in quotes; LBL 1 or LBL \"NAME\" was expected");
    if (name == "0") return;
    const auto [found, is_new] = tree_.labels.emplace(name, static_cast<std::uint32_t>(tree_.statements.size()));
    if (!is_new)
      report_.warning(s.begin, "label",
                      fmt::format("LBL {} stands again; the first one, in line {}, is used", name,
                                  program_.source.location(tree_.statements[found->second].begin).line));
  }

  void read_begin(const Statement& s) {
    if (std::exchange(begun_, true)) return;  // a second program of the file
    tree_.begin_statement = static_cast<std::uint32_t>(tree_.statements.size());
    const std::string_view line = text_.substr(s.at, end_of(s.block) - s.at);
    std::size_t last = line.find_last_not_of(" \t\r");
    std::size_t first = last;
    while (first != std::string_view::npos && first > 0 && is_letter(line[first - 1])) --first;
    std::string unit;
    if (last != std::string_view::npos)
      for (std::size_t i = first; i <= last; ++i) unit += upper(line[i]);
    tree_.inch = unit == "INCH" || unit == "IN";
    if (!tree_.inch && unit != "MM")
      report_.warning(s.begin, "unit-missing", "BEGIN PGM names no unit; MM or INCH was expected, MM is assumed");
  }

  // --- words

  void read_words(const Statement& s) {
    Cursor at(text_, s.at, s.end);
    kind_ = s.kind;
    first_word_ = program_.words.size();
    if (s.kind == Kind::approach || s.kind == Kind::departure) skip_form(at);
    after_m_ = -1;
    while (at.more() && read_word(at)) {
    }
  }

  /// LT, LN, CT, LCT, PLT ... : the interpreter reads it.
  static void skip_form(Cursor& at) { at.advance(at.letters().size()); }

  bool read_word(Cursor& at) {
    const std::size_t begin = at.offset();
    const char c = at.peek(), next = at.behind(1);
    if (after_m_ >= 0 && read_argument(at, begin)) return true;
    if (is_unanswered(c, begin, at.end())) return at.advance(), true;
    if (c == 'I' && is_axis(next)) return value_word(at, begin, next, 2);
    if (c == 'I' && next == 'P' && at.behind(2) == 'A') return value_word(at, begin, letter::kPolarAngle, 3);
    if (c == 'I' && next == 'P' && at.behind(2) == 'R') return value_word(at, begin, letter::kPolarRadius, 3);
    if (c == 'C' && next == 'C' && at.behind(2) == 'A') return value_word(at, begin, letter::kArcAngle, 3);
    if (c == 'N' && is_axis(next)) return vector_word(at, begin, letter::kNormal);
    if (c == 'T' && is_axis(next)) return vector_word(at, begin, letter::kTool);
    if (c == 'L' && next == 'E' && at.behind(2) == 'N') return value_word(at, begin, letter::kLength, 3);
    if (is_axis(c)) return value_word(at, begin, c, 1);
    switch (c) {
      case 'F':
        return feed_word(at, begin);
      case 'R':
        return radius_word(at, begin);
      case 'D':
        if (next == 'R') return sense_word(at, begin);
        break;
      case 'P':
        if (next == 'R') return value_word(at, begin, letter::kPolarRadius, 2);
        if (next == 'A') return value_word(at, begin, letter::kPolarAngle, 2);
        break;
      case 'M':
        return m_word(at, begin);
      case 'S':
        return value_word(at, begin, 'S', 1);
      default:
        break;
    }
    const bool first = program_.words.size() == first_word_;
    if ((kind_ == Kind::chamfer || kind_ == Kind::rounding) && begins_value(c) && first)
      return value_word(at, begin, 'R', 0);
    report_.error(
        begin, "not-a-word",
        fmt::format("{} is no word of a Klartext block; coordinates, R0, F, DR or M were expected", at.word()));
    return false;
  }

  /// R, F or M alone, as older controls and their posts write a question that was not answered: what was before holds.
  bool is_unanswered(char c, std::size_t begin, std::size_t end) const {
    const bool has_radius = kind_ == Kind::radius_arc || kind_ == Kind::rounding || kind_ == Kind::chamfer;
    if (c != 'F' && c != 'M' && (c != 'R' || has_radius)) return false;
    if (begin + 1 < end && !is_blank(text_[begin + 1]) && text_[begin + 1] != ';') return false;
    Cursor behind(text_, begin + 1, end);
    const std::string word = behind.letters();
    return !begins_value(behind.peek()) && (c != 'F' || (word != "MAX" && word != "AUTO"));
  }

  void add(char letter, std::size_t begin, std::size_t value_at, std::size_t end, double value) {
    program_.words.push_back({letter, static_cast<std::uint8_t>(std::min<std::size_t>(value_at - begin, 255)),
                              static_cast<std::uint16_t>(std::min<std::size_t>(end - begin, 65535)),
                              static_cast<std::uint32_t>(begin), value});
  }

  /// `length`: of the address.
  bool value_word(Cursor& at, std::size_t begin, char letter, std::size_t length) {
    at.advance(length);
    at.more();
    const std::size_t value_at = at.offset();
    if (const auto value = fast_number(at)) {
      if (value_at - begin > 200) {
        report_.error(begin, "word-too-long", "more than 200 blanks between an address and its number");
        return false;
      }
      add(letter, begin, value_at, at.offset(), *value);
      return true;
    }
    if (parameter(at)) {
      add(letter, begin, value_at, at.offset(), std::numeric_limits<double>::quiet_NaN());
      return true;
    }
    report_.error(begin, "no-number",
                  fmt::format("{} has no number; a number or a Q parameter was expected",
                              std::string(text_.substr(begin, std::max<std::size_t>(length, 1)))));
    return false;
  }

  /// Sign, Q, number of a parameter; false, and no move, where none stands here.
  static bool parameter(Cursor& at) {
    const std::size_t begin = at.offset();
    if (at.peek() == '+' || at.peek() == '-') at.advance();
    if (at.peek() == 'Q') {
      at.advance();
      if (!is_digit(at.behind(0)) && (at.behind(0) == 'L' || at.behind(0) == 'R')) at.advance();
      if (at.integer()) return true;
    }
    at.go_to(begin);
    return false;
  }

  std::optional<double> fast_number(Cursor& at) const {
    std::size_t i = at.offset();
    const std::size_t end = at.end();
    bool negative = false;
    if (i < end && (text_[i] == '+' || text_[i] == '-')) negative = text_[i++] == '-';
    std::uint64_t mantissa = 0;
    int digits = 0, decimals = 0;
    bool point = false;
    for (; i < end; ++i) {
      const char c = text_[i];
      if (is_digit(c)) {
        if (++digits > 15) return at.number();
        mantissa = mantissa * 10 + static_cast<std::uint64_t>(c - '0');
        decimals += point;
      } else if ((c == '.' || c == ',') && !point) {
        point = true;
      } else {
        break;
      }
    }
    if (digits == 0) return at.number();
    at.go_to(i);
    const double value = static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(decimals)];
    return negative ? -value : value;
  }

  bool vector_word(Cursor& at, std::size_t begin, const char (&letters)[3]) {
    const char axis = at.behind(1);
    if (axis < 'X' || axis > 'Z') {
      report_.error(begin, "not-a-word",
                    fmt::format("{} is no component of a vector; X, Y or Z was expected", at.word()));
      return false;
    }
    return value_word(at, begin, letters[axis - 'X'], 2);
  }

  bool feed_word(Cursor& at, std::size_t begin) {
    const auto whole = [&](char letter, std::size_t length) {
      at.go_to(begin + length);
      add(letter, begin, begin + length, begin + length, 0);
      return true;
    };
    if (at.accept_prefix("FMAX")) return whole(letter::kRapid, 4);
    if (at.accept_prefix("FAUTO")) return whole(letter::kAutoFeed, 5);
    Cursor blank = at;
    blank.advance();
    if (blank.accept("MAX")) return whole(letter::kRapid, blank.offset() - begin);
    if (blank.accept("AUTO")) return whole(letter::kAutoFeed, blank.offset() - begin);
    const char next = at.behind(1);
    if (next == 'U') return value_word(at, begin, letter::kFeedPerTurn, 2);
    if (next == 'Z') return value_word(at, begin, letter::kFeedPerTooth, 2);
    return value_word(at, begin, 'F', 1);
  }

  /// R0 RL RR R+ R-, or a radius.
  bool radius_word(Cursor& at, std::size_t begin) {
    const auto compensation = [&](double value) {
      at.advance(2);
      add(letter::kCompensation, begin, begin + 1, begin + 2, value);
      return true;
    };
    const char next = at.behind(1), third = at.behind(2);
    const bool ends = !is_digit(third) && third != '.' && third != ',' && third != 'Q' &&
                      (!is_letter(third) || third == 'F' || third == 'M');
    if (next == 'L' && ends) return compensation(1);
    if (next == 'R' && ends) return compensation(2);
    if (next == '0' && ends && kind_ != Kind::rounding) return compensation(0);
    if (next == '+' && ends && third != ' ') return compensation(3);
    if (next == '-' && ends && third != ' ') return compensation(4);
    if ((next == '+' || next == '-') && third == ' ') {
      std::size_t i = begin + 3;
      while (i < at.end() && (text_[i] == ' ' || text_[i] == '\t')) ++i;
      if (i >= at.end() || !(is_digit(text_[i]) || upper(text_[i]) == 'Q' || text_[i] == '.'))
        return compensation(next == '+' ? 3 : 4);
    }
    if (is_letter(next) && next != 'Q') {
      report_.error(
          begin, "not-a-word",
          fmt::format("{} is no word of a Klartext block; coordinates, R0, F, DR or M were expected", at.word()));
      return false;
    }
    return value_word(at, begin, 'R', 1);
  }

  bool sense_word(Cursor& at, std::size_t begin) {
    at.advance(2);
    const char sign = at.peek();
    if (sign != '+' && sign != '-') {
      report_.error(begin, "no-number", "DR has no sense; DR+ or DR- was expected");
      return false;
    }
    add(letter::kSense, begin, at.offset(), at.offset() + 1, sign == '+' ? 1 : -1);
    at.advance();
    return true;
  }

  bool m_word(Cursor& at, std::size_t begin) {
    if (!value_word(at, begin, 'M', 1)) return false;
    after_m_ = program_.words.back().value;
    return true;
  }

  /// Reads a word that belongs to the M function before it: F of M128, MB of M140, LA of M120, axes of M118 and M138.
  bool read_argument(Cursor& at, std::size_t begin) {
    const double m = after_m_;
    const auto argument = [&](std::size_t length) { return value_word(at, begin, letter::kArgument, length); };
    if (m == 140 && at.accept_prefix("MB")) {
      const std::size_t value_at = (at.more(), at.offset());
      if (at.accept("MAX")) {
        add(letter::kArgument, begin, value_at, at.offset(), std::numeric_limits<double>::infinity());
        return true;
      }
      at.go_to(begin);
      return argument(2);
    }
    if ((m == 128 || m == 103) && at.peek() == 'F' && at.behind(1) != 'M') return after_m_ = -1, argument(1);
    if (m == 120 && at.accept_prefix("LA")) return at.go_to(begin), argument(2);
    if (m == 124 && at.peek() == 'T') return argument(1);
    if ((m == 118 || m == 94) && is_axis(at.peek()) && begins_value(at.behind(1))) return m == 118 && argument(1);
    if ((m == 138 || m == 94) && is_axis(at.peek())) return at.advance(), true;
    after_m_ = -1;
    return false;
  }

  Program& program_;
  Tree& tree_;
  Reporter& report_;
  std::string_view text_;
  bool begun_ = false;  ///< BEGIN PGM was read
  Kind kind_ = Kind::nothing;
  std::size_t first_word_ = 0;
  double after_m_ = -1;  ///< the M function that words here may belong to; -1: none
};

struct Refused {
  std::string_view begins;
  std::string_view what;
  std::string_view instead;
};

/// Statements that are refused by name, with what can be done instead.
constexpr std::array kRefused{
    Refused{"TCH PROBE", "a probing cycle", "leave out probing, or set the datum that it would set (CYCL DEF 247)"},
    Refused{"FPOL", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"FSELECT", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"FLT", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"FCT", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"FL", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"FC", "free contour programming", "L, C and CR blocks with end points were expected"},
    Refused{"SPL", "a spline block", "lines or arcs were expected"},
    Refused{"FUNCTION PARAXCOMP", "parallel axes", "X, Y and Z were expected"},
    Refused{"FUNCTION PARAXMODE", "parallel axes", "X, Y and Z were expected"},
    Refused{"FUNCTION POLARKIN", "polar kinematics", "X, Y and Z were expected"},
    Refused{"FUNCTION TURNDATA", "turning", "milling blocks were expected"},
    Refused{"FUNCTION MODE", "turning", "milling blocks were expected"},
    Refused{"POLARKIN", "polar kinematics", "X, Y and Z were expected"},
    Refused{"CONTOUR", "an SL contour", "the finished path of the contour was expected"},
    Refused{"SEL CONTOUR", "an SL contour", "the finished path of the contour was expected"},
    Refused{"SEL PATTERN", "a point table", "PATTERN DEF or L blocks with M99 were expected"},
    Refused{"GLOBAL DEF", "values for cycles", "values in each CYCL DEF were expected"},
    Refused{"OPEN", "access to tables", "values in Q parameters were expected"},
};

}  // namespace

Refusal refusal_of(std::string_view statement) {
  std::string words;  // upper case, one blank between words
  for (const char c : statement)
    if (!is_blank(c))
      words += upper(c);
    else if (!words.empty() && words.back() != ' ')
      words += ' ';
  for (const Refused& r : kRefused)
    if (words.starts_with(r.begins) && (words.size() == r.begins.size() || !is_letter(words[r.begins.size()])))
      return {fmt::format("{} ({}) is not supported; {}", r.begins, r.what, r.instead), "not-supported",
              std::string(r.what)};
  const std::string first = words.substr(0, std::min<std::size_t>(words.find_first_of(" ;"), 40));
  if (first.empty()) return {"an empty statement", "not-a-word"};
  return {fmt::format("{} begins no Klartext block that is known; L, C, TOOL CALL, CYCL DEF ... were expected", first),
          "not-a-word"};
}

Program read_text(SourceText source, Diagnostics& diagnostics) {
  Program program;
  program.language = LanguageId::heidenhain;
  program.source = std::move(source);
  auto tree = std::make_shared<Tree>();
  Reporter report(program.source, diagnostics);
  Reader(program, *tree, report).run();
  const bool wordless =
      std::ranges::all_of(tree->statements, [](const Statement& s) { return s.kind == Kind::nothing; });
  program.tree = std::move(tree);
  report.finish();
  if (wordless) {
    const bool blank = program.source.text().find_first_not_of(" \t\r\n") == std::string::npos;
    diagnostics.add({Severity::error,
                     {program.source.name(), 0, 0},
                     blank ? "the file is empty; an NC program was expected"
                           : "the file has no Klartext blocks; an NC program was expected",
                     "empty-program",
                     {}});
  }
  return program;
}

}  // namespace camber::nc::heidenhain
