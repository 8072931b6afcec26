#pragma once
// The program of one finishing operation, moved against its predicted form error.
#include <string>

#include "machine/job_file.h"

namespace camber::plan {

struct CompensatedProgram {
  std::string text;  ///< the given one where compensation is of no use
  std::string note;  ///< form error before and after, or why it stays as it is
};

/// `stock_vdb`: what stands before the operation. The part's mesh is the target. Throws Cancelled.
CompensatedProgram compensated(const machine::Job& job, const std::string& stock_vdb, const std::string& text);

}  // namespace camber::plan
