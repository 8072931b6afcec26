#include "ui/runs.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace camber::ui {
namespace {

constexpr int kPoll_ms = 200;

/// In the child: nothing but system calls until the other program begins.
[[noreturn]] void become(char* const* arguments, const char* folder, int errors, pid_t parent) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(number, SIG_DFL);
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (getppid() != parent || nothing < 0 || chdir(folder) != 0) _exit(127);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  execv(arguments[0], arguments);
  _exit(127);
}

std::vector<char*> pointers(const std::vector<std::string>& arguments) {
  std::vector<char*> out;
  for (const std::string& one : arguments) out.push_back(const_cast<char*>(one.c_str()));
  out.push_back(nullptr);
  return out;
}

/// Gives whole lines to `line` and keeps the rest.
void take_lines(std::string& text, const std::function<void(std::string_view)>& line) {
  std::size_t from = 0;
  for (std::size_t end; (end = text.find('\n', from)) != std::string::npos; from = end + 1)
    line(std::string_view(text).substr(from, end - from));
  text.erase(0, from);
}

}  // namespace

Process::Process(const std::vector<std::string>& arguments, const std::string& folder) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const std::vector<char*> list = pointers(arguments);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) become(list.data(), folder.c_str(), ends[1], parent);
  const int reason = errno;
  close(ends[1]);
  errors_ = ends[0];
  if (pid_ > 0) return;
  close(errors_);
  throw std::runtime_error(std::string("no process could be started: ") + std::strerror(reason));
}

Process::~Process() {
  if (!ended_) {
    stop();
    wait([](std::string_view) {});
  }
  close(errors_);
}

void Process::signal(int number) {
  const std::lock_guard lock(mutex_);
  if (!ended_) kill(-pid_, number) == 0 || kill(pid_, number);
}

void Process::stop() {
  stopped_ = true;
  signal(SIGTERM);
}

Ended Process::wait(const std::function<void(std::string_view)>& line) {
  using Clock = std::chrono::steady_clock;
  std::string text;
  char buffer[1 << 14];
  for (Clock::time_point asked{};;) {
    if (stopped_ && asked == Clock::time_point{}) asked = Clock::now();
    if (asked != Clock::time_point{} && Clock::now() - asked > kPatience) signal(SIGKILL);
    pollfd waiting{errors_, POLLIN, 0};
    if (poll(&waiting, 1, kPoll_ms) <= 0) continue;
    const ssize_t n = read(errors_, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    text.append(buffer, static_cast<std::size_t>(n));
    take_lines(text, line);
  }
  if (!text.empty()) line(text);
  int status = 0;
  while (waitid(P_PID, static_cast<id_t>(pid_), nullptr, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  const std::lock_guard lock(mutex_);
  waitpid(pid_, &status, 0);
  ended_ = true;
  if (WIFSIGNALED(status)) return {-1, WTERMSIG(status), stopped_};
  return {WEXITSTATUS(status), 0, stopped_};
}

}  // namespace camber::ui
