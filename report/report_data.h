#pragma once
// From the results of a run to what the page and the exports show.
#include <span>
#include <string>
#include <vector>

#include "base/diagnostics.h"
#include "compensate/compensate_path.h"
#include "removal/stock.h"
#include "report/form_error_files.h"
#include "report/html_report.h"
#include "simulate/predict_path.h"
#include "simulate/traced.h"

namespace camber::report {

/// All must outlive what comes back. `traced`: of a prediction at measured positions.
FormErrorPoints form_error_points(const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                                  const simulate::TracedRun* traced = nullptr);

/// Crossings of the stock that a page draws in grey: about a fifteenth of a megabyte.
constexpr std::size_t kMaxStockCrossings = 12000;

/// Program and prediction must outlive what comes back.
ReportData predict_report(const machine::Job& job, const simulate::SimulatedProgram& program,
                          const simulate::Prediction& prediction, const removal::StockShape& stock,
                          std::vector<PathRow> rows, const Diagnostics& diagnostics);

/// Makes the page of a prediction at measured positions one of two maps, the feed model's and the trace's, and their
/// difference. `model_rows`: along the feed model's motion. All must outlive `data`.
void add_traced(ReportData& data, const simulate::SimulatedProgram& program, const simulate::Prediction& prediction,
                const simulate::TracedRun& traced, std::vector<PathRow> model_rows);

/// One of the two programs of a compensation.
struct CompensatedRun {
  const simulate::SimulatedProgram& program;
  std::vector<PathRow> rows;
  /// One per stamp of `program`; none: the page has no forces of this run.
  std::span<const simulate::StampLoad> loads{};
  std::span<const simulate::ChatterMargins::Passage> chatter{};  ///< the same
};

/// `result` and both programs must outlive what comes back.
/// `output`: where the compensated program was written; the page offers it under that name. `shifted_from`: the moves
/// that the shifts count from, where these are not the given program's (runs that are cut twice).
ReportData compensate_report(const machine::Job& job, const compensate::CompensationResult& result,
                             CompensatedRun before, CompensatedRun after, const std::string& output,
                             const Diagnostics& diagnostics, const nc::Interpretation* shifted_from = nullptr);

/// Points measured on a part, drawn over the map.
void add_measured(ReportData& data, const std::vector<compensate::MeasuredPoint>& points);

}  // namespace camber::report
