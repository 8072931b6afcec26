#pragma once
// camber copy J.toml -o OUT.nc [--stream S.csv] [--stock OUT.vdb] [--log LOG.csv] [--hardness REGIONS.csv] [--report
// R.html]
// [--json R.json]
#include <optional>
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct CopyArguments {
  std::string job;
  std::string output;
  std::string stream;    ///< empty: none
  std::string stock;     ///< empty: none
  std::string json;      ///< empty: none
  std::string log;       ///< changes of feed and depths; empty: none
  std::string report;    ///< empty: none
  std::string hardness;  ///< parts of the material that are harder; empty: none
  std::optional<double> stop_after_s{};
};

/// Throws InputError. Returns kDone.
int run_copy(const CopyArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
