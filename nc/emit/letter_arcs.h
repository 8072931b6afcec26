#pragma once
// Writes arcs of languages that give the centre by I J K and the radius by R.
#include "nc/emit/text_rules.h"

namespace camber::nc {

class LetterArcs : public TextRules {
 public:
  using TextRules::TextRules;

  bool by_radius(std::uint32_t block) const override;
  void set_arc(BlockWriter& writer, const WantedArc& wanted, const RoundedArc& arc, double unit_mm,
               int decimals) override;
  std::string further_arc(BlockWriter& writer, std::vector<NewWord> words, const WantedArc& wanted,
                          const RoundedArc& arc, double unit_mm, int decimals, std::span<const Word> own) override;
  bool motion_is_modal() const override { return true; }

 protected:
  static constexpr char kCentre[] = "IJK";  ///< one letter per axis
};

}  // namespace camber::nc
