#pragma once
// Which loads of an emitted program exceed their limits, and why.
#include <span>
#include <vector>

#include "adapt/adapt.h"
#include "adapt/observed_loads.h"

namespace camber::adapt {

struct Verdict {
  std::vector<OverLimit> over;      ///< by line
  std::vector<LoadFigure> figures;  ///< without max_before
  double excess = 0;                ///< greatest load / limit where the feed might have been lower
  double peak = 0;                  ///< greatest load / limit outside `over`
  std::vector<double> of_cell;      ///< greatest load / limit of each cell
};

/// Judges the observed loads of a candidate.
Verdict judge(const FeedCandidate& candidate, const ObservedLoads& loads, const FeedCells& cells,
              const simulate::SimulatedProgram& given, std::span<const LoadLimit> limits, const FeedBounds& bounds);

/// The greatest of each load at the observed feeds, by limit; of chip_min the greatest chip.
std::vector<double> peaks_of(const ObservedLoads& loads, std::span<const LoadLimit> limits);

}  // namespace camber::adapt
