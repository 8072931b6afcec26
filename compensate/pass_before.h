#pragma once
// Versions of the program whose passes before, which leave the stock for the moves to compensate, leave less of it.
#include <memory>

#include "compensate/state.h"

namespace camber::compensate {

/// Moves that can be shifted cut the judged surface before those to compensate. Not where the stock has what is left
/// (stock.allowance_mm).
bool has_passes_before(const Task& task, const Version& given);

/// The given program with the passes before shifted towards the part, so that they leave what pass_allowance_mm says;
/// else the deepest deflection of their cutter and half of the tolerance, at least 20 um. Null: there are none, or they
/// leave no more than that. The shift is smooth, and may be as long as the stock that it takes away is thick.
std::unique_ptr<Version> with_less_left(const Task& task, const Version& given);

/// The passes before cut deeper into the part than the limit, and than those of the given program.
bool cuts_into_part(const Task& task, const Trial& trial);

}  // namespace camber::compensate
