#pragma once
// The parts of the report page that are plain HTML: figures, rounds, notes and the frames of the pictures.
#include <string>
#include <string_view>
#include <vector>

#include "report/html_report.h"

namespace camber::report {

/// Text with &, <, > and quotes made harmless.
std::string html_text(std::string_view text);

std::string tiles_html(const ReportData& data);
std::string map_html(const ReportData& data, const ReportOptions& options, const std::vector<double>& scales_um);
std::string charts_html(const ReportData& data, const ReportOptions& options);
std::string tables_html(const ReportData& data);

}  // namespace camber::report
