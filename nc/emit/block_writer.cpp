#include "nc/emit/block_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace camber::nc {
namespace {

constexpr std::string_view kOrder = "XYZIJKR";  ///< order of words that are added at one place

std::string_view number_text(const Program& program, const Word& word) {
  return std::string_view(program.source.text())
      .substr(word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at));
}

}  // namespace

BlockWriter::BlockWriter(const Program& program, std::uint32_t block, const NumberStyle& style, const TextRules& rules)
    : program_(program),
      index_(block),
      block_(program.blocks[block]),
      words_(program.words_of(block)),
      style_(style),
      rules_(rules),
      blanks_(block_uses_blanks()) {}

bool BlockWriter::block_uses_blanks() const {
  if (words_.size() < 2) return style_.blanks;
  for (std::size_t i = 1; i < words_.size(); ++i)
    if (program_.source.text()[words_[i].offset - 1] == ' ') return true;
  return false;
}

const Word* BlockWriter::find(char letter) const {
  const Word* found = nullptr;
  for (const Word& w : words_)
    if (w.letter == letter) found = &w;
  return found;
}

double BlockWriter::value(char letter) const {
  for (const Change& c : changes_)
    if (c.letter == letter) return c.value;
  const Word* word = find(letter);
  return word ? word->value : 0;
}

int BlockWriter::decimals(char letter, int least) const {
  const Word* word = find(letter);
  return std::max(least, word ? decimals_of(number_text(program_, *word)) : 0);
}

std::string BlockWriter::text_of(const NewWord& word, std::string_view like) const {
  return format_number(word.value, word.decimals, word.style ? *word.style : style_, like);
}

void BlockWriter::set(const NewWord& wanted) {
  const Word* word = find(wanted.letter);
  if (!word) {
    add(wanted);
    return;
  }
  const double r = rounded(wanted.value, wanted.decimals);
  if (r == word->value) return;
  const auto old = number_text(program_, *word);
  changes_.push_back({word->offset + word->value_at, old.size(), text_of(wanted, old), wanted.letter, r});
}

void BlockWriter::add(const NewWord& wanted) {
  const double r = rounded(wanted.value, wanted.decimals);
  const std::string word = rules_.new_word(index_, wanted.letter, text_of(wanted)), gap = blanks_ ? " " : "";
  const TextRules::Place place = rules_.place_of(index_, wanted.letter);
  changes_.push_back({place.offset, 0, place.behind ? gap + word : word + gap, wanted.letter, r});
}

void BlockWriter::replace(std::size_t offset, std::size_t length, std::string text) {
  changes_.push_back({offset, length, std::move(text), 0, 0});
}

void BlockWriter::take_out(const Word& word) {
  const std::string& text = program_.source.text();
  std::size_t begin = word.offset, end = begin + word.length;
  if (begin > block_.offset && text[begin - 1] == ' ')
    --begin;
  else if (begin == block_.offset && end < block_.offset + block_.length && text[end] == ' ')
    ++end;
  changes_.push_back({begin, end - begin, {}, word.letter, word.value});
}

std::string BlockWriter::text(std::string_view line_end) const {
  std::vector<Change> changes = changes_;
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.at != b.at ? a.at < b.at : kOrder.find(a.letter) < kOrder.find(b.letter);
  });
  std::string out = line_before_;
  if (!out.empty()) out += line_end;
  std::size_t from = block_.offset;
  for (const Change& c : changes) {
    out.append(program_.source.text(), from, c.at - from);
    out += c.text;
    from = c.at + c.length;
  }
  out.append(program_.source.text(), from, block_.offset + block_.length - from);
  return out;
}

std::string BlockWriter::further_block(std::span<const NewWord> wanted, std::span<const Word> own) const {
  std::vector<std::string> words;
  for (const NewWord& w : wanted) {
    const Word* same = w.letter == 'F' ? find('F') : nullptr;
    if (same && same->value == w.value)
      words.push_back(program_.source.text().substr(same->offset, same->length));
    else
      words.push_back(rules_.new_word(index_, w.letter, text_of(w)));
  }
  return rules_.further_block(index_, blanks_, words, own);
}

}  // namespace camber::nc
