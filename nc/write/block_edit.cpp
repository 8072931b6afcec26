#include <algorithm>
#include <cctype>

#include "nc/write/five_axis_text.h"

namespace camber::nc {

BlockEdit::BlockEdit(const Program& program, std::uint32_t block, const Layout& layout)
    : program_(program),
      index_(block),
      block_(program.blocks[block]),
      words_(program.words_of(block)),
      layout_(layout) {}

const Word* BlockEdit::find(char letter) const {
  const auto at = std::find_if(words_.rbegin(), words_.rend(),
                               [&](const Word& w) { return w.letter == letter && !is_taken_out(w); });
  return at == words_.rend() ? nullptr : &*at;
}

const Word* BlockEdit::find_code(char letter, std::initializer_list<double> values) const {
  const auto at = std::find_if(words_.rbegin(), words_.rend(), [&](const Word& w) {
    return w.letter == letter && std::find(values.begin(), values.end(), w.value) != values.end();
  });
  return at == words_.rend() ? nullptr : &*at;
}

std::string_view BlockEdit::number(const Word& word) const {
  return std::string_view(program_.source.text())
      .substr(word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at));
}

bool BlockEdit::uses_blanks() const {
  for (std::size_t i = 1; i < words_.size(); ++i)
    if (program_.source.text()[words_[i].offset - 1] == ' ') return true;
  return words_.size() < 2;
}

std::string BlockEdit::in_case(std::string word) const {
  const bool lower = !words_.empty() && program_.source.text()[words_.front().offset] >= 'a';
  if (lower)
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

void BlockEdit::take_out(const Word& word) {
  if (is_taken_out(word)) return;
  take_out(word.offset, word.length);
  taken_out_.push_back(&word);
}

void BlockEdit::take_out(std::size_t offset, std::size_t length) {
  const std::string& text = program_.source.text();
  while (length > 0 && text[offset + length - 1] == ' ') --length;
  std::size_t begin = offset, end = offset + length;
  if (begin > block_.offset && text[begin - 1] == ' ')
    --begin;
  else if (begin == block_.offset && end < block_.offset + block_.length && text[end] == ' ')
    ++end;
  for (const Word& w : words_)
    if (w.offset >= offset && w.offset < offset + length) taken_out_.push_back(&w);
  changes_.push_back({begin, end - begin, {}});
}

void BlockEdit::replace(const Word& word, const std::string& number) {
  if (number != this->number(word))
    changes_.push_back({word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at), number});
}

void BlockEdit::replace(std::size_t offset, std::size_t length, std::string text) {
  changes_.push_back({offset, length, std::move(text)});
}

void BlockEdit::append(std::string& added, const std::string& word) const {
  if (!added.empty() && uses_blanks()) added += ' ';
  added += in_case(word);
}

void BlockEdit::add(char letter, const std::string& number) {
  append(letter == 'F' ? added_feed_ : added_, letter + number);
}

void BlockEdit::add_feed_word(const std::string& word) { append(added_feed_, word); }

void BlockEdit::add_code(const std::string& word) {
  const Word* n = find('N');
  const bool blank = uses_blanks();
  if (n)
    changes_.push_back({n->offset + std::size_t{n->length}, 0, (blank ? " " : "") + in_case(word)});
  else
    changes_.push_back({words_.front().offset, 0, in_case(word) + (blank ? " " : "")});
}

void BlockEdit::set(char letter, const std::string& number) {
  if (const Word* word = find(letter))
    replace(*word, number);
  else
    add(letter, number);
}

BlockEdit::Added BlockEdit::place_of_added(bool feed) const {
  const auto behind = [&](std::string_view letters) {
    const auto at = std::find_if(words_.rbegin(), words_.rend(),
                                 [&](const Word& w) { return letters.find(w.letter) != std::string_view::npos; });
    return at == words_.rend() ? std::size_t{0} : at->offset + std::size_t{at->length};
  };
  std::size_t at = behind(layout_.places);
  if (feed) at = std::max(at, behind(layout_.feed));
  if (at == 0) at = behind(layout_.codes);
  if (at > 0) return {at, false};
  if (layout_.front != Layout::kNowhere) return {layout_.front, false};
  return {words_.front().offset, true};
}

std::string BlockEdit::text() const {
  std::vector<Change> changes = changes_;
  const std::string gap = uses_blanks() ? " " : "";
  for (const bool feed : {false, true}) {
    const std::string& added = feed ? added_feed_ : added_;
    if (added.empty()) continue;
    const Added place = place_of_added(feed);
    changes.push_back({place.at, 0, place.in_front ? added + gap : gap + added});
  }
  std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.at < b.at; });
  const std::string& text = program_.source.text();
  std::string out;
  std::size_t from = block_.offset;
  for (const Change& c : changes) {
    if (c.at > from) out.append(text, from, c.at - from);
    out += c.text;
    from = std::max(from, c.at + c.length);
  }
  out.append(text, from, block_.offset + block_.length - from);
  return out;
}

}  // namespace camber::nc
