#include "feedmodel/lookahead.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace camber::feedmodel {
namespace {

double squared(double v) { return v * v; }

/// Speed squared that the segment can win or lose along its length.
double gain(const PlanRow& row) { return row.length_mm > 0 ? 2.0 * row.acceleration_mm_per_s2 * row.length_mm : 0.0; }

/// Of it, what the control counts on for braking.
double brakes(const PlanRow& row) { return gain(row) * row.planned_fraction; }

/// What may be the speed squared at the entry of a row, its neighbours considered.
double entry_cap(const std::vector<PlanRow>& rows, std::size_t i) {
  double v = std::min(rows[i].entry_speed_mm_per_s, rows[i].speed_limit_mm_per_s);
  if (i > 0) v = std::min(v, rows[i - 1].speed_limit_mm_per_s);
  return squared(v);
}

void backward_all(std::vector<PlanRow>& rows) {
  double exit_squared = 0;
  for (std::size_t i = rows.size(); i-- > 0;) {
    exit_squared = std::min(entry_cap(rows, i), exit_squared + brakes(rows[i]));
    rows[i].entry_speed_mm_per_s = std::sqrt(exit_squared);
  }
}

/// The same with a horizon: the entry of row i is min over j from i to the horizon of cap_j + S_j - S_i, where S
/// sums what the rows can brake, and rest at the horizon. A queue holds the candidates j with increasing
/// cap_j + S_j, nearest in front.
void backward_window(std::vector<PlanRow>& rows, std::size_t depth) {
  struct Candidate {
    std::size_t index;
    double key;
  };
  const std::size_t n = rows.size();
  std::vector<double> sum(n + 1, 0.0);  // S
  for (std::size_t i = 0; i < n; ++i) sum[i + 1] = sum[i] + brakes(rows[i]);
  std::deque<Candidate> queue;
  std::size_t horizon = n, seen = 0;  // rows [i, horizon) are seen; joined rows count once
  std::vector<double> entry(n);
  for (std::size_t i = n; i-- > 0;) {
    if (!rows[i].joined) ++seen;
    while (seen > depth) {
      --horizon;
      if (!rows[horizon].joined) --seen;
    }
    const double key = entry_cap(rows, i) + sum[i];
    while (!queue.empty() && queue.back().key >= key) queue.pop_back();
    queue.push_back({i, key});
    while (queue.front().index >= horizon) queue.pop_front();
    const double least = std::min(queue.front().key, sum[horizon]) - sum[i];
    entry[i] = std::sqrt(std::max(0.0, least));
  }
  for (std::size_t i = 0; i < n; ++i) rows[i].entry_speed_mm_per_s = std::min(rows[i].entry_speed_mm_per_s, entry[i]);
}

void forward(std::vector<PlanRow>& rows) {
  double reachable_squared = 0;
  for (PlanRow& row : rows) {
    reachable_squared = std::min(squared(row.entry_speed_mm_per_s), reachable_squared);
    row.entry_speed_mm_per_s = std::sqrt(reachable_squared);
    reachable_squared += gain(row);
  }
}

}  // namespace

void plan_speeds(std::vector<PlanRow>& rows, std::size_t depth) {
  // With instant acceleration every distance is enough to stop in: a horizon changes nothing.
  const bool instant = std::any_of(rows.begin(), rows.end(), [](const PlanRow& r) { return std::isinf(gain(r)); });
  if (depth == 0 || depth >= rows.size() || instant) {
    backward_all(rows);
  } else {
    backward_window(rows, depth);
  }
  forward(rows);
}

}  // namespace camber::feedmodel
