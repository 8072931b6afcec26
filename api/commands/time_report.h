#pragma once
// What camber time prints and writes.
#include <optional>
#include <string>
#include <vector>

#include "calib/cycle_accuracy.h"
#include "report/cycle_page.h"

namespace camber::api {

struct TimeReport {
  std::string program, machine;
  std::vector<std::string> keys{};       ///< swept
  std::vector<report::CycleRow> rows{};  ///< one, or one a case or point
  std::optional<calib::CycleAccuracy> accuracy{};
  std::vector<std::string> notes{};
};

std::string time_text(const TimeReport& report);

/// The same figures as JSON text, with a line end. Of the first row at the top; all rows in `sweep` or `cases`.
std::string time_json(const TimeReport& report);

}  // namespace camber::api
