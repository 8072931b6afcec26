#include "nc/program_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/numbers.h"
#include "nc/iso_language.h"
#include "nc/language.h"
#include "nc/modal_codes.h"
#include "nc/reporter.h"

namespace camber::nc {
namespace {

// --- words that are no NC words: macro statements, subprograms, the languages of other controls

struct ForeignWord {
  std::string message;          ///< what it is and what was expected
  std::string check;            ///< name of the check
  bool other_language = false;  ///< the whole file is of another language: reading on makes no sense
};

constexpr std::array<std::string_view, 37> kSiemensWords = {
    "DEF",    "SUPA",  "CYCLE",  "TRAFOOF", "TRAORI", "COMPOF", "COMPON", "COMPCAD", "COMPCURV", "MSG",
    "MCALL",  "FNORM", "TRANS",  "ATRANS",  "ROT",    "AROT",   "MIRROR", "SCALE",   "FFWON",    "FFWOF",
    "SOFT",   "BRISK", "CR",     "TURN",    "CIP",    "CFTCP",  "DIAMOF", "DIAMON",  "REPEATB",  "WORKPIECE",
    "EXTERN", "PROC",  "STOPRE", "ORIWKS",  "OFFN",   "WCS",    "GROUP"};
constexpr std::array<std::string_view, 12> kHeidenhainWords = {"BEGIN", "PGM", "TOOL", "CYCL", "BLK", "FMAX",
                                                               "LBL",   "CC",  "RND",  "CHF",  "FN",  "FUNCTION"};
constexpr std::array<std::string_view, 13> kOWord = {"SUB",    "CALL",      "ENDSUB", "ENDWHILE", "ELSEIF",
                                                     "RETURN", "REPEAT",    "BREAK",  "CONTINUE", "OCALL",
                                                     "OSUB",   "ENDREPEAT", "OIF"};

template <std::size_t N>
bool among(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// "SUPA belongs to Siemens Sinumerik programs; this text is read as ISO G code ..."
ForeignWord of_language(std::string_view name, LanguageId id) {
  const Language& language = language_of(id);
  return {fmt::format("{} belongs to {} programs, and this text is read as {}; --dialect {} reads it in that language",
                      name, language.title, language_of(LanguageId::iso).title, language.name),
          std::string(language.name), true};
}

/// What to say of two or more letters, e.g. "SUPA", "GOTO", "XY"; `name` is in upper case.
ForeignWord explain_letters(std::string_view name) {
  if (among(kSiemensWords, name)) return of_language(name, LanguageId::siemens);
  if (among(kOWord, name))
    return {fmt::format("{} without its O number; O100 {} or O<name> {} was expected", name, name, name), "statement",
            false};
  if (among(kHeidenhainWords, name)) return of_language(name, LanguageId::heidenhain);
  if (name.size() == 2)
    return {fmt::format("{} has no number; a number was expected", name.front()), "no-number", false};
  return {fmt::format("{} is not an NC word; a letter and a number were expected", name), "not-a-word", false};
}

/// A letter or an address with `=` behind it, e.g. `T="MILL"`, `R1=5`.
ForeignWord explain_assignment(std::string_view address) {
  if (address.size() > 1 && address.front() == 'Q')
    return {fmt::format("{}= is of a cycle in a DIN/ISO program of a Heidenhain control, which is not supported; the "
                        "program in Klartext was expected",
                        address),
            "not-supported", true};
  return of_language(fmt::format("{}=", address), LanguageId::siemens);
}

// --- the text

/// Characters of a tape that are no text: its blank leader, rubouts, and what switches readers and punches (DC1 to
/// DC4).
bool is_of_tape(char c) { return c == '\0' || c == '\x7f' || (c >= '\x11' && c <= '\x14'); }
bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f' || is_of_tape(c);
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

/// Letters whose number some CAM systems and people leave out; they are taken as zero, with a warning.
bool may_lack_number(char letter) {
  return letter == 'P' || letter == 'Q' || letter == 'D' || letter == 'H' || letter == 'L';
}

std::string printable(unsigned char c) {
  if (c > 32 && c < 127) return fmt::format("`{}`", static_cast<char>(c));
  return fmt::format("byte 0x{:02X}", c);
}

/// Walks over a line without reading it.
class Glance {
 public:
  Glance(std::string_view text, std::size_t at, std::size_t end) : text_(text), at_(at), end_(end) {}

  /// True where up to the end, or to the next `;`, there are words and comments and nothing else, and at least one
  /// word.
  bool reads_as_block() {
    bool any = false;
    for (skip_blanks(); at_ < end_ && text_[at_] != ';'; skip_blanks()) {
      if (text_[at_] == '(') {
        if (!skip_comment()) return false;
      } else if (word() || assignment()) {
        any = true;
      } else {
        return false;
      }
    }
    return any;
  }

  /// The code of an M word that ends a program; comments are passed over.
  bool ends_program() {
    for (; at_ < end_; ++at_) {
      if (text_[at_] == '(' && !skip_comment()) return false;
      if (at_ >= end_ || upper(text_[at_]) != 'M') continue;
      std::size_t digits = at_ + 1;
      while (digits < end_ && (is_digit(text_[digits]) || text_[digits] == ' ')) ++digits;
      const auto code = parse_number(text_.substr(at_ + 1, digits - at_ - 1));
      if (code && (*code == 2 || *code == 30 || *code == 99)) return true;
    }
    return false;
  }

 private:
  void skip_blanks() {
    while (at_ < end_ && is_blank(text_[at_])) ++at_;
  }

  bool skip_comment() {
    const std::size_t close = text_.find(')', at_);
    if (close >= end_) return false;
    at_ = close + 1;
    return true;
  }

  /// A letter and a number, a variable or an expression; ,R and its kind; statements.
  bool word() {
    std::size_t i = at_ + (text_[at_] == ',' ? 1 : 0);
    std::size_t letters = i;
    while (letters < end_ && is_letter(text_[letters])) ++letters;
    if (letters == i) return false;
    if (letters - i > 1) {
      std::string keyword;
      for (std::size_t k = i; k < letters; ++k) keyword += upper(text_[k]);
      constexpr std::array<std::string_view, 11> kKeywords{"IF",   "WHILE", "WH",   "DO", "END", "EN",
                                                           "GOTO", "GO",    "THEN", "TH", "ELSE"};
      if (std::ranges::find(kKeywords, keyword) == kKeywords.end()) return false;
    }
    at_ = letters;
    return value();
  }

  bool value() {
    skip_blanks();
    while (at_ < end_ && (text_[at_] == '-' || text_[at_] == '+')) ++at_;
    if (at_ < end_ && text_[at_] == '#') ++at_;
    if (at_ < end_ && text_[at_] == '[') {
      int depth = 0;
      for (; at_ < end_; ++at_) {
        depth += text_[at_] == '[' ? 1 : text_[at_] == ']' ? -1 : 0;
        if (depth == 0) return ++at_, true;
      }
      return false;
    }
    const std::size_t begin = at_;
    while (at_ < end_ && (is_digit(text_[at_]) || text_[at_] == '.')) ++at_;
    return at_ > begin;
  }

  /// #1 = anything up to the end of the block.
  bool assignment() {
    if (text_[at_] != '#') return false;
    const std::size_t end = std::min(text_.find(';', at_), end_);
    if (text_.find('=', at_) >= end) return false;
    at_ = end;
    return true;
  }

  std::string_view text_;
  std::size_t at_, end_;
};

constexpr std::array<double, 20> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,
                                                 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19};

/// Reads the text in one pass. Each block is read on its own; a block with an error keeps the words before it.
class Scanner {
 public:
  Scanner(Program& program, Reporter& report, Reporter& behind_end)
      : program_(program),
        main_report_(report),
        behind_end_(behind_end),
        text_(program.source.text().data()),
        size_(program.source.text().size()) {}

