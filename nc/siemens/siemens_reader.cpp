#include "nc/siemens/siemens_language.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "nc/reporter.h"
#include "nc/siemens/line_parser.h"

namespace camber::nc::siemens {
namespace {

constexpr double kPowersOfTen[] = {1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};

constexpr char kEndOfFile = '\x1a';  ///< end-of-file mark of old systems

/// Letters of plain words.
constexpr bool is_plain(char letter) {
  return std::string_view("NGXYZFABCIJKSTMDHUVWQ").find(letter) != std::string_view::npos;
}

class Reader {
 public:
  Reader(Program& program, Tree& tree, Reporter& report)
      : program_(program), tree_(tree), names_(tree), report_(report), text_(program.source.text()) {}

  void run() {
    program_.blocks.reserve(program_.source.line_count());
    program_.words.reserve(text_.size() / 5);
    tree_.parts.push_back({});
    std::size_t at = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;
    if (at > 0) bom_ = true;
    while (at < text_.size() && !report_.full()) {
      std::size_t next = text_.find(program_.source.line_end(), at);
      if (next == std::string_view::npos) next = text_.size();
      std::size_t end = next;
      while (end > at && text_[end - 1] == '\r') --end;
      read_block(bom_ ? 0 : at, at, end);
      bom_ = false;
      at = next + 1;
    }
    tree_.parts.back().end = block();
    link();
  }

 private:
  std::uint32_t block() const { return static_cast<std::uint32_t>(program_.blocks.size()); }

  void read_block(std::size_t begin, std::size_t at, std::size_t end) {
    Block block;
    block.offset = static_cast<std::uint32_t>(begin);
    block.length = static_cast<std::uint32_t>(end - begin);
    block.first_word = static_cast<std::uint32_t>(program_.words.size());
    if (!read_plain(block.first_word, at, end)) {
      program_.words.resize(block.first_word);
      read_statement(block, at, end);
    }
    const std::size_t count = program_.words.size() - block.first_word;
    if (count > std::numeric_limits<std::uint16_t>::max()) {
      report_.error(begin, "too-many-words", fmt::format("{} words in one block; at most 65535 are read", count));
      program_.words.resize(block.first_word);
    }
    block.word_count = static_cast<std::uint16_t>(program_.words.size() - block.first_word);
    if (block.word_count > 0 && program_.words[block.first_word].letter == 'N')
      note_number(program_.words[block.first_word]);
    program_.blocks.push_back(block);
  }

  void note_number(const Word& word) {
    tree_.numbers.emplace_back(static_cast<std::uint64_t>(std::max(word.value, 0.0)), block());
  }

  /// Words of one letter and a number, CR=number, and a comment. False where anything else stands in the line.
  bool read_plain(std::size_t first_word, std::size_t at, std::size_t end) {
    const char* const text = text_.data();
    while (at < end) {
      const char c = text[at];
      if (c == ' ' || c == '\t') {
        ++at;
        continue;
      }
      if (c == ';' || c == kEndOfFile) return true;
      const std::size_t begin = at;
      char letter = upper(c);
      ++at;
      if (letter == 'C' && at + 1 < end && upper(text[at]) == 'R' && text[at + 1] == '=') {
        letter = 'R';
        at += 2;
      } else if (!is_letter(c) || !is_plain(letter)) {
        return false;
      } else {
        while (at < end && text[at] == ' ') ++at;
      }
      const std::size_t number = at;
      double value = 0;
      if (!read_number(text, at, end, value)) return false;
      std::size_t behind = at;
      while (behind < end && text[behind] == ' ') ++behind;
      if (behind < end && (text[behind] == '=' || text[behind] == '+' || text[behind] == '-' || text[behind] == '*' ||
                           text[behind] == '/' || text[behind] == '(' || text[behind] == '[' || text[behind] == '.' ||
                           text[behind] == '<' || text[behind] == '_'))
        return false;
      if (letter == 'N' &&
          (begin != number - 1 || text[number] == '-' || text[number] == '+' || value != std::floor(value)))
        return false;
      if (letter == 'N' && program_.words.size() > first_word) return false;
      if (at - begin > 200) return false;
      program_.words.push_back({letter, static_cast<std::uint8_t>(number - begin),
                                static_cast<std::uint16_t>(at - begin), static_cast<std::uint32_t>(begin), value});
    }
    return true;
  }

