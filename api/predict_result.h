#pragma once
// A prediction as the library returns it.
#include "api/commands/predict.h"
#include "camber/predict.h"

namespace camber::api {

/// All but feed, json and diagnostics.
PredictResult result_of(const machine::Job& job, const PreparedJob& prepared, const simulate::Prediction& prediction);

}  // namespace camber::api
