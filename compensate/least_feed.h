#pragma once
// Least feed: a fraction of the programmed feed, or the speed at which the control passes a corner anyway.
#include <vector>

#include "compensate/shift_path.h"
#include "machine/machine.h"
#include "nc/move.h"

namespace camber::compensate {

/// The lowest fraction of the programmed feed for the piece of `path` that ends at each point: `least`; within 2 mm of
/// path of a corner that the control passes more slowly, the fraction that it passes it with, but no less than half of
/// `least`. The chip there is no thinner than the given program's. Stops do not count. `path` is one of `program`'s.
std::vector<double> least_feeds(const ShiftPath& path, const nc::Interpretation& program,
                                const machine::Machine& machine, double least);

}  // namespace camber::compensate