  static bool read_number(const char* text, std::size_t& at, std::size_t end, double& value) {
    bool minus = false;
    if (at < end && (text[at] == '-' || text[at] == '+')) minus = text[at++] == '-';
    std::uint64_t mantissa = 0;
    int digits = 0, decimals = 0;
    bool point = false;
    for (; at < end; ++at) {
      const char c = text[at];
      if (is_digit(c)) {
        mantissa = mantissa * 10 + static_cast<std::uint64_t>(c - '0');
        ++digits;
        decimals += point;
      } else if (c == '.' && !point) {
        point = true;
      } else {
        break;
      }
    }
    if (digits == 0 || digits > 15) return false;
    value = static_cast<double>(mantissa) / kPowersOfTen[decimals];
    if (minus) value = -value;
    return true;
  }

  void read_statement(Block& block, std::size_t at, std::size_t end) {
    if (begin_part(at, end)) return;
    LineParser parser(tree_, names_, text_, at, end);
    std::string number;
    Statement statement;
    try {
      statement = parser.parse(this->block(), number);
    } catch (const ParseError& e) {
      report_.error(e.offset, e.check, e.what());
      block.flow = true;
      return;
    }
    block.skip = parser.skip();
    if (!number.empty()) add_number_word(number, at, end);
    for (const Item& item : statement.items) {
      if (item.kind == ItemKind::label) tree_.labels[tree_.names[item.name]].push_back(this->block());
      add_word(item);
    }
    block.flow =
        statement.flow != FlowKind::none || std::ranges::any_of(statement.items, [](const Item& i) {
          return i.kind == ItemKind::call || i.kind == ItemKind::assign || (i.kind == ItemKind::word && !i.constant);
        });
    if (statement.flow != FlowKind::none || !statement.items.empty()) tree_.statements.push_back(std::move(statement));
  }

  /// The N word of a block that is no plain one.
  void add_number_word(const std::string& number, std::size_t at, std::size_t end) {
    std::size_t begin = at;
    while (begin < end && upper(text_[begin]) != 'N' && text_[begin] != ':') ++begin;
    std::size_t to = begin + 1;
    double value = 0;
    while (to < end && is_digit(text_[to])) value = value * 10 + (text_[to++] - '0');
    if (number[0] == ':') {
      tree_.labels[number].push_back(block());
      return;
    }
    if (to - begin > 200) return;
    program_.words.push_back(
        {'N', 1, static_cast<std::uint16_t>(to - begin), static_cast<std::uint32_t>(begin), value});
  }

  /// Adds a word that edits may change, under the letter that it has in all languages.
  void add_word(const Item& item) {
    if (item.kind != ItemKind::word || item.index != kNone) return;
    const std::string& name = tree_.names[item.name];
    char letter = name.size() == 1 ? name[0] : '\0';
    if (item.row && item.row->name != "CR") return;
    if (item.row) letter = 'R';
    if (letter == '\0') return;
    if (letter != 'R' && !is_plain(letter)) return;
    const Node& node = tree_.nodes[item.value];
    std::size_t from = node.offset, to = node.offset + node.length;
    if (!item.constant) {
      to = item.offset + item.length;
      from = std::min<std::size_t>(from, to);
    }
    if (to < from || from - item.offset > 255 || to - item.offset > 65535) return;
    program_.words.push_back({letter, static_cast<std::uint8_t>(from - item.offset),
                              static_cast<std::uint16_t>(to - item.offset), item.offset,
                              item.constant ? item.number : std::numeric_limits<double>::quiet_NaN()});
  }

  /// Begins a program at %_N_SLOT_SPF, or at % alone, which are no blocks. False elsewhere.
  bool begin_part(std::size_t at, std::size_t end) {
    while (at < end && is_blank(text_[at])) ++at;
    if (at >= end || text_[at] != '%') return false;
    std::string name;
    for (std::size_t i = at + 1; i < end && text_[i] != ';' && !is_blank(text_[i]); ++i) name += upper(text_[i]);
    if (name.starts_with("_N_")) name.erase(0, 3);
    if (name.empty()) return true;
    const std::size_t type = name.rfind('_');
    if (type != std::string::npos && name.size() - type == 4) name.resize(type);
    Part& last = tree_.parts.back();
    const bool nothing_yet = program_.words.empty() && tree_.statements.empty();
    if (nothing_yet) {
      last.name = name;
      return true;
    }
    last.end = block();
    tree_.parts.push_back({name, block(), block()});
    return true;
  }

  // --- loops and branches

