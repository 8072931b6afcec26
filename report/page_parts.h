#pragma once
// The fixed parts of the pages.
#include <string_view>

namespace camber::report {

extern const std::string_view kPageStyle;   ///< CSS of every page
extern const std::string_view kPagePolicy;  ///< nothing is fetched from anywhere: the browser itself refuses

/// The script of the report page and the style of its pictures: report/web, bundled while Camber is built.
extern const std::string_view kReportScript;
extern const std::string_view kReportStyle;
extern const std::string_view kPathScript;     ///< of the page of compress and resegment
extern const std::string_view kMachineScript;  ///< of the page of a machine with rotary axes

}  // namespace camber::report
