// How Klartext writes edited words: L X+5 Y-3.2, C with its CC in a block before it, CR with R, numbers counted on.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "nc/emit/block_writer.h"
#include "nc/emit/text_rules.h"
#include "nc/heidenhain/cursor.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/heidenhain/klartext_tree.h"

namespace camber::nc::heidenhain {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
constexpr std::string_view kAxes = "XYZ";

bool is_axis(char c) { return kAxes.find(c) != std::string_view::npos; }

class KlartextRules : public TextRules {
 public:
  explicit KlartextRules(const Program& program) : TextRules(program), tree_(tree_of(program)) {
    statement_of_.assign(program.blocks.size(), kNone);
    for (std::uint32_t i = 0; i < tree_.statements.size(); ++i) statement_of_[tree_.statements[i].block] = i;
    find_style();
    find_centres();
  }

  bool goes_to_machine_place(std::uint32_t block) const override { return has_m(block, {91, 92, 140}); }
  bool calls(std::uint32_t block) const override { return has_m(block, {99, 89}); }
  std::vector<Word> words_at_end(std::uint32_t block) const override {
    std::vector<Word> out;
    for (const Word& w : program_.words_of(block))
      if (is_m(w, {0, 1, 2, 5, 6, 9, 30})) out.push_back(w);
    return out;
  }

  /// Returns the S word of a TOOL CALL, or of a block such as S1000.
  std::optional<Word> speed_word(std::uint32_t block, double rpm) const override {
    if (kind_of(block) != Kind::tool_call) return TextRules::speed_word(block, rpm);
    const Statement& s = tree_.statements[statement_of_[block]];
    const std::string& text = program_.source.text();
    bool quoted = false;
    for (std::size_t at = s.at; at < s.end && (quoted || text[at] != ';'); ++at) {
      if (text[at] == '"') quoted = !quoted;
      if (quoted || upper(text[at]) != 'S' || is_letter(text[at - 1])) continue;
      Cursor number(text, at + 1, s.end);
      number.more();
      const std::size_t from = number.offset();
      const auto value = number.number();
      if (!value || *value != rpm) continue;
      return Word{'S', static_cast<std::uint8_t>(from - at), static_cast<std::uint16_t>(number.offset() - at),
                  static_cast<std::uint32_t>(at), *value};
    }
    return std::nullopt;
  }
  std::string speed_line(const std::string&, const std::string& number) const override {
    return "TOOL CALL S" + number;
  }

  bool incremental(const ModalState&, const Word* word) const override {
    return word && is_incremental(program_, *word);
  }

  void adapt(NumberStyle& style) const override {
    style.plus = plus_;
    style.comma = comma_;
    if (!trailing_point_ && style.whole == WholeStyle::point) style.whole = WholeStyle::plain;
  }

  std::string new_word(std::uint32_t, char letter, const std::string& number) const override { return letter + number; }

  /// X Y Z behind their neighbours, F behind the coordinates, R and DR.
  Place place_of(std::uint32_t block, char letter) const override {
    const Word *before = nullptr, *after = nullptr;
    const Statement& s = tree_.statements[statement_of_[block]];
    for (const Word& w : program_.words_of(block)) {
      if (letter == 'F') {
        const bool behind = is_axis(w.letter) || (w.letter >= 'A' && w.letter <= 'C') || w.letter == 'R' ||
                            w.letter == letter::kCompensation || w.letter == letter::kSense ||
                            w.letter == letter::kPolarAngle || w.letter == letter::kPolarRadius || is_vector(w.letter);
        if (behind) before = &w;
        continue;
      }
      if (!is_axis(w.letter)) continue;
      if (w.letter < letter && (!before || w.letter >= before->letter)) before = &w;
      if (w.letter > letter && (!after || w.letter < after->letter)) after = &w;
    }
    if (before) return {before->offset + std::size_t{before->length}, true};
    if (after) return {after->offset, false};
    return {s.at, true};
  }

  std::string further_block(std::uint32_t block, bool blanks, std::span<const std::string> words,
                            std::span<const Word> own) const override {
    return further("L", block, blanks, words, own);
  }

