#include "nc/emit/text_rules.h"

#include <algorithm>

#include "nc/emit/block_writer.h"

namespace camber::nc {

bool LetterArcs::by_radius(std::uint32_t block) const {
  return std::ranges::any_of(program_.words_of(block), [](const Word& w) { return w.letter == 'R'; });
}

void LetterArcs::set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
                         int decimals) {
  if (wanted.by_radius) return writer.set('R', arc.r_mm / unit_mm, decimals);
  const PlaneAxes axes = axes_of(wanted.plane);
  const auto set_centre = [&](char letter, double value_mm) {
    if (writer.find(letter) || value_mm != 0) writer.set(letter, value_mm / unit_mm, decimals);
  };
  set_centre(kCentre[axes.first], arc.first_mm);
  set_centre(kCentre[axes.second], arc.second_mm);
}

std::string LetterArcs::further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                                    const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) {
  const PlaneAxes axes = axes_of(wanted.plane);
  std::vector<NewWord> of_arc;
  if (wanted.by_radius)
    of_arc = {{'R', arc.r_mm / unit_mm, decimals}};
  else
    of_arc = {{kCentre[axes.first], arc.first_mm / unit_mm, decimals},
              {kCentre[axes.second], arc.second_mm / unit_mm, decimals}};
  const auto feed = std::ranges::find(words, 'F', &NewWord::letter);
  words.insert(feed, of_arc.begin(), of_arc.end());
  return writer.further_block(words, own);
}

}  // namespace camber::nc
