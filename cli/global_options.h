#pragma once
// Options that every subcommand takes, and the exit status of the program.
#include <optional>
#include <string>

namespace camber::cli {

enum ExitCode {
  kDone = 0,
  kInputWrong = 1,
  kCommandLineWrong = 2,
  kNumbersDidNotWorkOut = 3,  ///< done as far as possible; a sentence says what is missing
};

struct GlobalOptions {
  bool strict = false;            ///< warnings become errors
  bool quiet = false;             ///< only errors are printed
  int verbosity = 0;              ///< number of -v
  int threads = 0;                ///< 0: as many as the computer has
  bool events = false;            ///< diagnostics, errors and progress as lines of JSON on stderr
  std::string only_in{};          ///< the only folder in which files are read and written; empty: anywhere
  bool effective_config = false;  ///< print the configuration with every default filled in, and stop
};

}  // namespace camber::cli
