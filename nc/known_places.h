#pragma once
// Tracks which ends of a move lie at places that the program has given.
#include <array>
#include <memory>

#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

class TextRules;

/// Follows the moves of a program in order. Before an axis has been named, and after G28, G30 and G53, which take it to
/// a place of the machine's own, nobody knows where it is; a tool change may take the axes anywhere.
class KnownPlaces {
 public:
  struct Ends {
    bool start = false, end = false;
  };

  KnownPlaces(const Program& text, const Interpretation& moves);
  ~KnownPlaces();

  /// Returns which ends of the next move are known; neither end of a move to or from a reference point.
  Ends next(const Move& move);

 private:
  bool all() const { return known_[0] && known_[1] && known_[2]; }
  bool goes_to_reference(const Move& move) const;
  void learn_words(const Move& move);

  const Program& text_;
  std::unique_ptr<TextRules> rules_;  ///< only for languages other than ISO
  const Interpretation& moves_;
  std::array<bool, 3> known_{};
  int tool_ = -1;
};

}  // namespace camber::nc
