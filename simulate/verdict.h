#pragma once
// Whether the figures of a prediction may be relied on.
#include <string>
#include <vector>

#include "simulate/predict.h"

namespace camber::simulate {

/// Chips and stock that differ by more do not describe the same cut.
constexpr double kMaxImbalance = 0.03;

/// Volume of the chips over the stock's change, less 1; 0 where next to nothing (a thousand voxels) is removed.
double imbalance(double chip_mm3, double stock_mm3, double voxel_mm);

/// A tool or a deflection lies beyond what the model covers: no figure of forces and errors is to be shown.
bool beyond_model(const Prediction& prediction);

/// Lines in which a deflection is beyond the model's range, ascending.
std::vector<std::size_t> lines_beyond_model(const SimulatedProgram& program, const Prediction& prediction);

/// A sentence for each reason why the figures are not to be relied on: beyond the model, chips against stock, no
/// surface that could be judged. Empty: none.
std::vector<std::string> doubts(const machine::Job& job, const SimulatedProgram& program, const Prediction& prediction);
/// One of them.
std::string imbalance_sentence(double chip_mm3, double stock_mm3);

}  // namespace camber::simulate