  /// False when the text is of another language and reading on makes no sense.
  bool run() {
    program_.blocks.reserve(program_.source.line_count());
    program_.words.reserve(size_ / 4);  // pages that are not written to cost nothing
    const std::size_t leader = leader_length();
    std::size_t at = 0;
    while (at < size_ && !foreign_ && !main_report_.full()) {
      const void* found = std::char_traits<char>::find(text_ + at, size_ - at, program_.source.line_end());
      const std::size_t next = found ? static_cast<std::size_t>(static_cast<const char*>(found) - text_) : size_;
      std::size_t end = next;
      while (end > at && text_[end - 1] == '\r') --end;
      if (at < leader)
        pass_over(at, end);
      else
        scan_block(at, end);
      at = next + 1;
    }
    return !foreign_;
  }

 private:
  /// Returns the bytes before the line with the first %, where that begins the program: a control reads nothing before
  /// it. Where a program ends before the %, or none stands behind it, the % is the end.
  std::size_t leader_length() const {
    const auto first_of_line = [&](std::size_t at) {
      while (at > 0 && text_[at - 1] != program_.source.line_end())
        if (!is_blank(text_[--at])) return false;
      return true;
    };
    const std::string_view all = text();
    std::size_t start = all.find('%');
    while (start != std::string_view::npos && !first_of_line(start)) start = all.find('%', start + 1);
    if (start == std::string_view::npos || start == 0) return 0;
    if (Glance(all, 0, start).ends_program() || is_program(start)) return 0;
    const std::size_t behind = all.find_first_not_of(std::string_view("% \t\r\n\0\x7f\x1a", 8), start);
    if (behind == std::string_view::npos) return 0;
    while (start > 0 && text_[start - 1] != program_.source.line_end()) --start;
    return start;
  }

