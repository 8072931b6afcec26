#include "nc/emit/block_writer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace camber::nc {
namespace {

constexpr std::string_view kOrder = "XYZIJKR";  ///< where added words go

std::string_view number_text(const Program& program, const Word& word) {
  return std::string_view(program.source.text())
      .substr(word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at));
}

}  // namespace

BlockWriter::BlockWriter(const Program& program, std::size_t block, const NumberStyle& style)
    : program_(program),
      block_(program.blocks[block]),
      words_(program.words_of(block)),
      style_(style),
      blanks_(block_uses_blanks()) {}

/// Upper or lower case, as the block's first word.
char BlockWriter::in_case(char letter) const {
  const bool lower = !words_.empty() && program_.source.text()[words_.front().offset] >= 'a';
  return lower ? static_cast<char>(letter - 'A' + 'a') : letter;
}

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

/// Behind the nearest coordinate that comes before it in the usual order; otherwise before the next one; otherwise
/// behind the last N or G.
void BlockWriter::add(const NewWord& wanted) {
  const char letter = wanted.letter;
  const double r = rounded(wanted.value, wanted.decimals);
  std::string word = in_case(letter) + text_of(wanted);
  if (letter == 'F') return add_feed(std::move(word), r);
  const auto rank = [](char c) { return static_cast<int>(kOrder.find(c)); };
  const Word *before = nullptr, *after = nullptr, *code = nullptr;
  for (const Word& w : words_) {
    if (w.letter == 'N' || w.letter == 'G') code = &w;
    if (kOrder.find(w.letter) == std::string_view::npos) continue;
    if (rank(w.letter) < rank(letter) && (!before || rank(w.letter) >= rank(before->letter))) before = &w;
    if (rank(w.letter) > rank(letter) && (!after || rank(w.letter) < rank(after->letter))) after = &w;
  }
  if (!before && !after) before = code;
  const std::string gap = blanks_ ? " " : "";
  if (before)
    changes_.push_back({before->offset + std::size_t{before->length}, 0, gap + word, letter, r});
  else
    changes_.push_back({after ? after->offset : words_.front().offset, 0, word + gap, letter, r});
}

/// Behind the last coordinate of the text; otherwise behind the last N or G.
void BlockWriter::add_feed(std::string word, double value) {
  const Word *coordinate = nullptr, *code = nullptr;
  for (const Word& w : words_) {
    if (kOrder.find(w.letter) != std::string_view::npos) coordinate = &w;
    if (w.letter == 'N' || w.letter == 'G') code = &w;
  }
  const std::string gap = blanks_ ? " " : "";
  if (const Word* before = coordinate ? coordinate : code)
    changes_.push_back({before->offset + std::size_t{before->length}, 0, gap + word, 'F', value});
  else
    changes_.push_back({words_.front().offset, 0, word + gap, 'F', value});
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

std::string BlockWriter::text() const {
  std::vector<Change> changes = changes_;
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) {
    return a.at != b.at ? a.at < b.at : kOrder.find(a.letter) < kOrder.find(b.letter);
  });
  std::string out;
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
      words.push_back(in_case(w.letter) + text_of(w));
  }
  auto behind_codes = words.begin();
  for (const Word& w : own)
    if (w.letter == 'G') {
      behind_codes = words.insert(behind_codes, program_.source.text().substr(w.offset, w.length));
      ++behind_codes;
    }
  for (const Word& w : own)
    if (w.letter != 'G') words.push_back(program_.source.text().substr(w.offset, w.length));
  std::string out = block_.skip == 0 ? "" : block_.skip == 1 ? "/" : "/" + std::to_string(block_.skip);
  for (std::size_t i = 0; i < words.size(); ++i) out += (i > 0 && blanks_ ? " " : "") + words[i];
  return out;
}

}  // namespace camber::nc
