#pragma once
// Writes the frame of an operation at one direction of the tool: G68.2, G254 or joints.
#include "kinematics/chain.h"
#include "nc/emit/number_style.h"
#include "nc/five_axis_words.h"
#include "repath/post.h"

namespace camber::posture {

struct WrittenFrame {
  repath::PostFrame frame;
  Vec3 axis = Vec3::UnitZ();  ///< axis that follows from the words as they are written
};

/// G68.2 and G53.1, or G254 (tilted, dynamic), for this direction, the rotary axes back at 0 behind it.
WrittenFrame frame_text(const kinematics::Chain& chain, nc::OneDirection written, const Vec3& axis, int decimals,
                        const nc::NumberStyle& style);

}  // namespace camber::posture
