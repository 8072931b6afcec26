#pragma once
// The server of camber ui: HTTP on the loopback address, for one user.
#include <cstdint>
#include <functional>
#include <string>

namespace camber::ui {

struct ServerOptions {
  std::string folder = ".";
  std::string address = "127.0.0.1";  ///< that it listens on
  int port = 0;                       ///< 0: one that is free
  std::string executable{};           ///< executable of the commands: this one
  std::uint64_t max_upload_bytes = std::uint64_t{1} << 29;
  /// Called with the address of the page, token included, once the server listens.
  std::function<void(const std::string& url)> ready{};
};

/// Serves until SIGINT, SIGTERM or SIGHUP; runs that go on are stopped then. Requests that the guard (ui/guard.h)
/// refuses reach nothing else. Throws InputError where there is no such folder; [address] where the address or the port
/// cannot be listened on.
void serve(const ServerOptions& options);

}  // namespace camber::ui
