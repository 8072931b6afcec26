#pragma once
// What a page shows of chatter: a table of the operations, and the lobes of those that are nearest to it.
#include "machine/job_file.h"
#include "report/html_report.h"
#include "simulate/predict_path.h"

namespace camber::report {

void add_chatter(ReportData& data, const machine::Job& job, const simulate::ChatterMargins& margins);

/// Lines for the terminal: each operation with a margin above 1, or else the greatest margin. Empty: nothing is milled.
std::string chatter_text(const simulate::ChatterMargins& margins);

/// For predict --explain: the worst cut of each operation, the modes, and what their errors do to its margin.
std::string chatter_explanation(const machine::Job& job, const simulate::ChatterMargins& margins);

}  // namespace camber::report
