#pragma once
// What a prediction tells of the loads along the cells of a path, and the feeds that they allow.
#include <span>
#include <vector>

#include "adapt/feed_cells.h"
#include "adapt/load.h"
#include "nc/move_map.h"

namespace camber::adapt {

/// A tooth passing.
struct PlacedLoad {
  std::size_t cell = FeedCells::kNone;
  LoadPoint load;
};

/// Loads of a program's tooth passings, in the order of the path, on the cells of the given program.
struct ObservedLoads {
  std::vector<PlacedLoad> points;  ///< one per stamp
};

/// A prediction of a program.
struct ObservedRun {
  const machine::Job& job;
  const simulate::SimulatedProgram& program;
  const nc::MoveMap& map;  ///< from its moves to the given program's
  std::span<const simulate::StampLoad> loads;
  std::span<const removal::SurfacePoint> surface{};  ///< empty: no form error
};

/// Actual speed of each stamp, mm/s: the motion of one tooth passing. Right after a rapid that of the next stamp.
std::vector<double> speeds_of(const machine::Job& job, const simulate::SimulatedProgram& program);

/// With both parts of each load from loads at another chip thickness (CutOptions::chip_ratio).
ObservedLoads observe(const ObservedRun& run, const FeedCells& cells, std::span<const simulate::StampLoad> at_ratio,
                      double chip_ratio);
/// With the parts in the ratio that `before` has at the same place.
ObservedLoads observe(const ObservedRun& run, const FeedCells& cells, const ObservedLoads& before);

/// By cell: the least of the greatest feeds that keep all upper limits, over a turn of the spindle about each passing;
/// infinite in air and where no feed exceeds a limit. Cells that no passing fell into have the lesser one of their
/// neighbours; chains without any passing have -1: nothing is known.
std::vector<double> allowed_feeds(const FeedCells& cells, const ObservedLoads& loads, std::span<const LoadLimit> limits,
                                  std::span<const int> flutes_of_cell);

/// By cell: whether a passing was in it, and whether one of them met material.
enum class Contact : std::uint8_t { unknown, air, cut };
std::vector<Contact> contacts_of(const FeedCells& cells, const ObservedLoads& loads);

/// By cell: the greatest value of a load at the observed feeds. 0 without a passing.
std::vector<double> greatest(const FeedCells& cells, const ObservedLoads& loads, Load load);

}  // namespace camber::adapt
