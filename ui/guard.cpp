#include "ui/server.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>
#include <sys/random.h>

namespace camber::ui {
namespace {

/// Without the port; nothing where what follows the name is none.
std::optional<std::string> name_of(std::string_view host) {
  const std::size_t from = host.starts_with('[') ? host.find(']') : 0;
  if (from == std::string_view::npos) return std::nullopt;
  const std::size_t colon = host.find(':', from);
  std::string name(host.substr(0, colon));
  if (colon != std::string_view::npos) {
    const std::string_view port = host.substr(colon + 1);
    if (port.empty() || port.size() > 5 || !std::ranges::all_of(port, [](char c) { return c >= '0' && c <= '9'; }))
      return std::nullopt;
  }
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name;
}

bool is_own_origin(std::string_view origin, std::string_view address) {
  constexpr std::string_view kScheme = "http://";
  return origin.starts_with(kScheme) && is_own_host(origin.substr(kScheme.size()), address);
}

std::optional<RequestRefusal> refused_body(const RequestGuard& guard, const Asked& asked) {
  if (!asked.has_body) return std::nullopt;
  if (asked.lengths.size() != 1) return RequestRefusal{411, "a Content-Length was expected"};
  const std::string& text = asked.lengths.front();
  std::uint64_t bytes = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bytes);
  if (text.empty() || end != text.data() + text.size() || error == std::errc::invalid_argument)
    return RequestRefusal{400, "Content-Length is not a number of bytes"};
  if (error == std::errc() && bytes <= guard.max_upload_bytes) return std::nullopt;
  return RequestRefusal{413, fmt::format("{} bytes; at most {} are taken", text, guard.max_upload_bytes)};
}

}  // namespace

bool is_own_host(std::string_view host, std::string_view address) {
  const auto name = name_of(host);
  if (!name) return false;
  return *name == "localhost" || *name == "127.0.0.1" || *name == "[::1]" || *name == host_text(std::string(address));
}

std::string_view cookie(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = std::min(cookies.find(';'), cookies.size());
    std::string_view one = cookies.substr(0, end);
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    if (one.starts_with(name) && one.size() > name.size() && one[name.size()] == '=')
      return one.substr(name.size() + 1);
    cookies.remove_prefix(std::min(end + 1, cookies.size()));
  }
  return {};
}

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size() || a.empty()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different |= static_cast<unsigned char>(a[i] ^ b[i]);
  return different == 0;
}

std::optional<RequestRefusal> refusal(const RequestGuard& guard, const Asked& asked) {
  if (asked.hosts.size() != 1 || !is_own_host(asked.hosts.front(), guard.address))
    return RequestRefusal{403, "this host is not served"};
  for (const std::string& origin : asked.origins)
    if (!is_own_origin(origin, guard.address)) return RequestRefusal{403, "a page of another site asks"};
  if (!same_secret(asked.token, guard.token) && !same_secret(cookie(asked.cookies, guard.cookie_name), guard.token))
    return RequestRefusal{403, "the token is missing: open the address that camber ui has printed"};
  return refused_body(guard, asked);
}

std::string new_token() {
  std::array<unsigned char, 32> bytes;
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the system has no random numbers");
  std::string out;
  for (const unsigned char b : bytes) out += fmt::format("{:02x}", b);
  return out;
}

std::string host_text(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

}  // namespace camber::ui