  /// True when more of the lines up to `end` are blocks than text.
  bool is_program(std::size_t end) const {
    std::size_t blocks = 0, others = 0;
    for (std::size_t at = 0; at < end;) {
      const std::size_t next = std::min(text().find(program_.source.line_end(), at), end);
      std::size_t first = at;
      while (first < next && is_blank(text_[first])) ++first;
      if (first < next && text_[first] != '(' && text_[first] != ';')
        ++(Glance(text(), first, next).reads_as_block() ? blocks : others);
      at = next + 1;
    }
    return blocks > others;
  }

  /// A line of the leader: a block without words.
  void pass_over(std::size_t begin, std::size_t end) {
    Block block;
    block.offset = static_cast<std::uint32_t>(begin);
    block.length = static_cast<std::uint32_t>(end - begin);
    program_.blocks.push_back(block);
    ++program_.leader_blocks;
    while (begin < end && is_blank(text_[begin])) ++begin;
    if (begin < end && text_[begin] != '(' && text_[begin] != ';')
      main_report_.warning(begin, "before-start", "text before the first % is no part of the program and is not read",
                           "before-start");
  }

  void scan_block(std::size_t begin, std::size_t end) {
    Block block;
    block.offset = static_cast<std::uint32_t>(begin);
    block.length = static_cast<std::uint32_t>(end - begin);
    block.first_word = static_cast<std::uint32_t>(program_.words.size());
    at_ = block_begin_ = begin;
    end_ = end;
    if (ended_) ended_ = !begins_program(begin, end);
    report_ = ended_ ? &behind_end_ : &main_report_;
    skip_ = 0;
    flow_ = false;
    if (begin == 0 && end >= 3 && std::string_view(text_, 3) == "\xEF\xBB\xBF") at_ = 3;  // byte order mark
    behind_percent_ &= ended_;
    if (behind_percent_) pass_behind_percent();
    const std::size_t parts = program_.parts.size();
    while (at_ < end_ && scan_item_or_fail(begin)) {
    }
    std::size_t count = program_.words.size() - block.first_word;
    if (program_.parts.size() > parts) {
      block.divided = true;
      count = close_parts(parts, block.first_word);
    }
    if (count > std::numeric_limits<std::uint16_t>::max()) {
      report_->error(begin, "too-many-words", fmt::format("{} words in one block; at most 65535 are read", count));
      program_.words.resize(block.first_word);
      program_.parts.resize(parts);
      block.divided = false;
      std::erase_if(program_.macro.words, [&](const ExpressionWord& w) { return w.word >= block.first_word; });
      count = 0;
    }
    block.word_count = static_cast<std::uint16_t>(count);
    block.skip = skip_;
    block.flow = flow_;
    program_.blocks.push_back(block);
    for (std::size_t i = block.first_word; i < program_.words.size(); ++i)
      ended_ |= program_.words[i].letter == 'M' && (program_.words[i].value == 2 || program_.words[i].value == 30);
  }

