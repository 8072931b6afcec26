#pragma once
// camber ui [FOLDER] [--port N] [--address A] [--no-open]
#include <string>

#include "cli/global_options.h"

namespace camber::cli {

struct UiArguments {
  std::string folder = ".";
  std::string address = "127.0.0.1";
  int port = 0;          ///< 0: one that is free
  bool no_open = false;  ///< no browser is started
  double max_upload_MB = 512;
};

/// Serves until a signal ends it. The address of the page, token included, is the only line on standard output. Throws
/// InputError. Returns kDone.
int run_ui(const UiArguments& arguments, const GlobalOptions& options);

}  // namespace camber::cli
