#include "cli/command_line.h"

#include <exception>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include "base/output_file.h"
#include "cli/console.h"

namespace camber::cli {
namespace {

constexpr const char* kDescription =
    "Camber predicts the cutter deflection along an NC program and shifts the path to compensate it.";
constexpr const char* kExitStatus =
    "Exit status: 0 success; 1 the input is wrong; 2 the command line is wrong; 3 finished, but the numbers did not "
    "work out.";
constexpr int kMaxThreads = 1024;

void add_global_options(CLI::App& app, GlobalOptions& options) {
  app.set_version_flag("--version", std::string("camber ") + CAMBER_VERSION);
  app.add_flag("--strict", options.strict, "warnings become errors");
  auto* quiet = app.add_flag("-q,--quiet", options.quiet, "print errors only");
  app.add_flag("-v,--verbose", options.verbosity, "verbose; twice: more verbose")->excludes(quiet);
  app.add_option("--threads", options.threads, "number of threads; 0: all processors")
      ->check(CLI::Range(0, kMaxThreads))
      ->type_name("N");
  app.add_flag("--effective-config", options.effective_config,
               "print the job and the machine with all defaults filled in, and exit");
}

/// Limits the threads for as long as it lives.
std::unique_ptr<tbb::global_control> thread_limit(int threads) {
  if (threads <= 0) return nullptr;
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
}

int guarded(const Action& action, const GlobalOptions& options) {
  try {
    return action();
  } catch (const InputError& problem) {
    print_diagnostics(problem.diagnostics(), options);
  } catch (const std::bad_alloc&) {
    print_error("not enough memory; a larger voxel_mm, a smaller stock or fewer threads need less [memory]");
  } catch (const std::exception& problem) {
    print_error(fmt::format("internal error: {}; please report it with the files [internal]", problem.what()));
  }
  return kInputWrong;
}

}  // namespace

int run(int argc, const char* const* argv) {
  CLI::App app(kDescription, "camber");
  app.footer(kExitStatus);
  app.require_subcommand(1);
  app.fallthrough();
  GlobalOptions options;
  Action chosen;
  add_global_options(app, options);
  add_program_commands(app, options, chosen);
  add_init_command(app, options, chosen);
  add_job_commands(app, options, chosen);
  add_force_commands(app, options, chosen);
  add_help(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return app.exit(problem) == 0 ? kDone : kCommandLineWrong;
  }
  remove_parts_on_signals();
  const auto limit = thread_limit(options.threads);
  return guarded(chosen, options);
}

}  // namespace camber::cli
