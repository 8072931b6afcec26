#pragma once
// One prediction by several processes that all need its result, as the rounds of a compensation do.
#include <cstddef>
#include <functional>
#include <memory>
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

/// What the predictions of a crew took; the same for every size of it.
struct CrewFigures {
  std::size_t predictions = 0;
  std::size_t from_the_last = 0;  ///< of them, that began from the stock and the bends of the prediction before
  std::size_t pieces = 0, rounds = 0, solved = 0;  ///< sums; solved: pieces, again in each round
};

/// What a crew has from one prediction to the next.
struct CrewMemory;

/// Each process of the crew sweeps and solves a section (simulate/sections.h), and all merge. The same bytes for every
/// size of the crew; in the last digits, and in static coupling by what kSettled_mm allows, others than predict()'s.
///
/// In static coupling a path with as many pieces as the one before, as the rounds of a compensation have it, begins its
/// rounds from the stock that the other has left and how its tool was bent, instead of what a straight cutter leaves.
Prediction predict_together(const machine::Job& job, const Target& target, const SimulatedProgram& program,
                            const Crew& crew, CrewMemory& memory, const std::function<void(double)>& progress);

/// While it lives, predict() is predict_together(), wherever this process calls it; only one may live.
class CrewScope {
 public:
  explicit CrewScope(const Crew& crew);
  ~CrewScope();
  CrewScope(const CrewScope&) = delete;
  CrewScope& operator=(const CrewScope&) = delete;
  const CrewFigures& figures() const;

  struct Current {
    const Crew& crew;
    CrewMemory& memory;
  };

 private:
  std::unique_ptr<CrewMemory> memory_;
  std::unique_ptr<Current> current_;
};
/// Of the scope; null: none.
const CrewScope::Current* current_crew();

}  // namespace camber::simulate
