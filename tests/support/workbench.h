#pragma once
// Starts camber ui as a user would, and asks its server over a socket, byte for byte.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "test_paths.h"
#include "tests/support/temp_folder.h"

namespace camber::tests {

struct Answer {
  int status = 0;    ///< 0: the connection ended without one
  std::string head;  ///< header lines
  std::string body;
  nlohmann::json json() const { return nlohmann::json::parse(body); }
};

/// Headers in place of those that a browser would send; an empty text leaves one out.
using Headers = std::multimap<std::string, std::string>;

class Workbench {
 public:
  explicit Workbench(const TempFolder& folder, const std::string& options = "", const std::string& served = ".") {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("pipe");
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      close(ends[0]);
      close(ends[1]);
      const std::string command =
          "cd '" + folder.path() + "' && exec '" CAMBER_EXECUTABLE "' ui --no-open " + options + " '" + served + "'";
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    close(ends[1]);
    out_ = ends[0];
    for (char c; read(out_, &c, 1) == 1 && c != '\n';) url_ += c;
    const auto colon = url_.rfind(':'), slash = url_.find('/', colon), equals = url_.find('=');
    if (equals == std::string::npos) throw std::runtime_error("camber ui has printed \"" + url_ + "\"");
    port_ = std::stoi(url_.substr(colon + 1, slash - colon - 1));
    token_ = url_.substr(equals + 1);
  }
  ~Workbench() {
    if (pid_ > 0) end(SIGKILL);
    close(out_);
  }
  Workbench(const Workbench&) = delete;
  Workbench& operator=(const Workbench&) = delete;

  const std::string& url() const { return url_; }
  const std::string& token() const { return token_; }
  int port() const { return port_; }
  std::string cookie() const { return "camber_" + std::to_string(port_) + "=" + token_; }

  /// Ends it and returns the rest of its standard output; kills it where it has not ended after 30 s.
  std::string end(int signal, int* status = nullptr) {
    kill(pid_, signal);
    std::string rest;
    char buffer[4096];
    pollfd end_of_file{out_, POLLIN, 0};
    if (poll(&end_of_file, 1, 30'000) == 0) kill(pid_, SIGKILL);
    for (ssize_t n; (n = read(out_, buffer, sizeof buffer)) > 0;) rest.append(buffer, static_cast<std::size_t>(n));
    int result = 0;
    waitpid(pid_, &result, 0);
    if (status) *status = WIFEXITED(result) ? WEXITSTATUS(result) : -1;
    pid_ = -1;
    return rest;
  }
  bool goes_on() const { return waitpid(pid_, nullptr, WNOHANG) == 0; }

  /// Request of a browser that has the cookie; `other` replaces headers.
  Answer ask(const std::string& method, const std::string& target, const std::string& body = "",
             const Headers& other = {}) const {
    Headers headers{{"Host", "127.0.0.1:" + std::to_string(port_)}, {"Cookie", cookie()}};
    if (method != "GET") headers.emplace("Content-Length", std::to_string(body.size()));
    for (const auto& [name, value] : other) headers.erase(name);
    headers.insert(other.begin(), other.end());
    std::string text = method + " " + target + " HTTP/1.1\r\n";
    for (const auto& [name, value] : headers)
      if (!value.empty()) text += name + ": " + value + "\r\n";
    return exchange(text + "\r\n" + body);
  }
  Answer get(const std::string& target, const Headers& other = {}) const { return ask("GET", target, "", other); }
  Answer post(const std::string& target, const std::string& body = "", const Headers& other = {}) const {
    return ask("POST", target, body, other);
  }

  /// Waits until a run has ended, at most a minute.
  nlohmann::json ended(int run) const {
    return waited(run, [](const auto& r) { return r["ended"] != 0 || r["state"] == "cancelled"; });
  }
  template <class Until>
  nlohmann::json waited(int run, Until until) const {
    for (int i = 0; i < 1200; ++i, std::this_thread::sleep_for(std::chrono::milliseconds(50)))
      if (nlohmann::json r = get("/api/runs/" + std::to_string(run)).json(); until(r)) return r;
    throw std::runtime_error("the run does not end");
  }

  /// Sends these bytes and reads until the server closes.
  Answer exchange(const std::string& text) const {
    const int s = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    std::string all;
    if (connect(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t n = send(s, text.data() + sent, text.size() - sent, MSG_NOSIGNAL);
        if (n <= 0) break;
        sent += static_cast<std::size_t>(n);
      }
      char buffer[65536];
      for (ssize_t n; (n = recv(s, buffer, sizeof buffer, 0)) > 0;) all.append(buffer, static_cast<std::size_t>(n));
    }
    close(s);
    const std::size_t end = all.find("\r\n\r\n");
    if (end == std::string::npos) return {};
    return {std::atoi(all.c_str() + all.find(' ')), all.substr(0, end), all.substr(end + 4)};
  }

 private:
  pid_t pid_ = -1;
  int out_ = -1, port_ = 0;
  std::string url_, token_;
};

}  // namespace camber::tests
