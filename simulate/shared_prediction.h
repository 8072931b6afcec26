#pragma once
// One prediction by several processes that all need its result, as the rounds of a compensation do.
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "simulate/predict.h"

namespace camber::simulate {

/// Processes that do the same work in the same order and come to the same calls.
struct Crew {
  std::size_t rank = 0, size = 1;
  /// Gives each other process `bytes` of its number. Returns what each has given this one; of itself: empty.
  std::function<std::vector<std::string>(const std::function<std::string(std::size_t rank)>& bytes)> exchange;
};

/// Each process of the crew sweeps and solves a section (simulate/sections.h), and all merge. The same bytes for every
/// size of the crew; in the last digits, and in static coupling by what kSettled_mm allows, others than predict()'s.
Prediction predict_together(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                            const Crew& crew, const std::function<void(double)>& progress);

/// While it lives, predict() is predict_together(), wherever this process calls it; only one may live.
class CrewScope {
 public:
  explicit CrewScope(const Crew& crew);
  ~CrewScope();
  CrewScope(const CrewScope&) = delete;
  CrewScope& operator=(const CrewScope&) = delete;
};
/// Of the scope; null: none.
const Crew* current_crew();

}  // namespace camber::simulate