  /// Gives the parts of a line their words. Returns how many are left for the block itself.
  std::size_t close_parts(std::size_t first, std::uint32_t first_word) {
    auto end = static_cast<std::uint32_t>(program_.words.size());
    for (std::size_t i = program_.parts.size(); i-- > first;) {
      program_.parts[i].word_count = end - program_.parts[i].first_word;
      end = program_.parts[i].first_word;
    }
    return end - first_word;
  }

  /// Handles a `;`: the end of a block, where words follow; else a comment begins.
  bool scan_divider(std::size_t block_begin) {
    const bool first = text().substr(block_begin, at_ - block_begin).find_first_not_of(" \t") == std::string_view::npos;
    if (first || !Glance(text(), at_ + 1, end_).reads_as_block()) return false;
    ++at_;
    program_.parts.push_back({static_cast<std::uint32_t>(program_.blocks.size()), static_cast<std::uint32_t>(at_),
                              static_cast<std::uint32_t>(program_.words.size()), 0});
    return true;
  }

  /// A % behind the words of a program ends it: nothing is read up to the O of another one.
  void end_at_percent() {
    if (ended_ || (program_.words.empty() && !program_.macro.flow())) return;
    behind_percent_ = ended_ = true;
  }

  /// A text behind the first %, as some systems name a program: %1234, % PART 7.
  bool is_title() const {
    const std::size_t first = behind_blanks();
    return first < end_ && text_[first] != '(' && !Glance(text(), first, end_).reads_as_block();
  }

  void pass_behind_percent() {
    const std::size_t at = behind_blanks();
    if (at < end_ && is_letter(text_[at]))
      main_report_.warning(at, "after-end", "text behind the % that ends the program is not read", "behind-percent");
    at_ = end_;
  }

  /// An O word, or a colon for one.
  bool begins_program(std::size_t begin, std::size_t end) const {
    while (begin < end && (is_blank(text_[begin]) || text_[begin] == '%')) ++begin;
    return begin < end && (upper(text_[begin]) == 'O' || text_[begin] == ':');
  }

  void other_language(bool found) {
    if (!ended_) foreign_ = found;
  }

  bool scan_item_or_fail(std::size_t block_begin) {
    try {
      return scan_item(block_begin);
    } catch (const MacroError& e) {
      report_->error(e.offset, e.check, e.what());
      if (!ended_) program_.macro.broken = true;
      return false;
    }
  }

  /// Reads one word, comment, statement or sign; false ends the block.
  bool scan_item(std::size_t block_begin) {
    const char c = text_[at_];
    if (is_letter(c)) return scan_word();
    if (is_blank(c)) return ++at_, true;
    switch (c) {
      case '(':
        return skip_comment('(', ')');
      case '[':
        return skip_comment('[', ']');
      case '<':
        return skip_comment('<', '>');  // a program name, as in <PART_1>
      case ';':
        return scan_divider(block_begin);
      case '%':
        end_at_percent();
        ++at_;
        if (!ended_ && !begins_program(at_, end_) && is_title()) at_ = end_;
        return true;
      case '/':
        return scan_skip();
      case '#':
        statements().read_assignment();
        return flow_ = true;
      case ':':
        return scan_program_number(block_begin);
      case ',':
        return scan_corner_word();
      default:
        return refuse(c);
    }
  }

  /// A comment may hold others of its kind. A bracket left open is an error unless the block's last bracket closes it.
  bool skip_comment(char open, char close) {
    const std::size_t begin = at_;
    int depth = 0;
    std::size_t last_close = 0;
    for (; at_ < end_; ++at_) {
      if (text_[at_] == open) ++depth;
      if (depth == 2 && open == '(' && program_.nested_comment == Program::kNowhere && !ended_)
        program_.nested_comment = static_cast<std::uint32_t>(at_);
      if (text_[at_] != close) continue;
      last_close = at_;
      if (--depth == 0) return ++at_, true;
    }
    const bool closed_at_end =
        last_close > 0 && std::string_view(text_ + last_close + 1, end_ - last_close - 1).find_first_not_of(" \t\r") ==
                              std::string_view::npos;
    if (!closed_at_end)
      report_->error(begin, "comment-open", fmt::format("the comment has no closing `{}` in its block", close), "open");
    return false;
  }

