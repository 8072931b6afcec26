#pragma once
// Words of Siemens and Heidenhain programs that choose the dynamics of the control: each selects the parameter set of
// its name ([control.mode.soft]), where the machine file has one.
#include <array>
#include <cstdint>
#include <string_view>

namespace camber::nc {

/// A word, and the group of which one word counts at a time.
struct ModeWord {
  std::string_view name;  ///< of the parameter set: the word in lower case
  std::uint8_t group = 0;
};

/// The place of a row is its bit in ModalState::mode_words.
inline constexpr std::array kModeWords{
    ModeWord{"cycle832_finish", 0},
    ModeWord{"cycle832_semifin", 0},
    ModeWord{"cycle832_rough", 0},
    ModeWord{"cycle32_finish", 1},  // HSC-MODE:0
    ModeWord{"cycle32_rough", 1},   // HSC-MODE:1
    ModeWord{"m120", 2},
    ModeWord{"dynfinish", 3},
    ModeWord{"dynprec", 3},
    ModeWord{"dynsemifin", 3},
    ModeWord{"dynrough", 3},
    ModeWord{"dynpos", 3},
    ModeWord{"dynnorm", 3},
    ModeWord{"compcad", 4},
    ModeWord{"compsurf", 4},
    ModeWord{"compcurv", 4},
    ModeWord{"comppath", 4},
    ModeWord{"compon", 4},
    ModeWord{"brisk", 5},
    ModeWord{"soft", 5},
    ModeWord{"drive", 5},
    ModeWord{"ffwof", 6},
    ModeWord{"ffwon", 6},
    ModeWord{"g601", 7},
    ModeWord{"g602", 7},
    ModeWord{"g603", 7},
    ModeWord{"g641", 8},
    ModeWord{"g642", 8},
    ModeWord{"g643", 8},
    ModeWord{"g644", 8},
    ModeWord{"g645", 8},
    ModeWord{"g646", 8},
};
static_assert(kModeWords.size() <= 32);

constexpr std::uint32_t mode_word_bit(std::string_view name) {
  for (std::size_t i = 0; i < kModeWords.size(); ++i)
    if (kModeWords[i].name == name) return std::uint32_t{1} << i;
  return 0;
}

/// The words of a group, as bits.
constexpr std::uint32_t mode_words_of_group(std::uint8_t group) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kModeWords.size(); ++i)
    if (kModeWords[i].group == group) bits |= std::uint32_t{1} << i;
  return bits;
}

/// Replaces the words of the group of `name` by it; of a name that is none, nothing changes.
constexpr std::uint32_t with_mode_word(std::uint32_t words, std::string_view name) {
  for (const ModeWord& word : kModeWords)
    if (word.name == name) return (words & ~mode_words_of_group(word.group)) | mode_word_bit(name);
  return words;
}

}  // namespace camber::nc
