#pragma once
// The server of camber ui: HTTP on the loopback address, for one user.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// Serves until SIGINT, SIGTERM or SIGHUP; runs that go on are stopped then. Requests that the guard (ui/guard)
/// refuses reach nothing else. Throws InputError where there is no such folder; [address] where the address or the port
/// cannot be listened on.
void serve(const ServerOptions& options);

// Who may ask the server of camber ui for something: whoever holds the token, from a page of the server itself.

struct RequestGuard {
  std::string token;        ///< hexadecimal; whoever has it is the user
  std::string cookie_name;  ///< name of the cookie that carries it; with the port, for cookies do not tell ports apart
  std::string address;      ///< that the server listens on
  std::uint64_t max_upload_bytes = 0;
};

/// Parts of a request that the guard examines.
struct Asked {
  std::vector<std::string> hosts;    ///< every Host header
  std::vector<std::string> origins;  ///< every Origin header
  std::string token;                 ///< parameter of the address; empty: none
  std::string cookies;               ///< the Cookie header
  bool has_body = false;             ///< its method brings one
  std::vector<std::string> lengths;  ///< every Content-Length header
};

struct RequestRefusal {
  int status = 403;
  std::string why;
};

/// Nothing: the request may go on. In this order:
/// - Host is one header and names localhost, 127.0.0.1, [::1] or the address that the server was given, with any port
///   (an SSH tunnel has another one). A name that somebody else's DNS leads here is refused.
/// - Origin, where it is sent, is http:// and such a host. Posts of other sites are refused.
/// - The token is in the address or in the cookie.
/// - A body says its length, which is at most max_upload_bytes: 413.
std::optional<RequestRefusal> refusal(const RequestGuard& guard, const Asked& asked);

/// "localhost:8080", "[::1]:80", "127.0.0.1", or `address`.
bool is_own_host(std::string_view host, std::string_view address);

/// The value of a cookie; empty: it is not there.
std::string_view cookie(std::string_view cookies, std::string_view name);

/// Whether both are equal, in a time that does not depend on where they differ. Two empty texts are not.
bool same_secret(std::string_view a, std::string_view b);

/// 256 bits of the system's random numbers, hexadecimal. Throws std::runtime_error where it has none.
std::string new_token();

/// The host as part of an address: an IPv6 address has brackets.
std::string host_text(const std::string& address);

// The page of camber ui, as it lies in ui/page.

std::string_view page_html();
std::string_view page_script();  ///< ui/page/bundle, made by scripts/bundle-page
std::string_view page_style();

}  // namespace camber::ui
