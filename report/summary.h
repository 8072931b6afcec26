#pragma once
// The figures of a run as JSON text: every figure that a person is shown, under the names that the user guide uses.
#include <string>

#include "compensate/compensate.h"
#include "simulate/predict.h"

namespace camber::report {

std::string predict_json(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                         double compute_s);
std::string compensate_json(const compensate::CompensationResult& result, double compute_s);

/// The same for a terminal, within 80 columns.
std::string predict_text(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                         double compute_s);
std::string compensate_text(const compensate::CompensationResult& result, double compute_s);

/// A sentence about tooth passings without a static equilibrium, and the lines that they are in; empty where all have
/// one.
std::string unsettled_sentence(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction);
std::string unsettled_sentence(const compensate::CompensationResult& result);

/// A sentence about how far the compensation stayed from its tolerance, and whether the guard is why.
std::string left_over_sentence(const compensate::ErrorSplit& left, const machine::CompensationSettings& asked);

}  // namespace camber::report
