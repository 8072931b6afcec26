#pragma once
// A place in the text of a statement: blanks, comments, the signs of continued lines and line ends are passed over.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace camber::nc::heidenhain {

inline char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
inline bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

class Cursor {
 public:
  Cursor(std::string_view text, std::size_t at, std::size_t end) : text_(text), at_(at), end_(end) {}

  std::size_t offset() const { return at_; }
  void go_to(std::size_t offset) { at_ = offset; }
  std::size_t end() const { return end_; }

  /// Advances to the next character that means something; returns false at the end.
  bool more() {
    while (at_ < end_) {
      const char c = text_[at_];
      if (c == ';') {
        while (at_ < end_ && text_[at_] != '\n' && text_[at_] != '\r') ++at_;
      } else if (is_blank(c) || c == '~') {
        ++at_;
      } else {
        return true;
      }
    }
    return false;
  }
  /// Upper case; '\0' at the end.
  char peek() { return more() ? upper(text_[at_]) : '\0'; }
  /// The character so many behind, without passing over anything.
  char behind(std::size_t by) const { return at_ + by < end_ ? upper(text_[at_ + by]) : '\0'; }
  void advance(std::size_t by = 1) { at_ += by; }
  bool accept(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  /// The run of letters here, in upper case; stays where it is.
  std::string letters() {
    std::string out;
    if (!more()) return out;
    for (std::size_t i = at_; i < end_ && is_letter(text_[i]); ++i) out += upper(text_[i]);
    return out;
  }
  /// The word, if it stands here and no further letter behind it.
  bool accept(std::string_view word) {
    if (letters() != word) return false;
    at_ += word.size();
    return true;
  }
  /// The word, whatever stands behind it.
  bool accept_prefix(std::string_view word) {
    if (!more() || end_ - at_ < word.size()) return false;
    for (std::size_t i = 0; i < word.size(); ++i)
      if (upper(text_[at_ + i]) != word[i]) return false;
    at_ += word.size();
    return true;
  }

  /// Digits, with a point or a comma, and a sign with blanks behind it; nothing, and no move, where there is none.
  std::optional<double> number();
  /// Digits alone.
  std::optional<int> integer();
  /// "text" in quotes.
  std::optional<std::string> quoted();

  /// The text of the word here, for messages.
  std::string word() const;

 private:
  std::string_view text_;
  std::size_t at_, end_;
};

}  // namespace camber::nc::heidenhain
