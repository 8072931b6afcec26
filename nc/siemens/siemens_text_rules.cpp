// How Sinumerik programs write edited words.
#include <algorithm>

#include "nc/emit/block_writer.h"
#include "nc/emit/text_rules.h"
#include "nc/siemens/line_parser.h"
#include "nc/siemens/siemens_language.h"

namespace camber::nc::siemens {
namespace {

constexpr std::string_view kOrder = "XYZIJKR";

class SiemensTextRules : public LetterArcs {
 public:
  using LetterArcs::LetterArcs;

  bool goes_to_machine_place(std::uint32_t block) const override {
    for (const Word& w : program_.words_of(block))
      if (w.letter == 'G' && (w.value == 53 || w.value == 153 || w.value == 74 || w.value == 75)) return true;
    const Statement* s = statement(block);
    return s && std::ranges::any_of(s->items, [](const Item& i) { return i.row && i.row->does == Does::supa; });
  }

  bool calls(std::uint32_t block) const override {
    const Statement* s = statement(block);
    if (!s) return false;
    return s->flow != FlowKind::none || std::ranges::any_of(s->items, [](const Item& i) {
             return i.kind == ItemKind::call ||
                    (i.row && (i.row->does == Does::modal_call || i.row->does == Does::end_subprogram));
           });
  }

  std::vector<Word> words_at_end(std::uint32_t block) const override {
    std::vector<Word> out;
    for (const Word& w : program_.words_of(block)) {
      const bool m =
          w.letter == 'M' && (w.value <= 2 || w.value == 5 || w.value == 9 || w.value == 17 || w.value == 30);
      if (m || (w.letter == 'G' && w.value == 9)) out.push_back(w);
    }
    return out;
  }

  bool reads_feed() const override {
    const auto& names = tree_of(program_).names;
    return std::ranges::find(names, "$P_F") != names.end();
  }

  /// S6000, S=6000, S1=6000.
  std::optional<Word> speed_word(std::uint32_t block, double rpm) const override {
    if (const auto plain = LetterArcs::speed_word(block, rpm)) return plain;
    const Statement* s = statement(block);
    if (!s) return std::nullopt;
    for (const Item& i : s->items) {
      if (i.kind != ItemKind::word || !i.constant || i.number != rpm || tree_of(program_).names[i.name] != "S")
        continue;
      const Node& node = tree_of(program_).nodes[i.value];
      return Word{'S', static_cast<std::uint8_t>(node.offset - i.offset),
                  static_cast<std::uint16_t>(node.offset + node.length - i.offset), i.offset, i.number};
    }
    return std::nullopt;
  }

  bool incremental(const ModalState& state, const Word* word) const override {
    if (word) {
      const std::string form = form_of(*word);
      if (form.find("IC") != std::string::npos) return true;
      if (form.find("AC") != std::string::npos) return false;
    }
    return state.incremental;
  }

  std::string new_word(std::uint32_t block, char letter, const std::string& number) const override {
    const auto words = program_.words_of(block);
    const bool lower = !words.empty() && program_.source.text()[words.front().offset] >= 'a';
    if (letter == 'R') return (lower ? "cr=" : "CR=") + number;
    const std::string name(1, lower ? static_cast<char>(letter - 'A' + 'a') : letter);
    if (std::string_view(kCentre).find(letter) != std::string_view::npos && centre_is_absolute(block))
      return name + (lower ? "=ac(" : "=AC(") + number + ")";
    return name + number;
  }

  Place place_of(std::uint32_t block, char letter) const override {
    const auto words = program_.words_of(block);
    const auto rank = [](char c) { return static_cast<int>(kOrder.find(c)); };
    const Word *before = nullptr, *after = nullptr, *code = nullptr, *coordinate = nullptr;
    for (const Word& w : words) {
      if (w.letter == 'N' || w.letter == 'G') code = &w;
      if (kOrder.find(w.letter) == std::string_view::npos) continue;
      coordinate = &w;
      if (letter == 'F') continue;
      if (rank(w.letter) < rank(letter) && (!before || rank(w.letter) >= rank(before->letter))) before = &w;
      if (rank(w.letter) > rank(letter) && (!after || rank(w.letter) < rank(after->letter))) after = &w;
    }
    if (letter == 'F') before = coordinate;
    if (!before && !after) before = code;
    if (before) return {end_of(block, *before), true};
    if (after || !words.empty()) return {after ? after->offset : words.front().offset, false};
    return {program_.blocks[block].offset, false};
  }

  std::string further_block(std::uint32_t block, bool blanks, std::span<const std::string> wanted,
                            std::span<const Word> own) const override {
    std::vector<std::string> words;
    for (const Word& w : own)
      if (w.letter == 'G') words.push_back(program_.source.text().substr(w.offset, w.length));
    words.insert(words.end(), wanted.begin(), wanted.end());
    for (const Word& w : own)
      if (w.letter != 'G') words.push_back(program_.source.text().substr(w.offset, w.length));
    const std::uint8_t skip = program_.blocks[block].skip;
    std::string out = skip == 0 ? "" : skip == 1 ? "/" : "/" + std::to_string(skip - 1);
    for (std::size_t i = 0; i < words.size(); ++i) out += (i > 0 && blanks ? " " : "") + words[i];
    return out;
  }

  std::string comment(std::string_view text) const override { return "; " + std::string(text); }

  /// Behind %_N_NAME_MPF and ;$PATH=.
  std::size_t header_block() const override {
    const auto& text = program_.source.text();
    std::size_t block = 0;
    for (; block < program_.blocks.size(); ++block) {
      const std::string_view line =
          std::string_view(text).substr(program_.blocks[block].offset, program_.blocks[block].length);
      if (!line.starts_with('%') && !line.starts_with(";$PATH")) break;
    }
    return block;
  }

  bool absolute_centre(const ModalState&, std::uint32_t block) const override { return centre_is_absolute(block); }

  bool numbers_are_targets() const override {
    return std::ranges::any_of(tree_of(program_).statements, [](const Statement& s) {
      return s.flow == FlowKind::jump || s.flow == FlowKind::select || s.flow == FlowKind::repeat_part;
    });
  }

 private:
  const Statement* statement(std::uint32_t block) const { return tree_of(program_).statement(block); }

  /// Returns the text between the address and the number, in upper case: "", "=", "=IC(".
  std::string form_of(const Word& word) const {
    std::string out;
    for (std::size_t i = 1; i < word.value_at; ++i) out += upper(program_.source.text()[word.offset + i]);
    return out;
  }

  bool centre_is_absolute(std::uint32_t block) const {
    return std::ranges::any_of(program_.words_of(block), [&](const Word& w) {
      return std::string_view(kCentre).find(w.letter) != std::string_view::npos &&
             form_of(w).find("AC") != std::string::npos;
    });
  }

  /// Behind the word and its bracket.
  std::size_t end_of(std::uint32_t block, const Word& word) const {
    if (const Statement* s = statement(block))
      for (const Item& item : s->items)
        if (item.offset == word.offset) return std::size_t{item.offset} + item.length;
    return word.offset + std::size_t{word.length};
  }
};

}  // namespace

std::unique_ptr<TextRules> text_rules(const Program& program) { return std::make_unique<SiemensTextRules>(program); }

}  // namespace camber::nc::siemens
