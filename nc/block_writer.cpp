#include "nc/block_writer.h"

#include <algorithm>
#include <cmath>

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

void BlockWriter::set(char letter, double value, int decimals) {
  const Word* word = find(letter);
  if (!word) {
    add(letter, value, decimals);
    return;
  }
  const double r = rounded(value, decimals);
  if (r == word->value) return;
  const auto old = number_text(program_, *word);
  changes_.push_back({word->offset + word->value_at, old.size(), format_number(r, decimals, style_, old), letter, r});
}

/// Behind the nearest coordinate that comes before it in the usual order; otherwise before the next one; otherwise
/// behind the last N or G.
void BlockWriter::add(char letter, double value, int decimals) {
  const double r = rounded(value, decimals);
  const std::string word = in_case(letter) + format_number(r, decimals, style_);
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

std::string BlockWriter::further_block(std::string_view letters, const std::vector<double>& values, int decimals,
                                       std::span<const Word> own) const {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const Word* same = letters[i] == 'F' ? find('F') : nullptr;
    if (same && same->value == values[i])
      words.push_back(program_.source.text().substr(same->offset, same->length));
    else
      words.push_back(in_case(letters[i]) + format_number(values[i], decimals, style_));
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