  /// New lines among these get the number of the line before them, and one; those of the program keep theirs.
  std::string numbered(std::string lines) const override {
    if (!numbers_) return lines;
    std::vector<std::string> all;
    std::string end;
    for (std::size_t from = 0;;) {
      const std::size_t next = lines.find(program_.source.line_end(), from);
      if (next == std::string::npos) {
        all.push_back(lines.substr(from));
        break;
      }
      std::size_t last = next;
      while (last > from && lines[last - 1] == '\r') --last;
      end = lines.substr(last, next + 1 - last);
      all.push_back(lines.substr(from, last - from));
      from = next + 1;
    }
    std::size_t own = 0;
    while (own < all.size() && !number_of(all[own])) ++own;
    const long first = own < all.size() ? *number_of(all[own]) : 0;
    long number = first;
    std::string out;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (const auto has = number_of(all[i]))
        number = *has;
      else if (!all[i].empty() && i < own)
        all[i] = with_number(all[i], first);
      else if (!all[i].empty())
        all[i] = with_number(all[i], ++number);
      out += (i > 0 ? end : std::string()) + all[i];
    }
    return out;
  }

  std::string comment(std::string_view text) const override { return "; " + std::string(text); }

  std::size_t header_block() const override {
    if (tree_.statements.empty()) return 0;
    const Statement& s = tree_.statements[tree_.begin_statement];
    return s.kind == Kind::begin_program ? s.block + std::size_t{1} : 0;
  }

  bool by_radius(std::uint32_t block) const override { return kind_of(block) == Kind::radius_arc; }
  bool absolute_centre(const ModalState&, std::uint32_t) const override { return true; }

