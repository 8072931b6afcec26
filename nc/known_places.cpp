#include "nc/known_places.h"

#include <algorithm>

#include "nc/emit/text_rules.h"
#include "nc/language.h"

namespace camber::nc {

KnownPlaces::KnownPlaces(const Program& text, const Interpretation& moves) : text_(text), moves_(moves) {
  if (text.language != LanguageId::iso) rules_ = language_of(text).text_rules(text);
}

KnownPlaces::~KnownPlaces() = default;

bool KnownPlaces::goes_to_reference(const Move& move) const {
  if (text_.language != LanguageId::iso) return rules_->goes_to_machine_place(move.block);
  return std::ranges::any_of(text_.words_of(move.block), [](const Word& word) {
    return word.letter == 'G' && (word.value == 28 || word.value == 30 || word.value == 53);
  });
}

void KnownPlaces::learn_words(const Move& move) {
  for (const Word& word : text_.words_of(move.block))
    if (word.letter >= 'X' && word.letter <= 'Z') known_[static_cast<std::size_t>(word.letter - 'X')] = true;
}

KnownPlaces::Ends KnownPlaces::next(const Move& move) {
  const int tool = moves_.state_of(move).tool;
  Ends ends{.start = all() && tool == tool_};
  tool_ = tool;
  if (move.reference) {
    if (goes_to_reference(move))
      known_ = {};
    else  // on the way back the words give the end
      learn_words(move);
    return {};
  }
  for (std::size_t a = 0; a < 3; ++a)
    known_[a] = known_[a] || move.start_mm[static_cast<Eigen::Index>(a)] != move.end_mm[static_cast<Eigen::Index>(a)];
  learn_words(move);
  if (move.kind != MoveKind::rapid) known_ = {true, true, true};
  ends.end = all();
  return ends;
}

}  // namespace camber::nc