  bool scan_skip() {
    skip_ = 1;
    ++at_;
    if (at_ < end_ && text_[at_] >= '1' && text_[at_] <= '9') skip_ = static_cast<std::uint8_t>(text_[at_] - '0');
    if (at_ < end_ && is_digit(text_[at_])) ++at_;
    return true;
  }

  /// `:1234` is another way to write O1234.
  bool scan_program_number(std::size_t) { return scan_word_as('O', at_); }

  bool scan_word() {
    const char letter = upper(text_[at_]);
    const char next = at_ + 1 < end_ ? text_[at_ + 1] : '\0';
    if (letter == 'O' && scan_o_word()) return true;
    if (letter == 'O' && is_program_name()) {
      if (is_digit(text_[behind_blanks_at(at_ + 1)])) scan_word_as('O', at_);
      return false;
    }
    if (is_letter(next) && scan_statement()) return true;
    if (is_letter(next) && value_follows(at_ + 1)) return scan_word_as(letter, at_);
    if (is_letter(next) || next == '_' || next == '=' || next == '<') return refuse_letters();
    return scan_word_as(letter, at_);
  }

  /// Handles an O with a text behind it: the name of the program, in place of its number or behind it (OFinal path).
  bool is_program_name() const {
    const std::string_view before = text().substr(block_begin_, at_ - block_begin_);
    if (before.find_first_not_of(" \t%") != std::string_view::npos) return false;
    std::size_t i = at_ + 1;
    while (i < end_ && (is_blank(text_[i]) || is_digit(text_[i]))) ++i;
    const std::string name = letters_from(i);
    constexpr std::array<std::string_view, 10> kStatements{"IF", "WHILE", "WH",   "DO", "END",
                                                           "EN", "GOTO",  "ELSE", "GO", "ENDIF"};
    const auto is_text = [](const ForeignWord& w) { return w.check == "not-a-word" || w.check == "no-number"; };
    return name.size() > 1 && std::ranges::find(kStatements, name) == kStatements.end() &&
           is_text(explain_letters(name)) && is_text(explain_letters("O" + name));
  }

  StatementReader statements() {
    return {program_.macro, text(), at_, end_, static_cast<std::uint32_t>(program_.blocks.size())};
  }

  bool scan_o_word() {
    const auto found = statements().read_o_word();
    flow_ |= found == StatementReader::Found::statement;
    return found != StatementReader::Found::nothing;
  }

  bool scan_statement() {
    const auto found = statements().read_keyword();
    flow_ |= found == StatementReader::Found::statement;
    return found != StatementReader::Found::nothing;
  }

  /// True when a variable, a bracket or a function stands there, so that a word has it for its value.
  bool value_follows(std::size_t at) {
    if (at < end_ && text_[at] == '[') {
      // `Z [FEEDRATE OF Z]` is a comment behind a word without its number.
      const std::string_view inside = text().substr(at, std::min(text().find(']', at), end_) - at);
      if (inside.find_first_of("#0123456789") == std::string_view::npos) return false;
    }
    return ExpressionReader(program_.macro.expressions, text(), at, end_).begins_value();
  }

  std::string_view text() const { return {text_, size_}; }

  bool scan_word_as(char letter, std::size_t begin) {
    ++at_;
    skip_blanks();
    const std::size_t number = at_;
    double value = 0;
    if (!scan_number(value)) return lacks_number(letter, begin, number);
    if (at_ < end_ && text_[at_] == '=') return refuse_assignment(begin);
    return add_word(letter, begin, number, at_, value);
  }

  bool add_word(char letter, std::size_t begin, std::size_t number, std::size_t end, double value) {
    if (end - begin > std::numeric_limits<std::uint16_t>::max()) {
      report_->error(begin, "word-too-long", fmt::format("the word {} is longer than 65535 characters", letter));
      if (std::isnan(value)) program_.macro.words.pop_back();
      return false;
    }
    if (number - begin > std::numeric_limits<std::uint8_t>::max()) {
      report_->error(begin, "word-too-long", fmt::format("more than 255 blanks between {} and its number", letter));
      if (std::isnan(value)) program_.macro.words.pop_back();
      return false;
    }
    if ((letter == 'M' && value >= 97 && value <= 99) || (letter == 'G' && value >= 65 && value <= 67)) {
      flow_ = program_.macro.calls = true;
      program_.macro.local_calls |= letter == 'M' && value == 97;
    }
    program_.words.push_back({letter, static_cast<std::uint8_t>(number - begin),
                              static_cast<std::uint16_t>(end - begin), static_cast<std::uint32_t>(begin), value});
    return true;
  }

