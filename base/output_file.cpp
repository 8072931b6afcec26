#include "base/output_file.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <random>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <pthread.h>
#include <time.h>
#include <unistd.h>

#include "base/diagnostics.h"
#include "base/folders.h"

namespace camber {

namespace {

namespace fs = std::filesystem;

/// A device or a pipe: there is nothing that a rename could put in its place.
bool is_special(const fs::path& place) {
  std::error_code ec;
  const fs::file_status status = fs::status(place, ec);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Where a chain of symbolic links ends, whether that is there or not; `path` itself where it is none.
std::string behind_links(const std::string& path) {
  if (is_special(path)) return path;  // /dev/stdout is a link to what has no name
  constexpr int kMaxLinks = 40;       // as the system itself follows
  std::error_code ec;
  fs::path at = path;
  for (int i = 0; i < kMaxLinks && fs::is_symlink(at, ec); ++i) {
    const fs::path next = fs::read_symlink(at, ec);
    if (ec) break;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  return at.string();
}

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

/// Folders that were made, the outer ones first, and names of files that are whole, as a signal handler may read them.
constexpr int kFolders = 16;
std::array<Slot, kFolders> folders;

constexpr std::size_t kNames = 4096;
char written[kNames];
std::atomic<std::size_t> written_length{0};

void remember_folder(const std::string& path) {
  if (path.size() + 1 > kLongestPath) return;
  for (Slot& slot : folders) {
    int free = 0;
    if (!slot.state.compare_exchange_strong(free, 1)) continue;
    std::memcpy(slot.path, path.c_str(), path.size() + 1);
    slot.state = 2;
    return;
  }
}

/// Not safe against itself: files are committed by several threads, so under a lock.
void remember_written(const std::string& path) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const std::size_t from = written_length, gap = from > 0 ? 2 : 0;
  if (from + gap + path.size() > kNames) return;
  std::memcpy(written + from, ", ", gap);
  std::memcpy(written + from + gap, path.data(), path.size());
  written_length = from + gap + path.size();
}

std::atomic<int> standard_output{-1};  ///< where claimed

constexpr std::array kEndingSignals{SIGINT, SIGTERM, SIGHUP};
std::atomic<bool> ending{false};  ///< a signal ends the process: no part is opened any more
std::atomic<int> opening{0};      ///< threads between asking that and having the part on the disk

/// While it lives no signal cuts this thread off, and one that another thread gets waits for it.
class Opening {
 public:
  Opening() {
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : kEndingSignals) sigaddset(&blocked, signal);
    pthread_sigmask(SIG_BLOCK, &blocked, &before_);
    ++opening;
    if (!ending) return;
    --opening;
    for (;;) pause();
  }
  ~Opening() {
    --opening;
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  Opening(const Opening&) = delete;
  Opening& operator=(const Opening&) = delete;

 private:
  sigset_t before_;
};

/// For a signal handler: nothing but write().
void say(const char* text, std::size_t length) {
  while (length > 0) {
    const ssize_t done = write(STDERR_FILENO, text, length);
    if (done <= 0) return;
    text += done;
    length -= static_cast<std::size_t>(done);
  }
}

void say_interrupted() {
  constexpr std::string_view kClearLine = "\r\033[K", kNothing = "camber: interrupted: nothing was written\n",
                             kSome = "camber: interrupted; written before, and whole: ";
  if (isatty(STDERR_FILENO)) say(kClearLine.data(), kClearLine.size());
  const std::size_t length = written_length;
  if (length == 0) return say(kNothing.data(), kNothing.size());
  say(kSome.data(), kSome.size());
  say(written, length);
  say("\n", 1);
}

extern "C" void remove_parts(int signal) {
  ending = true;
  constexpr timespec kMillisecond{0, 1'000'000};
  for (int i = 0; i < 2000 && opening > 0; ++i) nanosleep(&kMillisecond, nullptr);  // a disk may hang
  for (Slot& slot : slots)
    if (slot.state == 2) unlink(slot.path);
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder)
    if (folder->state == 2) rmdir(folder->path);
  say_interrupted();
  std::signal(signal, SIG_DFL);
  raise(signal);
}

/// A part that was not there before, open for writing.
struct NewPart {
  std::string path;
  int descriptor = -1;  ///< -1: errno says why
};

/// Nothing that lies at a name already, least of all a link that somebody has put there, is opened or written over.
NewPart create_part(const std::string& place) {
  const auto create = [](const std::string& path) {
    return NewPart{path, open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)};
  };
  NewPart part = create(place + ".part");
  constexpr int kTries = 16;
  for (int i = 0; part.descriptor < 0 && errno == EEXIST && i < kTries; ++i)
    part = create(fmt::format("{}.{:08x}.part", place, std::random_device{}()));
  return part;
}

/// Opens the very file of the descriptor, whatever stands at its name by now.
void open_descriptor(std::ofstream& stream, const NewPart& part) {
  std::error_code ec;
  const std::string by_descriptor = fmt::format("/proc/self/fd/{}", part.descriptor);
  stream.open(fs::exists(by_descriptor, ec) ? by_descriptor : part.path, std::ios::binary | std::ios::trunc);
}

/// False: the bytes did not reach the disk, errno says why. File systems that cannot say so are believed.
bool reaches_disk(int descriptor) {
  if (descriptor < 0 || fsync(descriptor) == 0) return true;
  return errno == EINVAL || errno == ENOSYS || errno == EROFS || errno == ENOTSUP;
}

}  // namespace

