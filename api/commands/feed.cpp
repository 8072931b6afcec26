#include "api/commands/feed.h"

#include <nlohmann/json.hpp>

#include "feedmodel/control_options.h"
#include "feedmodel/feed_csv.h"
#include "feedmodel/fitted_range.h"
#include "simulate/machine_checks.h"

namespace camber::api {

nc::Interpretation moves_of_feed(const nc::Program& text, const machine::Machine& machine,
                                 const nc::InterpreterOptions& options, const std::string& csv,
                                 Diagnostics& diagnostics) {
  nc::Interpretation moves = nc::interpret(text, feedmodel::interpreter_options(machine, options), diagnostics);
  diagnostics.throw_if_errors();
  simulate::check_machine(machine, text, moves, diagnostics);
  simulate::check_spindle(text, moves, diagnostics);
  if (!csv.empty()) feedmodel::check_feed_csv_size(moves, machine, csv, diagnostics);
  feedmodel::check_range(moves, text.source.name(), machine, diagnostics);
  return moves;
}

std::string feed_json(const feedmodel::FeedSummary& summary) {
  const nlohmann::ordered_json report = {
      {"time_s", summary.time_s}, {"cutting_time_s", summary.cutting_time_s}, {"blocks", summary.blocks}};
  return report.dump(2) + "\n";
}

}  // namespace camber::api