  void skip_blanks() {
    while (at_ < end_ && is_blank(text_[at_])) ++at_;
  }

  /// Next character of a number at or behind blanks; at_ stays behind the last character that belongs to it.
  std::size_t behind_blanks() const { return behind_blanks_at(at_); }
  std::size_t behind_blanks_at(std::size_t i) const {
    while (i < end_ && is_blank(text_[i])) ++i;
    return i;
  }

  /// Sign, digits, point, digits, with blanks between them. Up to 2^53 in 19 digits the quotient of two exact
  /// doubles is the nearest double; longer numbers go through parse_number.
  bool scan_number(double& value) {
    const std::size_t begin = at_;
    bool negative = false;
    if (at_ < end_ && (text_[at_] == '-' || text_[at_] == '+')) negative = text_[at_++] == '-';
    std::uint64_t mantissa = 0;
    int digits = 0, decimals = 0;
    bool point = false;
    for (std::size_t i = behind_blanks(); i < end_; i = behind_blanks()) {
      const char c = text_[i];
      if (is_digit(c)) {
        if (++digits <= 18) mantissa = mantissa * 10 + static_cast<std::uint64_t>(c - '0');
        decimals += point;
      } else if (c == '.' && !point) {
        point = true;
      } else {
        break;
      }
      at_ = i + 1;
    }
    if (digits == 0) return at_ = begin, false;
    if (digits > 18 || mantissa > (1ull << 53)) return long_number(begin, value);
    value = static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(decimals)];
    if (negative) value = -value;
    return true;
  }

  bool long_number(std::size_t begin, double& value) {
    std::string digits;
    for (std::size_t i = begin; i < at_; ++i)
      if (!is_blank(text_[i])) digits += text_[i];
    const auto parsed = parse_number(digits);
    value = parsed.value_or(0);
    return parsed.has_value();
  }

  bool lacks_number(char letter, std::size_t begin, std::size_t number) {
    const char c = number < end_ ? text_[number] : '\0';
    if (value_follows(number)) {
      at_ = number;
      const std::uint32_t value = ExpressionReader(program_.macro.expressions, text(), at_, end_).read_value();
      const std::size_t word = program_.words.size();
      program_.macro.words.push_back({static_cast<std::uint32_t>(word), value});
      flow_ = true;
      return add_word(letter, begin, number, at_, std::numeric_limits<double>::quiet_NaN());
    }
    if (c == '"' || c == '=')
      return refuse_assignment(begin);
    else if (may_lack_number(letter) && (c == '\0' || is_letter(c) || c == '(' || c == ';')) {
      report_->warning(begin, "no-number", fmt::format("{} has no number; it is taken as {}0", letter, letter));
      return add_word(letter, begin, begin + 1, begin + 1, 0);
    } else
      report_->error(begin, "no-number",
                     fmt::format("{}{} has no number; a number was expected", letter >= 'a' ? "," : "", upper(letter)));
    return false;
  }

  std::string letters_from(std::size_t begin) const {
    std::string name;
    for (std::size_t i = begin; i < end_ && (is_letter(text_[i]) || text_[i] == '_'); ++i) name += upper(text_[i]);
    return name;
  }

  /// CYCLE832(tolerance, type ...) of a Sinumerik as the mode that it is (kCycle832). What stands in its parentheses
  /// is a comment here. False: at_ stands at other letters.
  bool read_cycle_832() {
    constexpr std::string_view kName = "CYCLE832";
    if (end_ - at_ < kName.size()) return false;
    for (std::size_t i = 0; i < kName.size(); ++i)
      if (upper(text_[at_ + i]) != kName[i]) return false;
    const std::size_t begin = at_;
    at_ += kName.size();
    const std::size_t first = behind_blanks() + 1;
    const bool given = first < end_ && text_[first - 1] == '(';
    const std::string_view arguments = given ? std::string_view(text_ + first, end_ - first) : std::string_view();
    const bool off = arguments.empty() || arguments.find_first_not_of("0. ") == arguments.find_first_of(",)");
    return add_word('G', begin, at_, at_, off ? kCycle832Off : kCycle832);
  }

