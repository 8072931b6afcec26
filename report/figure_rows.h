#pragma once
// Figures of an error as JSON and as a row of a table, for predict and compensate alike.
#include <string>

#include <fmt/format.h>

#include "base/json.h"
#include "removal/form_error.h"

namespace camber::report {

inline Json figures_json(const removal::ErrorFigures& f) {
  return {{"min", f.min}, {"max", f.max}, {"mean", f.mean}, {"rms", f.rms}, {"p95", f.p95}, {"area_mm2", f.area_mm2}};
}

inline constexpr const char* kFiguresHead = "form error, um     p95      rms     mean      min      max";
inline std::string figures_row(const std::string& name, const removal::ErrorFigures& f) {
  return fmt::format("{:<12}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.2f}", name, f.p95, f.rms, f.mean, f.min, f.max);
}

}  // namespace camber::report
