#include "base/output_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>

#include <unistd.h>

#include "base/diagnostics.h"

namespace camber {

namespace {

/// Names of unfinished parts where a signal handler may read them: fixed memory, no locks.
constexpr int kSlots = 32;
constexpr std::size_t kLongestPath = 4096;
struct Slot {
  std::atomic<int> state{0};  ///< 0: free, 1: being filled, 2: holds a name
  char path[kLongestPath];
};
std::array<Slot, kSlots> slots;

int enter(const std::string& path) {
  if (path.size() + 1 > kLongestPath) return -1;
  for (int i = 0; i < kSlots; ++i) {
    Slot& slot = slots[static_cast<std::size_t>(i)];
    int free = 0;
    if (!slot.state.compare_exchange_strong(free, 1)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.state = 2;
    return i;
  }
  return -1;
}

void leave(int slot) {
  if (slot >= 0) slots[static_cast<std::size_t>(slot)].state = 0;
}

extern "C" void remove_parts(int signal) {
  for (Slot& slot : slots)
    if (slot.state == 2) unlink(slot.path);
  std::signal(signal, SIG_DFL);
  raise(signal);
}

}  // namespace

void remove_parts_on_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // nohup
    action.sa_handler = remove_parts;
    sigemptyset(&action.sa_mask);
    action.sa_flags = 0;
    sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of the file size is a failed write, as a full disk
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)), part_path_(path_ + ".part") {
  slot_ = enter(part_path_);
  errno = 0;
  stream_.open(part_path_, std::ios::binary | std::ios::trunc);
  if (stream_) return;
  const int reason = errno;
  leave(slot_);
  fail_on_file(path_, std::string("cannot be written: ") + std::strerror(reason), "file-unwritable");
}

OutputFile::~OutputFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ec;
  std::filesystem::remove(part_path_, ec);
  leave(slot_);
}

void OutputFile::commit() {
  stream_.close();
  if (stream_.fail()) fail_on_file(path_, "could not be written to its end (is the disk full?)", "file-unwritable");
  std::error_code ec;
  std::filesystem::rename(part_path_, path_, ec);
  if (ec) fail_on_file(path_, "cannot be written: " + ec.message(), "file-unwritable");
  committed_ = true;
  leave(slot_);
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  file.commit();
}

}  // namespace camber
