#pragma once
// The figures of camber copy: JSON and text for a terminal.
#include <string>
#include <vector>

#include "copymill/copy_milling.h"

namespace camber::report {

std::string copy_json(const copymill::CopyResult& result, double compute_s);

/// The changes of feed and depths, a row each, in order of time.
std::string copy_log_csv(const copymill::CopyResult& result);

/// The same for a terminal, within 100 columns.
std::string copy_text(const copymill::CopyResult& result, double compute_s);

}  // namespace camber::report