  bool refuse_letters() {
    if (read_cycle_832()) return true;
    const std::string name = letters_from(at_);
    if (at_ + name.size() < end_ && (text_[at_ + name.size()] == '=' || name.find('_') != std::string::npos))
      return refuse_assignment(at_);
    const std::string rest = name.substr(1);
    if (rest == "NAN" || rest == "INF" || rest == "INFINITY") {
      report_->error(at_, "not-a-number",
                     fmt::format("{} is not a number; a number such as {}12.5 was expected", name, name[0]));
      return false;
    }
    ForeignWord word = explain_letters(name);
    other_language(word.other_language);
    report_->error(at_, word.check, std::move(word.message));
    return false;
  }

  bool refuse_assignment(std::size_t begin) {
    std::size_t end = begin;
    while (end < end_ && text_[end] != '=' && !is_blank(text_[end]) && text_[end] != '"') ++end;
    ForeignWord word = explain_assignment(std::string_view(text_ + begin, end - begin));
    other_language(true);
    report_->error(begin, word.check, std::move(word.message));
    return false;
  }

  bool refuse(char c) {
    constexpr char kEndOfFile = '\x1a';  // of old systems, which fill their last sector with it
    const auto behind = [&](char other) { return other == kEndOfFile || is_blank(other); };
    if (c == kEndOfFile && std::all_of(text_ + at_, text_ + size_, behind)) return false;
    report_->error(at_, "unexpected-character",
                   fmt::format("{} is not expected here; a word (a letter and a number) or a comment was expected",
                               printable(static_cast<unsigned char>(c))));
    return false;
  }

  /// ,R5. ,C2. ,A30.: a word whose letter is lower case.
  bool scan_corner_word() {
    const std::size_t begin = at_++;
    skip_blanks();
    const char letter = at_ < end_ ? upper(text_[at_]) : '\0';
    if (letter != 'R' && letter != 'C' && letter != 'A') {
      report_->error(begin, "corner-word",
                     fmt::format("a comma and {}; ,R (rounding), ,C (chamfer) or ,A (angle) was expected",
                                 letter ? printable(static_cast<unsigned char>(text_[at_])) : "nothing behind it"));
      return false;
    }
    return scan_word_as(static_cast<char>(letter - 'A' + 'a'), begin);
  }

  Program& program_;
  Reporter& main_report_;
  Reporter& behind_end_;
  Reporter* report_ = &main_report_;
  const char* text_;
  std::size_t size_;
  std::size_t at_ = 0, end_ = 0, block_begin_ = 0;
  std::uint8_t skip_ = 0;
  bool flow_ = false;
  bool foreign_ = false;
  bool ended_ = false;  ///< M2, M30 or the closing % was read, and no further program has begun
  bool behind_percent_ = false;
};

/// Blocks behind M30 may run: something jumps to block numbers.
bool jumps_to_blocks(const MacroTables& macro) {
  return macro.local_calls || std::any_of(macro.statements.begin(), macro.statements.end(),
                                          [](const Statement& s) { return s.kind == StatementKind::go_to; });
}

}  // namespace

Program read_iso_program(SourceText source, Diagnostics& diagnostics) {
  Program program;
  program.source = std::move(source);
  Reporter report(program.source, diagnostics);
  Reporter behind_end(program.source, diagnostics);  // of text that no control reads
  const bool whole = Scanner(program, report, behind_end).run();
  for (const MacroError& e : link_statements(program.macro)) {
    report.error(e.offset, e.check, e.what());
    program.macro.broken = true;
  }
  const bool stop = !whole;
  const bool wordless = program.words.empty() && program.macro.statements.empty() && !report.has_errors();
  report.finish();
  if (jumps_to_blocks(program.macro)) {
    program.macro.broken |= behind_end.has_errors();
    behind_end.finish();
  }
  if (wordless) {
    const bool blank = program.source.text().find_first_not_of(" \t\r\n") == std::string::npos;
    diagnostics.add({Severity::error,
                     {program.source.name(), 0, 0},
                     blank ? "the file is empty; an NC program was expected"
                           : "the file has no NC words; an NC program was expected",
                     "empty-program",
                     {}});
  }
  if (stop) diagnostics.throw_if_errors();
  return program;
}

}  // namespace camber::nc
