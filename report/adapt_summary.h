#pragma once
// The figures of camber adapt: JSON, text for a terminal, and the page.
#include <string>

#include "adapt/adaptation.h"
#include "machine/adapt_settings.h"

namespace camber::report {

std::string adapt_json(const adapt::AdaptResult& result, const machine::AdaptSettings& asked, double compute_s);

/// The same for a terminal, within 100 columns.
std::string adapt_text(const adapt::AdaptResult& result, double compute_s);

/// Why the program is not within its limits or its time; empty: it is.
std::vector<std::string> adapt_failures(const adapt::AdaptResult& result);

/// "1.44 at S9000 in line 8 to 0.78 at S8270": the margin of chatter before and after.
std::string speed_change_text(const adapt::SpeedChange& change);

/// Files that the page names.
struct AdaptFiles {
  std::string job, program, output;
};
/// The page's text, UTF-8, self-contained. The same data give the same bytes. Does not throw.
std::string adapt_page(const adapt::AdaptResult& result, const machine::AdaptSettings& asked, const AdaptFiles& files,
                       const std::vector<std::string>& warnings);

}  // namespace camber::report
