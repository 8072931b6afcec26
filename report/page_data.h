#pragma once
// The numbers behind the page's pictures, packed for its script.
#include <string>

#include "report/html_report.h"

namespace camber::report {

/// Contents of the script element, and notes on data that were left out.
struct PageData {
  std::string index;                  ///< JSON: what lies where in `arrays`, scales, names
  std::string arrays;                 ///< base64, see PackedArrays
  std::vector<std::string> programs;  ///< a run's text each, deflated, as base64; empty: left out
  std::vector<std::string> left_out;  ///< sentences
  double scale_um = 1;                ///< half of the colour scale before
  double scale_after_um = 1;          ///< and after
};

PageData page_data(const ReportData& data, const ReportOptions& options);

}  // namespace camber::report
