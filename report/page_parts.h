#pragma once
// The fixed parts of the report page.
#include <string_view>

namespace camber::report {

extern const std::string_view kPageStyle;   ///< CSS
extern const std::string_view kMapScript;   ///< JavaScript: the form-error map, drawn point by point
extern const std::string_view kPlotScript;  ///< JavaScript: histogram and feed along time
extern const std::string_view kPageScript;  ///< JavaScript: reads the data and starts the views

}  // namespace camber::report
