#pragma once
// Reliability of the figures of a prediction.
#include <string>
#include <vector>

#include "simulate/predict_path.h"

namespace camber::simulate {

/// Chips and stock that differ by more do not describe the same cut.
constexpr double kMaxImbalance = 0.03;

/// Volume of the chips over the stock's change, less 1; 0 where next to nothing (a thousand voxels) is removed.
double imbalance(double chip_mm3, double stock_mm3, double voxel_mm);

/// True if the model covers less than half of the surface (of a program that leaves none, of the passings): errors must
/// not be reported.
bool beyond_model(const Prediction& prediction);
/// True if it covers less than half of the tooth passings: forces must not be reported.
bool forces_beyond_model(const Prediction& prediction);

/// What keeps the tool from an equilibrium: "the tool is pulled into its cut (...)".
const char* no_equilibrium_text(deflection::NoEquilibrium reason);
/// Says why a cut was given up, with its line.
std::string no_rest_sentence(const SimulatedProgram& program, const NoRest& given_up);

/// One sentence for each reason why the figures are not reliable: beyond the model, chips against stock, no
/// surface that could be judged. Empty: none.
std::vector<std::string> doubts(const machine::Job& job, const SimulatedProgram& program, const Prediction& prediction);
/// One of them.
std::string imbalance_sentence(double chip_mm3, double stock_mm3);

}  // namespace camber::simulate
