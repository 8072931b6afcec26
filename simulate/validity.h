#pragma once
// Which tooth passings, and which points of the surface, the model covers.
#include <cstdint>
#include <span>
#include <vector>

#include "removal/form_error.h"
#include "simulate/predict_path.h"

namespace camber::simulate {

/// Fraction of surface or passings without a valid figure from which on none is shown.
constexpr double kMaxInvalid = 0.5;

/// Finds the passings that the model does not cover: a deflection beyond its range (CutResult::beyond_stamps), or none
/// that it comes to rest at (unsettled_stamps); and after each of them those of the same cut within a radius of the
/// tool, whose chips are read from the stock that it left.
///
/// Makes those points of `surface` invalid that such a passing has made, and those that the undeflected cutter would
/// have touched there, if nothing has cut them later: the tool should have made them, and was pushed away.
/// `unstable`: passings that chatter (ChatterMargins::invalid_stamps), the same.
Validity find_validity(const machine::Job& job, const SimulatedProgram& program, const CutResult& cut,
                       std::span<const std::uint32_t> unstable, std::vector<removal::SurfacePoint>& surface);

/// 1-based lines of stamps, ascending, each once.
std::vector<std::size_t> lines_of(const SimulatedProgram& program, std::span<const std::uint32_t> stamps);

}  // namespace camber::simulate
