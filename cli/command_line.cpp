#include "cli/command_line.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include "base/folders.h"
#include "base/output_file.h"
#include "cli/console.h"
#include "cli/mpi_run.h"
#include "machine/toml_table.h"

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
  app.add_flag("--events", options.events,
               "messages and progress as lines of JSON on stderr, for programs that run this one");
  app.add_option("--only-in", options.only_in, "read and write files in this folder alone")
      ->check(CLI::ExistingDirectory.description(""))
      ->type_name("DIR");
  app.add_flag("--effective-config", options.effective_config,
               "print the job and the machine with all defaults filled in, and exit");
}

/// Limits the threads for as long as it lives.
std::unique_ptr<tbb::global_control> thread_limit(int threads) {
  if (threads <= 0) return nullptr;
  return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                               static_cast<std::size_t>(threads));
}

/// True where everything printed so far has gone out.
bool standard_output_stands() { return std::fflush(stdout) == 0 && std::ferror(stdout) == 0; }

int refuse_standard_output() {
  print_error("standard output cannot be written to its end (is the disk full?) [file-unwritable]");
  return kInputWrong;
}

/// A thread, a folder, an address. oneTBB says by words alone that it got no thread.
bool refused_by_system(const std::exception& problem) {
  return dynamic_cast<const std::system_error*>(&problem) || std::string_view(problem.what()).starts_with("pthread_");
}

int guarded(const Action& action, const GlobalOptions& options) {
  try {
    return action();
  } catch (const InputError& problem) {
    print_diagnostics(problem.diagnostics(), options);
  } catch (const BeyondModel& beyond) {
    print_error(beyond.what());
    return kNumbersDidNotWorkOut;
  } catch (const std::bad_alloc&) {
    print_error("not enough memory; a larger voxel_mm, a smaller stock or fewer threads need less [memory]");
  } catch (const std::exception& problem) {
    if (!standard_output_stands()) return refuse_standard_output();
    if (refused_by_system(problem))
      print_error(fmt::format("the system refused: {} [system]", problem.what()));
    else
      print_error(fmt::format("internal error: {}; please report it with the files [internal]", problem.what()));
  }
  return kInputWrong;
}

/// Returns the offered word that was most likely meant; empty where none is near.
std::string meant(const std::string& word, const CLI::App& app) {
  std::vector<std::string> offered;
  if (word.rfind("--", 0) != 0) {
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
      offered.push_back(command->get_name());
    return machine::nearest_word(word, offered);
  }
  std::vector<const CLI::App*> asked{&app};
  for (const CLI::App* command : app.get_subcommands()) asked.push_back(command);
  for (const CLI::App* one : asked)
    for (const CLI::Option* option : one->get_options())
      for (const std::string& name : option->get_lnames()) offered.push_back("--" + name);
  return machine::nearest_word(word.substr(0, word.find('=')), offered);
}

/// The words that nothing takes, with the nearest ones that something would.
int refuse(const CLI::App& app, const CLI::ParseError& problem, int argc, const char* const* argv) {
  std::vector<std::string> unknown = app.remaining(true);
  const auto commands = app.get_subcommands();
  const bool extras = dynamic_cast<const CLI::ExtrasError*>(&problem) != nullptr;
  if (unknown.empty() && commands.empty() && dynamic_cast<const CLI::RequiredError*>(&problem))
    for (int i = 1; i < argc && unknown.empty(); ++i)
      if (argv[i][0] != '-') unknown.emplace_back(argv[i]);
  if (unknown.empty() || (!extras && !commands.empty())) return app.exit(problem);
  const auto first =
      std::ranges::find_if(unknown, [&](const std::string& w) { return (w.rfind("-", 0) == 0) == !commands.empty(); });
  const std::string& word = first != unknown.end() ? *first : unknown.back();
  const std::string near = meant(word, app);
  const bool option = word.rfind("-", 0) == 0;
  const std::string of = commands.empty() ? "" : " of " + commands.front()->get_name();
  fmt::print(stderr, "camber: there is no {} {}{}{}\nRun with --help for more information.\n",
             option             ? "option"
             : commands.empty() ? "command"
                                : "further word",
             word, option ? of : "", near.empty() ? "" : fmt::format("; did you mean {}?", near));
  return kCommandLineWrong;
}

bool json_to_standard_output(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    if (const CLI::Option* json = command->get_option_no_throw("--json"); json && !json->empty())
      return json->results().front() == "-";
  return false;
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
  add_check_command(app, options, chosen);
  add_feed_command(app, options, chosen);
  add_time_command(app, options, chosen);
  add_fit_feed_command(app, options, chosen);
  add_protocol_command(app, options, chosen);
  add_compress_command(app, options, chosen);
  add_resegment_command(app, options, chosen);
  add_post_command(app, options, chosen);
  add_posture_command(app, options, chosen);
  add_init_command(app, options, chosen);
  add_predict_command(app, options, chosen);
  add_compensate_command(app, options, chosen);
  add_adapt_command(app, options, chosen);
  add_study_command(app, options, chosen);
  add_merge_command(app, options, chosen);
  add_copy_command(app, options, chosen);
  add_plan_command(app, options, chosen);
  add_fit_parts_command(app, options, chosen);
  add_fit_force_command(app, options, chosen);
  add_lobes_command(app, options, chosen);
  add_fit_modes_command(app, options, chosen);
  add_ui_command(app, options, chosen);
  add_help(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    if (problem.get_exit_code() == 0) return app.exit(problem), kDone;
    return refuse(app, problem, argc, argv) == 0 ? kDone : kCommandLineWrong;
  }
  const std::string& name = app.get_subcommands().front()->get_name();
  if (name != "predict" && name != "compensate" && started_by_mpi()) {
    print_error(fmt::format("under mpirun predict and compensate share their work; {} runs without it", name));
    return kCommandLineWrong;
  }
  if (json_to_standard_output(app)) claim_standard_output();
  remove_parts_on_signals();
  if (options.events) write_events();
  const auto limit = thread_limit(options.threads);
  const auto confined = [&] {
    if (!options.only_in.empty()) confine_files(options.only_in);
    return chosen();
  };
  const int status = guarded(confined, options);
  remove_empty_folders();
  return status == kDone && !standard_output_stands() ? refuse_standard_output() : status;
}

}  // namespace camber::cli
