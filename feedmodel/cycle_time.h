#pragma once
// Cycle time of a program on a machine: cutting, positioning, spindle, tool changes, codes, by tool; of each move.
#include <cstdint>
#include <iterator>
#include <string_view>
#include <vector>

#include "machine/machine_model.h"
#include "nc/move.h"

namespace camber::feedmodel {

struct MotionTimes {
  std::vector<double> move_s;        ///< one per move; merged lines count at the last of them
  std::vector<float> acceleration;   ///< along the path of each cutting move's last segment, mm/s^2; 0: none
  std::size_t speed_changes = 0;     ///< along the path and of positionings
  std::size_t below_full_rapid = 0;  ///< positionings
  std::size_t unplaced_moves = 0;    ///< see CycleTime
};

/// The times of plan_motion, move by move: their sum is the time that predict_feed takes.
MotionTimes motion_times(const nc::Interpretation& program, const machine::Machine& machine);

/// Time by kind of operation. Of simultaneous actions, the motion keeps its whole time and the others count the time by
/// which they are longer. Source: Takata 1999, eqs. 2.1-2.2.
struct CycleSplit {
  double cutting_s = 0, positioning_s = 0, spindle_s = 0, tool_change_s = 0, m_code_s = 0, dwell_s = 0, index_s = 0,
         pallet_s = 0;

  double total_s() const;
  CycleSplit& operator+=(const CycleSplit& other);
};

/// The kinds by name, in the order in which they are shown.
struct CycleKind {
  std::string_view key;   ///< "cutting_s"
  std::string_view name;  ///< "cutting"
  double CycleSplit::*field;
};
inline constexpr CycleKind kCycleKinds[] = {
    {"cutting_s", "cutting", &CycleSplit::cutting_s},     {"positioning_s", "positioning", &CycleSplit::positioning_s},
    {"spindle_s", "spindle", &CycleSplit::spindle_s},     {"tool_change_s", "tool change", &CycleSplit::tool_change_s},
    {"m_code_s", "M, S, T codes", &CycleSplit::m_code_s}, {"dwell_s", "dwell", &CycleSplit::dwell_s},
    {"index_s", "index table", &CycleSplit::index_s},     {"pallet_s", "pallet", &CycleSplit::pallet_s},
};

/// The kind with the longest time.
const CycleKind& dominant_kind(const CycleSplit& split);

/// Times of one tool, or of all.
struct CycleUse {
  int tool = 0;
  std::size_t tool_changes = 0;  ///< changes that brought it in
  CycleSplit time{};
  double cutting_mm = 0, positioning_mm = 0;
  std::size_t cutting_moves = 0;       ///< moves that have a length
  double commanded_s = 0;              ///< cutting length / commanded feed (override taken)
  double acceleration_mm2_per_s2 = 0;  ///< sum of length x acceleration along the path, cutting

  /// Means over the cutting path; 0 without one.
  double commanded_feed_mm_per_s() const;
  double average_feed_mm_per_s() const;
  double acceleration_mm_per_s2() const;        ///< infinite where there is no limit
  double e() const;                             ///< average / commanded feed
  double k() const;                             ///< F^2 / (a d_av), see yan_shirase.h
  CycleUse& operator+=(const CycleUse& other);  ///< `tool` stays
};

/// Moves by their length. Bin i holds lengths up to edges_mm[i], the last one what is longer. Edges: twenty multiples
/// of a step, or, without one, kDistanceEdgesMm.
inline constexpr double kDistanceEdgesMm[] = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
struct DistanceHistogram {
  explicit DistanceHistogram(double step_mm = 0);

  std::vector<double> edges_mm;  ///< ascending
  std::vector<std::size_t> counts;
  std::size_t moves = 0;
  double length_mm = 0;

  void add(double distance_mm);
};

struct CycleTime {
  CycleUse all;
  std::vector<CycleUse> tools;  ///< tools in the order of their first use
  DistanceHistogram g00, g01;
  std::size_t below_full_rapid = 0;  ///< positioning moves whose slowest axis does not reach its rapid rate
  std::size_t speed_changes = 0;     ///< along the path, of the linear law: what the jerk filter counts
  std::size_t unplaced_moves = 0;    ///< moves to or from an unknown reference point: part of their path is missing
  std::vector<double> move_s;        ///< time of each move of the program, dwells included
};

/// The time of the whole program. Cutting runs through the lookahead plan of predict_feed (or, with the exponential
/// law, block by block); positioning along the dog-leg path with every axis on its own, or along the straight line.
/// Tools, spindle and codes come from the program's events. Deterministic; does not throw on valid input.
/// Linear in the number of blocks; about 150 bytes of memory a block.
CycleTime cycle_time(const nc::Interpretation& program, const machine::Machine& machine);

}  // namespace camber::feedmodel
