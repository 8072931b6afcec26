// How ISO G code writes edited words.
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "nc/emit/block_writer.h"
#include "nc/emit/text_rules.h"
#include "nc/iso_language.h"

namespace camber::nc {
namespace {

constexpr std::string_view kOrder = "XYZIJKR";  ///< order of words, where added ones go

bool has_code(std::span<const Word> words, char letter, std::initializer_list<double> codes) {
  return std::any_of(words.begin(), words.end(), [&](const Word& w) {
    return w.letter == letter && std::find(codes.begin(), codes.end(), w.value) != codes.end();
  });
}

class IsoTextRules : public LetterArcs {
 public:
  using LetterArcs::LetterArcs;

  bool goes_to_machine_place(std::uint32_t block) const override {
    return has_code(program_.words_of(block), 'G', {28, 29, 30, 53});
  }

  bool calls(std::uint32_t block) const override { return has_code(program_.words_of(block), 'M', {96, 97, 98, 99}); }

  std::vector<Word> words_at_end(std::uint32_t block) const override {
    std::vector<Word> out;
    for (const Word& w : program_.words_of(block))
      if (has_code({&w, 1}, 'M', {0, 1, 2, 5, 9, 30, 60}) || has_code({&w, 1}, 'G', {9})) out.push_back(w);
    return out;
  }

  /// The program reads its modal feed (#4109, #<_feed>), or a macro runs behind every move (G66), which relies on it:
  /// no F word stands early enough to bring it back.
  bool reads_feed() const override {
    constexpr double kModalFeed = 4109;
    const Expressions& expressions = program_.macro.expressions;
    if (std::find(expressions.names.begin(), expressions.names.end(), "_feed") != expressions.names.end()) return true;
    if (std::any_of(expressions.ops.begin(), expressions.ops.end(),
                    [](const ExpressionOp& op) { return op.op == Op::number && op.operand == kModalFeed; }))
      return true;
    return program_.macro.calls && has_code(program_.words, 'G', {66, 66.1});
  }

  bool incremental(const ModalState& state, const Word*) const override { return state.incremental; }

  /// Upper or lower case, as the block's first word.
  std::string new_word(std::uint32_t block, char letter, const std::string& number) const override {
    const auto words = program_.words_of(block);
    const bool lower = !words.empty() && program_.source.text()[words.front().offset] >= 'a';
    return (lower ? static_cast<char>(letter - 'A' + 'a') : letter) + number;
  }

  Place place_of(std::uint32_t block, char letter) const override {
    return letter == 'F' ? place_of_feed(block) : place_of_coordinate(block, letter);
  }

  std::string further_block(std::uint32_t block, bool blanks, std::span<const std::string> wanted,
                            std::span<const Word> own) const override {
    std::vector<std::string> words(wanted.begin(), wanted.end());
    auto behind_codes = words.begin();
    for (const Word& w : own)
      if (w.letter == 'G') {
        behind_codes = words.insert(behind_codes, program_.source.text().substr(w.offset, w.length));
        ++behind_codes;
      }
    for (const Word& w : own)
      if (w.letter != 'G') words.push_back(program_.source.text().substr(w.offset, w.length));
    const std::uint8_t skip = program_.blocks[block].skip;
    std::string out = skip == 0 ? "" : skip == 1 ? "/" : "/" + std::to_string(skip);
    for (std::size_t i = 0; i < words.size(); ++i) out += (i > 0 && blanks ? " " : "") + words[i];
    return out;
  }

  std::string comment(std::string_view text) const override { return "(" + std::string(text) + ")"; }

  std::size_t header_block() const override {
    std::size_t block = program_.leader_blocks;
    const auto& text = program_.source.text();
    while (block < program_.blocks.size()) {
      const Block& b = program_.blocks[block];
      const bool tape = b.length > 0 && text[b.offset] == '%';
      const auto words = program_.words_of(block);
      const bool name = words.empty() && b.length > 0 && (text[b.offset] == 'O' || text[b.offset] == 'o');
      if (!tape && !name && (words.empty() || words.front().letter != 'O')) break;
      ++block;
    }
    return block;
  }

  bool absolute_centre(const ModalState& state, std::uint32_t) const override { return state.absolute_arc_centre; }

  bool numbers_are_targets() const override { return program_.macro.flow(); }

 private:
  /// Behind the nearest coordinate that comes before it in the usual order; otherwise before the next one; otherwise
  /// behind the last N or G.
  Place place_of_coordinate(std::uint32_t block, char letter) const {
    const auto rank = [](char c) { return static_cast<int>(kOrder.find(c)); };
    const auto words = program_.words_of(block);
    const Word *before = nullptr, *after = nullptr, *code = nullptr;
    for (const Word& w : words) {
      if (w.letter == 'N' || w.letter == 'G') code = &w;
      if (kOrder.find(w.letter) == std::string_view::npos) continue;
      if (rank(w.letter) < rank(letter) && (!before || rank(w.letter) >= rank(before->letter))) before = &w;
      if (rank(w.letter) > rank(letter) && (!after || rank(w.letter) < rank(after->letter))) after = &w;
    }
    if (!before && !after) before = code;
    if (before) return {before->offset + std::size_t{before->length}, true};
    return {after ? after->offset : words.front().offset, false};
  }

  /// Behind the last coordinate of the text; otherwise behind the last N or G.
  Place place_of_feed(std::uint32_t block) const {
    const auto words = program_.words_of(block);
    const Word *coordinate = nullptr, *code = nullptr;
    for (const Word& w : words) {
      if (kOrder.find(w.letter) != std::string_view::npos) coordinate = &w;
      if (w.letter == 'N' || w.letter == 'G') code = &w;
    }
    if (const Word* before = coordinate ? coordinate : code)
      return {before->offset + std::size_t{before->length}, true};
    return {words.front().offset, false};
  }
};

}  // namespace

std::unique_ptr<TextRules> iso_text_rules(const Program& program) { return std::make_unique<IsoTextRules>(program); }

}  // namespace camber::nc
