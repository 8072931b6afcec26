#include "feedmodel/lookahead.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

namespace camber::feedmodel {
namespace {

double squared(double v) { return v * v; }

/// Speed squared that the segment can win or lose along its length.
double gain(const PlanRow& row) { return row.length_mm > 0 ? 2.0 * row.acceleration_mm_per_s2 * row.length_mm : 0.0; }

/// Returns the part of that gain that the control counts on for braking.
double brakes(const PlanRow& row) { return gain(row) * row.planned_fraction; }

}  // namespace

void BrakingRows::reserve(std::size_t rows) {
  for (std::vector<double>* list : {&entry_, &limit_, &brakes_}) list->reserve(rows);
}

void BrakingRows::add(const PlanRow& row) {
  entry_.push_back(row.entry_speed_mm_per_s);
  limit_.push_back(row.speed_limit_mm_per_s);
  brakes_.push_back(brakes(row));
  joined_.push_back(row.joined);
  instant_.push_back(std::isinf(gain(row)));
}

/// Returns the greatest speed squared at the entry of a row that its neighbours allow.
double BrakingRows::entry_cap(std::size_t i, std::size_t from) const {
  double v = std::min(entry_[i], limit_[i]);
  if (i > from) v = std::min(v, limit_[i - 1]);
  return squared(v);
}

void BrakingRows::backward_all(std::size_t from, std::size_t end) {
  double exit_squared = 0;
  for (std::size_t i = end; i-- > from;) {
    exit_squared = std::min(entry_cap(i, from), exit_squared + brakes_[i]);
    entry_[i] = std::sqrt(exit_squared);
  }
}

/// Does the same with a horizon: the entry of row i is min over j from i to the horizon of cap_j + S_j - S_i, where S
/// sums what the rows can brake, and rest at the horizon. A queue holds the candidates j with increasing
/// cap_j + S_j, nearest in front.
void BrakingRows::backward_window(std::size_t from, std::size_t end, std::size_t depth) {
  struct Candidate {
    std::size_t index;
    double key;
  };
  double whole = 0;
  for (std::size_t i = from; i < end; ++i) whole += std::exchange(brakes_[i], whole);  // now S
  const auto sum = [&](std::size_t i) { return i < end ? brakes_[i] : whole; };
  std::deque<Candidate> queue;
  std::size_t horizon = end, seen = 0;  // rows [i, horizon) are seen; joined rows count once
  for (std::size_t i = end; i-- > from;) {
    if (!joined_[i]) ++seen;
    while (seen > depth) {
      --horizon;
      if (!joined_[horizon]) --seen;
    }
    const double key = entry_cap(i, from) + sum(i);
    while (!queue.empty() && queue.back().key >= key) queue.pop_back();
    queue.push_back({i, key});
    while (queue.front().index >= horizon) queue.pop_front();
    const double least = std::min(queue.front().key, sum(horizon)) - sum(i);
    entry_[i] = std::min(entry_[i], std::sqrt(std::max(0.0, least)));
  }
}

void BrakingRows::brake(std::size_t from, std::size_t end, std::size_t depth) {
  // With instant acceleration every distance is enough to stop in: a horizon changes nothing.
  const auto at = [&](std::size_t i) { return instant_.begin() + static_cast<std::ptrdiff_t>(i); };
  const bool instant = std::find(at(from), at(end), true) != at(end);
  if (depth == 0 || depth >= end - from || instant)
    backward_all(from, end);
  else
    backward_window(from, end, depth);
}

std::vector<double> BrakingRows::take_entry_speeds() {
  std::vector<double> out = std::move(entry_);
  *this = {};
  return out;
}

double ReachableSpeed::enter(const PlanRow& row) {
  squared_ = std::min(squared(row.entry_speed_mm_per_s), squared_);
  const double entry = std::sqrt(squared_);
  squared_ += gain(row);
  return entry;
}

void plan_speeds(std::vector<PlanRow>& rows, std::size_t depth) {
  BrakingRows braking;
  braking.reserve(rows.size());
  for (const PlanRow& row : rows) braking.add(row);
  braking.brake(0, rows.size(), depth);
  const std::vector<double> entry = braking.take_entry_speeds();
  ReachableSpeed reachable;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].entry_speed_mm_per_s = entry[i];
    rows[i].entry_speed_mm_per_s = reachable.enter(rows[i]);
  }
}

}  // namespace camber::feedmodel
