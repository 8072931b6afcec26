#include "repath/post_writer.h"

#include <algorithm>
#include <cctype>

namespace camber::repath {
namespace {

// Words that added ones follow: those of the first kind, else those of the second.
constexpr std::string_view kPlaces = "XYZABC", kCodes = "NGH";

}  // namespace

BlockEdit::BlockEdit(const nc::Program& program, std::size_t block)
    : program_(program), block_(program.blocks[block]), words_(program.words_of(block)) {}

const nc::Word* BlockEdit::find(char letter) const {
  const auto at = std::find_if(words_.rbegin(), words_.rend(), [&](const nc::Word& w) { return w.letter == letter; });
  return at == words_.rend() ? nullptr : &*at;
}

const nc::Word* BlockEdit::find_code(char letter, std::initializer_list<double> values) const {
  const auto at = std::find_if(words_.rbegin(), words_.rend(), [&](const nc::Word& w) {
    return w.letter == letter && std::find(values.begin(), values.end(), w.value) != values.end();
  });
  return at == words_.rend() ? nullptr : &*at;
}

std::string_view BlockEdit::number(const nc::Word& word) const {
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

void BlockEdit::take_out(const nc::Word& word) {
  const std::string& text = program_.source.text();
  std::size_t begin = word.offset, end = begin + word.length;
  if (begin > block_.offset && text[begin - 1] == ' ')
    --begin;
  else if (begin == block_.offset && end < block_.offset + block_.length && text[end] == ' ')
    ++end;
  changes_.push_back({begin, end - begin, {}});
}

void BlockEdit::replace(const nc::Word& word, const std::string& number) {
  if (number != this->number(word))
    changes_.push_back({word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at), number});
}

void BlockEdit::add(char letter, const std::string& number) {
  if (!added_.empty() && uses_blanks()) added_ += ' ';
  added_ += in_case(letter + number);
}

void BlockEdit::add_code(const std::string& word) {
  const nc::Word* n = find('N');
  const bool blank = uses_blanks();
  if (n)
    changes_.push_back({n->offset + std::size_t{n->length}, 0, (blank ? " " : "") + in_case(word)});
  else
    changes_.push_back({words_.front().offset, 0, in_case(word) + (blank ? " " : "")});
}

void BlockEdit::set(char letter, const std::string& number) {
  if (const nc::Word* word = find(letter))
    replace(*word, number);
  else
    add(letter, number);
}

std::size_t BlockEdit::place_of_added() const {
  for (const std::string_view letters : {kPlaces, kCodes}) {
    const auto at = std::find_if(words_.rbegin(), words_.rend(),
                                 [&](const nc::Word& w) { return letters.find(w.letter) != std::string_view::npos; });
    if (at != words_.rend()) return at->offset + std::size_t{at->length};
  }
  return words_.front().offset;
}

std::string BlockEdit::text() const {
  std::vector<Change> changes = changes_;
  if (!added_.empty()) {
    const std::size_t at = place_of_added();
    const bool first = at == words_.front().offset;
    const std::string gap = uses_blanks() ? " " : "";
    changes.push_back({at, 0, first ? added_ + gap : gap + added_});
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

std::string BlockEdit::further(const std::vector<std::string>& words) const {
  std::string out = block_.skip == 0 ? "" : block_.skip == 1 ? "/" : "/" + std::to_string(block_.skip);
  const bool blanks = uses_blanks();
  for (std::size_t i = 0; i < words.size(); ++i) out += (i > 0 && blanks ? " " : "") + in_case(words[i]);
  return out;
}

}  // namespace camber::repath
