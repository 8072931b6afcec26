#pragma once
// Gives the words of one block with their values.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "nc/program_text.h"
#include "nc/siemens/siemens_tree.h"

namespace camber::nc::siemens {

struct Slot {
  bool given = false;
  bool by_expression = false;
  Dimension dimension = Dimension::as_modal;
  double value = 0;
  std::uint32_t offset = 0;
};

/// Addresses of more than one letter.
enum class Extra : std::uint8_t { cr, ar, ap, rp, turn, i1, j1, k1, chf, chr, rnd, ang, adis, rpl, a3, b3, c3, count };

inline constexpr std::array<std::string_view, static_cast<std::size_t>(Extra::count)> kExtraNames{
    "CR", "AR", "AP", "RP", "TURN", "I1", "J1", "K1", "CHF", "CHR", "RND", "ANG", "ADIS", "RPL", "A3", "B3", "C3"};

struct CodeWord {
  int number = 0;
  std::uint32_t offset = 0;
  int spindle = 1;  ///< M3=3: the extension
  double value = 0;
};

class BlockWords {
 public:
  void clear(std::size_t offset) {
    if (letters_used_ != 0) letters_.fill({});
    if (extras_used_) extras_.fill({});
    letters_used_ = 0;
    extras_used_ = false;
    g.clear();
    m.clear();
    offset_ = offset;
  }
  Slot& set(char letter) {
    letters_used_ |= 1U << static_cast<unsigned>(letter - 'A');
    return letters_[static_cast<std::size_t>(letter - 'A')];
  }
  Slot& set(Extra extra) {
    extras_used_ = true;
    return extras_[static_cast<std::size_t>(extra)];
  }
  const Slot& of(char letter) const { return letters_[static_cast<std::size_t>(letter - 'A')]; }
  const Slot& of(Extra extra) const { return extras_[static_cast<std::size_t>(extra)]; }
  bool has(char letter) const { return of(letter).given; }
  bool has(Extra extra) const { return of(extra).given; }
  bool has_any(std::string_view letters) const {
    for (const char c : letters)
      if (has(c)) return true;
    return false;
  }
  bool uses_extras() const { return extras_used_; }
  bool empty() const { return letters_used_ == 0 && !extras_used_ && g.empty() && m.empty(); }
  /// Position of the block's first word.
  std::size_t offset() const { return offset_; }

  std::vector<CodeWord> g, m;

 private:
  std::array<Slot, 26> letters_{};
  std::array<Slot, static_cast<std::size_t>(Extra::count)> extras_{};
  std::uint32_t letters_used_ = 0;
  bool extras_used_ = false;
  std::size_t offset_ = 0;
};

}  // namespace camber::nc::siemens
