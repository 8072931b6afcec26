#pragma once
// What the F word of a block counts: a property of the control.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::kinematics {

class MachineProgram;

enum class FeedMeaning : std::uint8_t {
  linear,   ///< mm/min along X Y Z; rotary axes come along
  tip,      ///< mm/min of the tip in the part's frame (tool-centre-point control)
  joints,   ///< mm/min of the norm of all axes, a degree counted as a millimetre
  degrees,  ///< degrees/min where only rotary axes move
  inverse   ///< G93: 1/min of the block
};

struct FeedMeaningText {
  std::string_view name;  ///< in JSON
  std::string_view text;  ///< for people
};

/// In the order of FeedMeaning.
inline constexpr std::array kFeedMeaningTexts{
    FeedMeaningText{"linear", "mm/min along X Y Z; rotary axes come along"},
    FeedMeaningText{"tip", "mm/min of the tip in the part's frame"},
    FeedMeaningText{"joints", "mm/min of all axes together, a degree counted as a millimetre"},
    FeedMeaningText{"degrees", "degrees/min of the rotary axes"},
    FeedMeaningText{"inverse", "1/min of the block (G93)"},
};

/// Meaning of F in a feed move. `turn_rad`: turns of the rotary axes in it.
FeedMeaning feed_meaning(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                         const machine::Control& control);

/// Speed along the path (mm/s of X Y Z; degrees/s where only rotary axes move) that F asks for, without override.
/// inverse_time_s: what G93 asks for; 0: not G93.
double feed_along_path(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                       double inverse_time_s, const machine::Control& control);

/// How long a feed move takes at the speed that F asks for; nothing where nothing moves or F is not given.
std::optional<double> programmed_time_s(const nc::Interpretation& program, const nc::Move& move, const Vec3& turn_rad,
                                        double inverse_time_s, const machine::Control& control);

/// Speed of the tip on the part that F asks for in each move, mm/s; 0: F is not given, or the tip stands.
std::vector<double> tip_feeds_mm_per_s(const MachineProgram& program, const machine::Machine& machine);

/// How many feed moves have a meaning, and the line of the first.
struct FeedMeaningUse {
  FeedMeaning meaning = FeedMeaning::linear;
  std::size_t moves = 0;
  std::uint32_t first_line = 0;  ///< 1-based
};

/// In the order of FeedMeaning, those that occur. Empty for programs without rotary words and for machines without
/// [kinematics].
std::vector<FeedMeaningUse> feed_meanings(const nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::kinematics
