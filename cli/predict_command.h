#pragma once
// camber predict J.toml -o DIR [--json R.json] [--forces-at LINE] [--trace T.csv [--columns MAP.toml]]
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct PredictArguments {
  std::string job;
  std::string output_folder;
  std::string json;           ///< empty: only summary.json in the folder
  std::size_t forces_at = 0;  ///< line whose forces are written over one turn; 0: none
  std::string trace;          ///< servo trace at whose positions is cut; empty: none
  std::string columns;        ///< column map of the trace; empty: none
  bool meshes = false;        ///< machined.stl, machined.ply and form_error_mesh.ply
  bool explain = false;       ///< how uncertain the margins of chatter are
};

/// Writes feed.csv, forces.csv, spindle_load.csv, form_error.csv, form_error.vtp, stock.vdb, report.html and
/// summary.json, and forces_at_LINE.csv and meshes where asked. Throws InputError. Returns kDone or
/// kNumbersDidNotWorkOut.
int run_predict(const PredictArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