void remove_parts_on_signals() {
  for (const int signal : kEndingSignals) {
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

void claim_standard_output() {
  std::fflush(stdout);
  standard_output = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)), place_(behind_links(path_)) {
  int reason = 0;
  if (path_ == "-" && standard_output >= 0) {
    part_path_ = place_;
    stream_.open(fmt::format("/dev/fd/{}", standard_output.load()), std::ios::binary | std::ios::app);
    if (!stream_) fail_on_file("standard output", "cannot be written", "file-unwritable");
    return;
  }
  require_confined(path_);
  {
    const Opening guard;
    errno = 0;
    if (is_special(place_)) {
      part_path_ = place_;
      stream_.open(place_, std::ios::binary | std::ios::trunc);
    } else if (const NewPart part = create_part(place_); part.descriptor < 0) {
      stream_.setstate(std::ios::failbit);
    } else {
      part_path_ = part.path;
      slot_ = enter(part_path_);
      descriptor_ = part.descriptor;
      open_descriptor(stream_, part);
    }
    reason = errno;
  }
  if (stream_) return;
  discard();
  fail_on_file(path_, std::string("cannot be written: ") + std::strerror(reason), "file-unwritable");
}

OutputFile::~OutputFile() {
  if (!committed_) discard();
}

void OutputFile::discard() {
  stream_.close();
  close_descriptor();
  if (part_path_.empty() || part_path_ == place_) return;
  std::error_code ec;
  fs::remove(part_path_, ec);
  leave(slot_);
}

void OutputFile::close_descriptor() {
  if (descriptor_ >= 0) close(descriptor_);
  descriptor_ = -1;
}

void OutputFile::commit() {
  stream_.close();
  if (stream_.fail()) fail_on_file(path_, "could not be written to its end (is the disk full?)", "file-unwritable");
  // Before the rename: after a power failure the name must not lead to a file that is there but empty.
  if (!reaches_disk(descriptor_))
    fail_on_file(path_, std::string("could not be written to its end: ") + std::strerror(errno), "file-unwritable");
  close_descriptor();
  std::error_code ec;
  if (part_path_ != place_) {
    const fs::file_status old = fs::status(place_, ec);
    if (fs::is_regular_file(old)) fs::permissions(part_path_, old.permissions(), ec);
    fs::rename(part_path_, place_, ec);
    if (ec) fail_on_file(path_, "cannot be written: " + ec.message(), "file-unwritable");
  }
  committed_ = true;
  leave(slot_);
  remember_written(path_);
}

void require_writable(const std::string& path) {
  if (path.empty() || (path == "-" && standard_output >= 0)) return;
  require_confined(path);
  const auto refuse = [&](const std::string& why) {
    fail_on_file(path, "cannot be written: " + why, "file-unwritable");
  };
  std::error_code ec;
  const fs::path place = behind_links(path);
  const fs::path folder = place.has_parent_path() ? place.parent_path() : ".";
  const fs::file_status there = fs::status(place, ec);
  if (fs::is_directory(there)) refuse("it is a folder; the name of a file was expected");
  if (!fs::is_directory(folder, ec)) refuse("there is no folder " + folder.string());
  if (is_special(place)) {
    if (access(place.c_str(), W_OK) != 0) refuse(std::strerror(errno));
    return;
  }
  // Root may write where the permissions say no; a file that its owner protected is meant to stay all the same.
  constexpr auto kAnyWrite = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  if (fs::exists(there) && ((there.permissions() & kAnyWrite) == fs::perms::none || access(place.c_str(), W_OK) != 0))
    refuse("the file there is write-protected");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    refuse("in the folder " + folder.string() + " nothing can be written: " + std::strerror(errno));
}

void write_file(const std::string& path, std::string_view content) {
  OutputFile file(path);
  file.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  file.commit();
}

void make_folder(const std::string& path) {
  require_confined(path);
  std::error_code ec;
  std::vector<std::string> missing;
  for (fs::path at = fs::absolute(path).lexically_normal(); !fs::exists(at, ec) && at.has_relative_path();
       at = at.parent_path())
    missing.push_back(at.string());
  for (auto folder = missing.rbegin(); folder != missing.rend(); ++folder) remember_folder(*folder);
  fs::create_directories(path, ec);
  if (!fs::is_directory(path)) fail_on_file(path, "cannot be created as a folder: " + ec.message(), "file-unwritable");
}

void remove_empty_folders() {
  for (auto folder = folders.rbegin(); folder != folders.rend(); ++folder)
    if (folder->state == 2) rmdir(folder->path);
}

void try_to_write(const std::function<void()>& write, Diagnostics& failed) {
  try {
    write();
  } catch (const InputError& problem) {
    for (const Diagnostic& d : problem.diagnostics()) failed.add(d);
  }
}

}  // namespace camber
