#pragma once
// Lookahead: finds the greatest entry speed of each segment from which the limits ahead can still be met.
#include <cstddef>
#include <vector>

namespace camber::feedmodel {

struct PlanRow {
  double length_mm = 0;
  double speed_limit_mm_per_s = 0;
  double acceleration_mm_per_s2 = 0;
  double planned_fraction = 1;      ///< fraction of the acceleration that may be counted on for braking
  bool joined = false;              ///< counts as one with the next for the horizon
  double entry_speed_mm_per_s = 0;  ///< in: limit of the corner; out: planned speed
};

/// The columns of the rows that braking needs: of a long program the rows themselves are not kept.
class BrakingRows {
 public:
  std::size_t size() const { return entry_.size(); }
  /// Room that is not written to takes no memory.
  void reserve(std::size_t rows);
  void add(const PlanRow& row);
  void set_entry_speed(std::size_t i, double entry_speed_mm_per_s) { entry_[i] = entry_speed_mm_per_s; }
  /// Lowers the entry speeds of rows from ... end - 1, which are a path of their own, to what braking allows:
  /// v_i^2 <= v_{i+1}^2 + 2 a_i L_i, at rest after the last one. `depth`: see plan_speeds(). Once for each row.
  void brake(std::size_t from, std::size_t end, std::size_t depth);
  /// Finishes and returns the entry speeds, mm/s.
  std::vector<double> take_entry_speeds();

 private:
  double entry_cap(std::size_t i, std::size_t from) const;
  void backward_all(std::size_t from, std::size_t end);
  void backward_window(std::size_t from, std::size_t end, std::size_t depth);

  std::vector<double> entry_, limit_;  ///< mm/s
  std::vector<double> brakes_;         ///< speed squared that a row can lose along its length
  std::vector<bool> joined_, instant_;
};

/// Lowers entry speeds, row by row from the first, to what acceleration from rest can reach.
class ReachableSpeed {
 public:
  /// The row's entry speed, mm/s.
  double enter(const PlanRow& row);

 private:
  double squared_ = 0;
};

/// Lowers the entry speeds, in place, to what constant acceleration can keep: v_i^2 <= v_{i+1}^2 + 2 a_i L_i
/// backward and forward. The path starts and ends at rest.
///
/// depth: number of segments that the control sees ahead, the last of which it must be able to stop at;
/// 0: all. Linear time for every depth. Accelerations may be infinite.
void plan_speeds(std::vector<PlanRow>& rows, std::size_t depth);

}  // namespace camber::feedmodel