  void link() {
    std::ranges::sort(tree_.numbers);
    for (auto& [name, blocks] : tree_.labels) std::ranges::sort(blocks);
    std::vector<Statement*> open;
    std::size_t part = 0;
    for (Statement& s : tree_.statements) {
      while (part < tree_.parts.size() && s.block >= tree_.parts[part].end) {
        close(open);
        ++part;
      }
      link(s, open);
    }
    close(open);
  }

  static std::string_view text_of(FlowKind kind) {
    constexpr std::array<std::string_view, 14> kNames{
        // in the order of the enum
        "", "IF", "ELSE", "ENDIF", "", "", "FOR", "ENDFOR", "WHILE", "ENDWHILE", "REPEAT", "UNTIL", "LOOP", "ENDLOOP"};
    static_assert(kNames.size() == static_cast<std::size_t>(FlowKind::end_loop) + 1);
    return kNames[std::min(static_cast<std::size_t>(kind), kNames.size() - 1)];
  }

  /// The end of a loop stands behind its beginning in the enum.
  static FlowKind end_of(FlowKind kind) {
    const bool loop = kind == FlowKind::for_loop || kind == FlowKind::while_loop || kind == FlowKind::repeat_loop ||
                      kind == FlowKind::endless_loop;
    return loop ? static_cast<FlowKind>(static_cast<int>(kind) + 1) : FlowKind::end_if;
  }

  void link(Statement& s, std::vector<Statement*>& open) {
    switch (s.flow) {
      case FlowKind::if_block:
      case FlowKind::for_loop:
      case FlowKind::while_loop:
      case FlowKind::repeat_loop:
      case FlowKind::endless_loop:
        open.push_back(&s);
        return;
      case FlowKind::else_branch:
      case FlowKind::end_if:
      case FlowKind::end_for:
      case FlowKind::end_while:
      case FlowKind::until:
      case FlowKind::end_loop:
        break;
      default:
        return;
    }
    const FlowKind wanted = s.flow == FlowKind::else_branch ? FlowKind::end_if : s.flow;
    if (open.empty() || end_of(open.back()->flow) != wanted ||
        (s.flow == FlowKind::else_branch && open.back()->flow == FlowKind::else_branch)) {
      report_.error(s.flow_offset, "statement",
                    open.empty() ? fmt::format("{} without its beginning", text_of(s.flow))
                                 : fmt::format("{} inside {}; {} was expected before", text_of(s.flow),
                                               text_of(open.back()->flow), text_of(end_of(open.back()->flow))));
      return;
    }
    open.back()->partner = s.block;
    s.partner = open.back()->block;
    open.pop_back();
    if (s.flow == FlowKind::else_branch) open.push_back(&s);
  }

  void close(std::vector<Statement*>& open) {
    for (const Statement* s : open)
      report_.error(s->flow_offset, "statement",
                    fmt::format("{} has no end; {} was expected", text_of(s->flow), text_of(end_of(s->flow))));
    open.clear();
  }

  Program& program_;
  Tree& tree_;
  NameTable names_;
  Reporter& report_;
  std::string_view text_;
  bool bom_ = false;
};

}  // namespace

const Statement* Tree::statement(std::uint32_t block) const {
  const auto at = std::ranges::lower_bound(statements, block, {}, &Statement::block);
  return at != statements.end() && at->block == block ? &*at : nullptr;
}

std::vector<std::uint32_t> Tree::blocks_of(const std::string& label) const {
  std::vector<std::uint32_t> out;
  if (label.size() > 1 && label[0] == 'N' && is_digit(label[1])) {
    std::uint64_t number = 0;
    const auto end = std::from_chars(label.data() + 1, label.data() + label.size(), number);
    if (end.ec == std::errc() && end.ptr == label.data() + label.size())
      for (auto at = std::ranges::lower_bound(numbers, std::pair(number, 0U));
           at != numbers.end() && at->first == number; ++at)
        out.push_back(at->second);
  }
  if (const auto found = labels.find(label); found != labels.end())
    out.insert(out.end(), found->second.begin(), found->second.end());
  return out;
}

Program read(SourceText source, Diagnostics& diagnostics) {
  Program program;
  program.language = LanguageId::siemens;
  program.source = std::move(source);
  auto tree = std::make_shared<Tree>();
  Reporter report(program.source, diagnostics);
  Reader(program, *tree, report).run();
  report.finish();
  program.tree = std::move(tree);
  return program;
}

}  // namespace camber::nc::siemens
