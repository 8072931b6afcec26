#pragma once
// camber copy J.toml -o OUT.nc [--stream S.csv] [--stock OUT.vdb] [--json R.json]
#include <optional>
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct CopyArguments {
  std::string job;
  std::string output;
  std::string stream;  ///< empty: none
  std::string stock;   ///< empty: none
  std::string json;    ///< empty: none
  std::optional<double> stop_after_s{};
};

/// Throws InputError. Returns kDone.
int run_copy(const CopyArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
