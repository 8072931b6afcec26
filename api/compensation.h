#pragma once
// The work of camber compensate, for whoever makes its predictions in a way of its own.
#include "camber/compensate.h"
#include "simulate/predict_path.h"

namespace camber::api {

/// Does what camber::compensate does, with the predictions of `predictor`: ranks of MPI share them.
CompensateResult compensate(const Job& given, const CompensateOptions& options, const RunOptions& run_options,
                            const simulate::Predictor& predictor);

}  // namespace camber::api
