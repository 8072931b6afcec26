#pragma once
// The options of camber resegment --part on the command line.
#include <memory>

#include "cli/command_line.h"
#include "cli/raster_command.h"
#include "cli/resegment_command.h"

namespace CLI {
class Option;
}

namespace camber::cli {

class RasterOptions {
 public:
  /// To be called when the command has the options of reading programs.
  RasterOptions(CLI::App& command, CLI::Option& program);
  /// --job or --part was given.
  bool asked_for() const;
  /// `shared`: the options that both kinds of resegment have. Throws CLI::RequiredError.
  Action action(const ResegmentArguments& shared, const GlobalOptions& options) const;

 private:
  RasterArguments arguments_;
  CLI::Option *part_, *job_;
  std::vector<CLI::Option*> required_;
};

std::shared_ptr<RasterOptions> add_raster_options(CLI::App& command, CLI::Option& program);

}  // namespace camber::cli
