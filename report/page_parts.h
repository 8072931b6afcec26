#pragma once
// The fixed parts of the pages.
#include <string_view>

namespace camber::report {

extern const std::string_view kPageStyle;   ///< CSS of every page
extern const std::string_view kPagePolicy;  ///< nothing is fetched from anywhere: the browser itself refuses

// report/web, bundled (report/web/bundle).
std::string_view report_script();   ///< script of the report page
std::string_view report_style();    ///< style of its pictures
std::string_view path_script();     ///< script of the page of compress and resegment
std::string_view machine_script();  ///< script of the page of a machine with rotary axes

}  // namespace camber::report
