#include "cli/ui_command.h"

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include "base/folders.h"
#include "cli/command_line.h"
#include "cli/console.h"
#include "ui/server.h"

namespace camber::cli {
namespace {

namespace fs = std::filesystem;

/// A file that leads to the page, for its owner's eyes alone: the token in the browser's command line could be read by
/// every user of the machine. It goes with the server.
class Doorway {
 public:
  Doorway(const std::string& folder, const std::string& url) : path_(fs::absolute(folder) / "open-camber-ui.html") {
    unlink(path_.c_str());
    const int file = open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0) return;
    const std::string page = fmt::format(
        "<!DOCTYPE html><meta charset=\"utf-8\"><meta name=\"referrer\" content=\"no-referrer\">"
        "<meta http-equiv=\"refresh\" content=\"0; url={0}\"><a href=\"{0}\">Camber</a>\n",
        url);
    written_ = write(file, page.data(), page.size()) == static_cast<ssize_t>(page.size());
    close(file);
  }
  ~Doorway() { unlink(path_.c_str()); }
  Doorway(const Doorway&) = delete;
  Doorway& operator=(const Doorway&) = delete;

  bool open_browser() const {
    if (!written_) return false;
    const char* command[] = {"xdg-open", path_.c_str(), nullptr};
    pid_t browser = 0;
    if (posix_spawnp(&browser, command[0], nullptr, nullptr, const_cast<char* const*>(command), environ) != 0)
      return false;
    std::thread([browser] { waitpid(browser, nullptr, 0); }).detach();
    return true;
  }

 private:
  const fs::path path_;
  bool written_ = false;
};

bool has_screen() { return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr; }

}  // namespace

int run_ui(const UiArguments& arguments, const GlobalOptions& options) {
  std::unique_ptr<Doorway> doorway;
  ui::ServerOptions server;
  server.folder = arguments.folder;
  server.address = arguments.address;
  server.port = arguments.port;
  server.executable = fs::read_symlink("/proc/self/exe").string();
  server.max_upload_bytes = static_cast<std::uint64_t>(arguments.max_upload_MB * 1e6);
  server.ready = [&](const std::string& url) {
    fmt::print("{}\n", url);
    std::fflush(stdout);
    if (arguments.no_open || !has_screen()) return;
    doorway = std::make_unique<Doorway>(arguments.folder, url);
    if (!doorway->open_browser() && !options.quiet)
      fmt::print(stderr, "camber: no browser could be started (xdg-open); open the address above\n");
  };
  ui::serve(server);
  return kDone;
}

void add_ui_command(CLI::App& app, const GlobalOptions& options, Action& chosen) {
  auto* command = app.add_subcommand("ui", "a workbench in the browser for the jobs of a folder");
  auto arguments = std::make_shared<UiArguments>();
  command->add_option("folder", arguments->folder, "folder of the jobs; default: this one")
      ->check(CLI::ExistingDirectory.description(""))
      ->type_name("FOLDER");
  command->add_option("--port", arguments->port, "port to listen on; default: one that is free")
      ->check(CLI::Range(1, 65535))
      ->type_name("N");
  command
      ->add_option("--address", arguments->address,
                   "address to listen on, as browsers name it; default 127.0.0.1: this machine alone")
      ->type_name("A");
  command->add_flag("--no-open", arguments->no_open, "start no browser");
  command->add_option("--max-upload-mb", arguments->max_upload_MB, "largest file that the page may send; default 512")
      ->check(CLI::Range(0.001, 1e5))
      ->type_name("MB");
  command->callback(
      [arguments, &options, &chosen] { chosen = [arguments, &options] { return run_ui(*arguments, options); }; });
}

}  // namespace camber::cli