  void set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
               int decimals) override {
    if (wanted.by_radius) return writer.set('R', arc.r_mm / unit_mm, decimals);
    writer.put_before(centre_line(writer.block(), writer, wanted, arc, unit_mm, decimals));
    moved_ = centre_of_[writer.block()];
  }

  std::string further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                          const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) override {
    const std::uint32_t block = writer.block();
    std::vector<std::string> texts, feeds;
    for (const NewWord& w : words) {
      const NumberStyle& style = w.style ? *w.style : writer.style();
      (w.letter == 'F' ? feeds : texts).push_back(new_word(block, w.letter, format_number(w.value, w.decimals, style)));
    }
    std::string line;
    if (wanted.by_radius)
      texts.push_back(new_word(block, 'R', format_number(arc.r_mm / unit_mm, decimals, writer.style())));
    else
      line = centre_line(block, writer, wanted, arc, unit_mm, decimals) + line_end();
    texts.push_back(wanted.sweep_rad < 0 ? "DR-" : "DR+");
    texts.insert(texts.end(), feeds.begin(), feeds.end());
    return line + further(wanted.by_radius ? "CR" : "C", block, writer.uses_blanks(), texts, own);
  }

  /// The block relies on a pole that an edit before it has moved.
  std::string lines_before(std::uint32_t block) override {
    if (moved_ == kNone) return {};
    const auto found = centre_of_.find(block);
    if (found == centre_of_.end() || found->second != moved_) {
      if (kind_of(block) == Kind::centre) moved_ = kNone;
      return {};
    }
    const Statement& s = tree_.statements[statement_of_[moved_]];
    moved_ = kNone;
    return centre_text(s);
  }

  bool motion_is_modal() const override { return false; }
  /// Jumps go to labels.
  bool numbers_are_targets() const override { return false; }

  /// L with absolute places, F and R0 may be written anew. Blanks alone stand between the words.
  Beside beside(std::uint32_t block) const override {
    const std::uint32_t index = statement_of_[block];
    if (index == kNone) return Beside::several;
    const Statement& s = tree_.statements[index];
    if (s.skip != 0) return Beside::skip;
    if (s.lines > 1) return Beside::several;
    if (s.kind != Kind::line) return Beside::word;
    const std::string& text = program_.source.text();
    const auto blank = [&](std::size_t from, std::size_t to) { return text.find_first_not_of(" \t\r", from) >= to; };
    std::size_t at = s.at;
    for (const Word& w : tree_.words_of(program_, s)) {
      if (!blank(at, w.offset)) return Beside::comment;
      at = w.offset + w.length;
      if (std::isnan(w.value)) return Beside::expression;
      const bool place = is_axis(w.letter) && !is_incremental(program_, w);
      if (!place && w.letter != 'F' && !(w.letter == letter::kCompensation && w.value == 0)) return Beside::word;
    }
    return blank(at, program_.blocks[block].offset + program_.blocks[block].length) ? Beside::nothing : Beside::comment;
  }

  /// The CC before the run, unless a new one comes before what may rely on it.
  std::vector<std::string> lines_behind(std::uint32_t first, std::uint32_t last) const override {
    const auto behind = [](std::uint32_t block, const Statement* s) { return block < s->block; };
    const auto next = std::upper_bound(pole_statements_.begin(), pole_statements_.end(), last, behind);
    if (next == pole_statements_.end() || (*next)->kind == Kind::centre) return {};
    for (auto at = next; at != pole_statements_.begin();)
      if (const Statement& s = **--at; s.kind == Kind::centre && s.block < first) return {centre_text(s)};
    return {};
  }

  std::string new_line(std::string line) const override { return numbers_ ? with_number(line, 0) : line; }

  /// Numbers the lines anew, each that has a number by one more than the last; lines that continue others have none.
  std::string renumbered(std::string text) const override {
    if (!numbers_) return text;
    std::string out;
    std::optional<long> number;
    for (std::size_t at = 0; at < text.size();) {
      std::size_t end = text.find(program_.source.line_end(), at);
      end = end == std::string::npos ? text.size() : end + 1;
      const std::string line = text.substr(at, end - at);
      at = end;
      if (const auto has = number_of(line)) {
        number = number ? *number + 1 : *has;
        out += with_other_number(line, *number);
      } else {
        out += line;
      }
    }
    return out;
  }

 private:
  bool is_m(const Word& w, std::initializer_list<double> codes) const {
    return w.letter == 'M' && std::find(codes.begin(), codes.end(), w.value) != codes.end();
  }
  bool has_m(std::uint32_t block, std::initializer_list<double> codes) const {
    return std::ranges::any_of(program_.words_of(block), [&](const Word& w) { return is_m(w, codes); });
  }
  static bool is_vector(char c) {
    for (int i = 0; i < 3; ++i)
      if (c == letter::kNormal[i] || c == letter::kTool[i]) return true;
    return false;
  }
  Kind kind_of(std::uint32_t block) const {
    const std::uint32_t statement = statement_of_[block];
    return statement == kNone ? Kind::nothing : tree_.statements[statement].kind;
  }
  std::string line_end() const {
    const std::string& text = program_.source.text();
    if (program_.source.line_end() == '\r') return "\r";
    const std::size_t first = text.find('\n');
    return first != std::string::npos && first > 0 && text[first - 1] == '\r' ? "\r\n" : "\n";
  }

  /// Signs and decimal points of the first coordinates.
  void find_style() {
    std::size_t plus = 0, none = 0, comma = 0, point = 0, numbered = 0, bare = 0, seen = 0;
    const std::string& text = program_.source.text();
    for (const Word& w : program_.words) {
      if (!is_axis(w.letter) || std::isnan(w.value)) continue;
      const char first = text[w.offset + w.value_at];
      if (first != '-') ++(first == '+' ? plus : none);
      const std::string_view number = std::string_view(text).substr(w.offset, w.length);
      trailing_point_ |= number.back() == '.' || number.back() == ',';
      comma += number.find(',') != std::string_view::npos;
      point += number.find('.') != std::string_view::npos;
      if (++seen > 20000) break;
    }
    for (const Statement& s : tree_.statements) {
      if (!has_words(s.kind)) continue;
      ++(s.numbered ? numbered : bare);
      if (s.numbered && number_prefix_.empty()) {
        const std::size_t begin = program_.blocks[s.block].offset;
        number_prefix_ = text[begin] == 'N' || text[begin] == 'n' ? std::string(1, text[begin]) : "";
      }
    }
    plus_ = plus > none;
    comma_ = comma > point;
    numbers_ = numbered > bare;
  }

  static bool may_rely_on_pole(Kind kind) {
    switch (kind) {
      case Kind::circle:
      case Kind::polar_circle:
      case Kind::polar_line:
      case Kind::polar_tangent_arc:
      case Kind::call_label:
      case Kind::call_program:
      case Kind::label:
      case Kind::approach:
      case Kind::departure:
        return true;
      default:
        return false;
    }
  }

  /// The CC that each circle relies on, by the order of the text; kNone where a call or a label stands between.
  void find_centres() {
    std::uint32_t centre = kNone;
    for (const Statement& s : tree_.statements) {
      if (s.kind == Kind::centre || may_rely_on_pole(s.kind)) pole_statements_.push_back(&s);
      if (s.kind == Kind::centre)
        centre = s.lines == 1 ? s.block : kNone;
      else if (s.kind == Kind::call_label || s.kind == Kind::call_program || s.kind == Kind::label)
        centre = kNone;
      else if (s.kind == Kind::circle || s.kind == Kind::polar_circle || s.kind == Kind::polar_line ||
               s.kind == Kind::polar_tangent_arc)
        centre_of_[s.block] = centre;
    }
  }

  std::string centre_line(std::uint32_t block, const BlockWriter& writer, const WantedArc& wanted,
                          const RoundedArc& arc, double unit_mm, int decimals) const {
    const PlaneAxes axes = axes_of(wanted.plane);
    std::array<std::pair<int, double>, 2> words{std::pair(axes.first, arc.first_mm),
                                                std::pair(axes.second, arc.second_mm)};
    std::ranges::sort(words);
    std::string out = "CC";
    for (const auto& [axis, value] : words)
      out += " " + new_word(block, kAxes[static_cast<std::size_t>(axis)],
                            format_number(value / unit_mm, decimals, writer.style()));
    return out;
  }

  std::string further(std::string_view keyword, std::uint32_t block, bool, std::span<const std::string> words,
                      std::span<const Word> own) const {
    std::string out = program_.blocks[block].skip != 0 ? "/" : "";
    out += keyword;
    for (const std::string& w : words) out += " " + w;
    for (const Word& w : own) out += " " + program_.source.text().substr(w.offset, w.length);
    return out;
  }

  std::string centre_text(const Statement& s) const {
    const std::string text = program_.source.text().substr(s.begin, s.end - s.begin);
    return text.substr(0, text.find_first_of("\r\n;"));
  }

  /// The block number of a line.
  std::optional<long> number_of(const std::string& line) const {
    std::size_t at = line.find_first_not_of(" \t/");
    if (at == std::string::npos) return std::nullopt;
    if (upper(line[at]) == 'N' && !number_prefix_.empty()) ++at;
    if (at >= line.size() || !is_digit(line[at])) return std::nullopt;
    long value = 0;
    while (at < line.size() && is_digit(line[at]) && value < 100'000'000) value = 10 * value + (line[at++] - '0');
    return value;
  }

  std::string with_other_number(const std::string& line, long number) const {
    const std::size_t from = line.find_first_of("0123456789");
    std::size_t to = from;
    while (to < line.size() && is_digit(line[to])) ++to;
    return line.substr(0, from) + std::to_string(number) + line.substr(to);
  }

  std::string with_number(const std::string& line, long number) const {
    const bool skip = !line.empty() && line.front() == '/';
    return (skip ? "/" : "") + number_prefix_ + fmt::format("{} ", number) + (skip ? line.substr(1) : line);
  }

  const Tree& tree_;
  std::vector<std::uint32_t> statement_of_;           ///< by block; kNone: a line that continues another
  std::map<std::uint32_t, std::uint32_t> centre_of_;  ///< by block: the block of its CC
  std::vector<const Statement*> pole_statements_;     ///< CC and what may rely on one, in the order of the text
  std::uint32_t moved_ = kNone;                       ///< a CC that the emitted text has replaced by another since
  bool plus_ = true, comma_ = false, numbers_ = true;
  bool trailing_point_ = false;  ///< X-7.
  std::string number_prefix_;
};

}  // namespace

std::unique_ptr<TextRules> text_rules(const Program& program) { return std::make_unique<KlartextRules>(program); }

}  // namespace camber::nc::heidenhain
