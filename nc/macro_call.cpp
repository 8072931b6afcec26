#include "nc/macro_call.h"

#include <string_view>

namespace camber::nc {
namespace {

/// Local variable of a letter, A to Z; 0: no argument.
constexpr int kVariable[26] = {1, 2, 3, 7,  8,  9,  0,  11, 4,  5,  6,  0,  13,
                               0, 0, 0, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

}  // namespace

LocalVariables macro_arguments(std::span<const Word> words) {
  LocalVariables out;
  int set = 0, last = -1;
  for (const Word& w : words) {
    int variable = kVariable[w.letter - 'A'];
    if (variable == 0) continue;
    if (w.letter >= 'I' && w.letter <= 'K') {
      const int place = w.letter - 'I';
      if (place <= last) ++set;
      last = place;
      variable += 3 * set;
      if (set > 9) throw MacroError(w.offset, "macro-argument", "more than ten sets of I, J and K");
    }
    out.numbered[static_cast<std::size_t>(variable)] = w.value;
  }
  return out;
}

}  // namespace camber::nc
