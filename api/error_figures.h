#pragma once
// Figures of an error as the library hands them out.
#include "camber/predict.h"
#include "removal/form_error.h"

namespace camber::api {

inline ErrorFigures figures_of(const removal::ErrorFigures& f) {
  return {f.min, f.max, f.mean, f.rms, f.p95, f.area_mm2};
}

}  // namespace camber::api
