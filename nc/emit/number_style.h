#pragma once
// Number style: how a program writes its numbers, so that a changed word looks like its neighbours.
#include <optional>
#include <string>
#include <string_view>

#include "nc/program_text.h"

namespace camber::nc {

enum class WholeStyle { point, plain, point_zero };  ///< 1.  1  1.0

struct NumberStyle {
  bool leading_zero = true;              ///< 0.5 rather than .5
  int padded_decimals = 0;               ///< every number has at least so many decimals: 12.500
  WholeStyle whole = WholeStyle::point;  ///< whole numbers, where nothing is padded
  bool blanks = false;                   ///< blanks between the words of a block
  bool plus = false;                     ///< positive numbers have a sign: X+12.5
  bool comma = false;                    ///< 12,5
};

/// Returns the style of most coordinates of the program.
NumberStyle style_of(const Program& program);

/// Returns the style of most F words; blanks as beside coordinates.
NumberStyle feed_style_of(const Program& program);

/// Most decimals that an F word of the program has; 0 where none has a point.
int feed_decimals_of(const Program& program);

/// Most decimals that an X, Y or Z word of the program has; 0 where none has a point.
int coordinate_decimals_of(const Program& program);

/// Decimals of a number as written; -1 without a point.
int decimals_of(std::string_view number);

/// The double that a number with `decimals` decimals is read as.
double rounded(double value, int decimals);

/// `value` rounded, in the style; `like`: the text of the number that it replaces, whose own style wins.
std::string format_number(double value, int decimals, const NumberStyle& style, std::string_view like = {});

}  // namespace camber::nc
