#pragma once
// The parts of the report page that are plain HTML: they are read without a script, and on paper.
#include <string>
#include <string_view>
#include <vector>

#include "report/html_report.h"

namespace camber::report {

/// Text with &, <, > and quotes made harmless.
std::string html_text(std::string_view text);

/// JSON as a script element may hold it. A "<" stands in strings alone, where its escape means the same: without it
/// neither an end tag nor "<!--<script", which hides the end tag, can come up.
std::string script_safe(const std::string& json);

/// A number of the page: `decimals` behind the point, a true minus sign; a dash where it is not finite.
std::string number_text(double value, int decimals);

/// A page from its first byte to the heading and the line below it.
std::string page_head(std::string_view title, std::string_view subtitle);
std::string tiles_html(const ReportData& data);
std::string figures_html(const ReportData& data);
std::string table_html(const TextTable& table);
/// A card with a list; empty without items.
std::string list_html(const std::string& title, const std::string& css_class, const std::vector<std::string>& items);

}  // namespace camber::report
