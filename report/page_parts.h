#pragma once
// The fixed parts of the pages.
#include <string_view>

namespace camber::report {

extern const std::string_view kPageStyle;  ///< CSS of every page

/// The script of the report page and the style of its pictures: report/web, bundled while Camber is built.
extern const std::string_view kReportScript;
extern const std::string_view kReportStyle;

}  // namespace camber::report
