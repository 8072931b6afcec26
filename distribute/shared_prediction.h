#pragma once
// One prediction by several processes that all need its result, as the rounds of a compensation do.
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "simulate/predict_path.h"

namespace camber::distribute {

/// Processes that do the same work in the same order and come to the same calls.
struct Crew {
  std::size_t rank = 0, size = 1;
  /// Gives each other process `bytes` of its number. Returns what each has given this one; of itself: empty.
  std::function<std::vector<std::string>(const std::function<std::string(std::size_t rank)>& bytes)> exchange;
};

/// Cost of the predictions of a crew; the same for every size of it.
struct CrewFigures {
  std::size_t predictions = 0;
  std::size_t from_the_last = 0;  ///< those that began from the stock and the bends of the prediction before
  std::size_t pieces = 0, rounds = 0, solved = 0;  ///< sums; solved: pieces, again in each round
};

/// The predictions of a crew, one after the other. Each process of it sweeps and solves a section
/// (distribute/path_sections.h), and all merge. The same bytes for every size of the crew; in the last digits, and in
/// static coupling by what kSettled_mm allows, others than simulate::predict()'s.
///
/// In static coupling a path with as many pieces as the one before, as the rounds of a compensation have it, begins its
/// rounds from the stock that the other has left and how its tool was bent, instead of what a straight cutter leaves.
class CrewPredictions {
 public:
  /// `crew` must outlive this.
  explicit CrewPredictions(const Crew& crew);
  ~CrewPredictions();
  CrewPredictions(const CrewPredictions&) = delete;
  CrewPredictions& operator=(const CrewPredictions&) = delete;

  /// The prediction by all processes of the crew; a turn, chips of another ratio and elastic parts each predicts alone.
  simulate::Prediction predict(const machine::Job& job, const simulate::Target& target,
                               const simulate::SimulatedProgram& program, const simulate::PredictOptions& options);
  /// The same, for simulate::SetupOptions; this must outlive it.
  simulate::Predictor predictor();
  const CrewFigures& figures() const;

 private:
  struct Memory;  ///< from one prediction to the next
  simulate::Prediction predict_together(const machine::Job& job, const simulate::Target& target,
                                        const simulate::SimulatedProgram& program,
                                        const std::function<void(double)>& progress);

  const Crew& crew_;
  std::unique_ptr<Memory> memory_;
};

}  // namespace camber::distribute
