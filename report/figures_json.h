#pragma once
// The figures of a run as JSON text: every figure that a person is shown, under the names that the user guide uses.
#include <string>
#include <vector>

#include "compensate/compensate_path.h"
#include "compensate/verify_program.h"
#include "simulate/predict_path.h"
#include "simulate/traced.h"

namespace camber::report {

/// Version of the JSON. 2: error figures are against the path that CAM commanded (error_um = deflection_um +
/// contour_um); in 1 they were against the undeflected sweep as the machine runs it, which is deflection_um now.
inline constexpr int kSchemaVersion = 2;

/// `traced`: of a prediction at measured positions, else null. `doubts`: why the figures are not reliable.
std::string predict_json(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                         double compute_s, const simulate::TracedRun* traced = nullptr,
                         const std::vector<std::string>& doubts = {});
std::string compensate_json(const compensate::CompensationResult& result, const machine::CompensationSettings& asked,
                            double compute_s);

std::string verify_json(const compensate::Verification& verification, const machine::CompensationSettings& asked,
                        double compute_s);

/// The same for a terminal, within 80 columns.
/// Volume of the chips of the tooth passings that the model covers.
double chips_mm3(const simulate::Prediction& prediction);
/// Across the tool, of the tooth passings that the model covers.
double largest_force_N(const simulate::Prediction& prediction);

std::string predict_text(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                         double compute_s, const simulate::TracedRun* traced = nullptr);
std::string compensate_text(const compensate::CompensationResult& result, double compute_s);

/// Area of a nominal surface that is not judged (simulate/region.h).
struct RegionFigures {
  double border_mm2 = 0, not_judged_mm2 = 0;
  bool between = false;
};
/// A line for each that is not zero.
std::string region_text(const RegionFigures& region);

/// A sentence about tooth passings without a static equilibrium, and the lines that they are in; empty where all have
/// one.
std::string unsettled_sentence(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction);
std::string unsettled_sentence(const compensate::CompensationResult& result);
std::string unsettled_sentence(const compensate::Verification& verification);

}  // namespace camber::report
