#include "cli/mpi_run.h"

#include <cstdlib>

#include "cli/console.h"

#ifdef CAMBER_MPI
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <mpi.h>

#include "api/compensation.h"
#include "api/merged_sections.h"
#include "base/output_file.h"
#include "cli/progress.h"
#include "distribute/shared_prediction.h"
#endif

namespace camber::cli {

bool started_by_mpi() {
  // One rank gives the bytes of many: it is a section as well.
  const int least = has_mpi() ? 1 : 2;
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* value = std::getenv(name); value != nullptr && std::atoi(value) >= least) return true;
  return false;
}

#ifndef CAMBER_MPI

bool has_mpi() { return false; }

int run_predict_on_ranks(const PredictArguments&, const GlobalOptions&) { return kCommandLineWrong; }
int run_compensate_on_ranks(const CompensateArguments&, const GlobalOptions&) { return kCommandLineWrong; }

#else

bool has_mpi() { return true; }

namespace {

/// Between MPI_Init and MPI_Finalize.
class Ranks {
 public:
  Ranks() {
    int given = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~Ranks() { MPI_Finalize(); }
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  std::size_t rank() const { return static_cast<std::size_t>(rank_); }
  std::size_t size() const { return static_cast<std::size_t>(size_); }

 private:
  int rank_ = 0, size_ = 1;
};

volatile std::sig_atomic_t part_in_work = 0, asked_to_end = 0;

[[noreturn]] void leave() {
  constexpr std::string_view kSaid = "camber: ended by mpirun; the parts of this rank are written\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kSaid.data(), kSaid.size());
  _exit(128 + SIGTERM);
}

/// Where a rank is lost, mpirun sends SIGTERM to the others. A part that is in work is written first.
class PartInWork {
 public:
  PartInWork() { part_in_work = 1; }
  ~PartInWork() {
    part_in_work = 0;
    if (asked_to_end) leave();
  }
  PartInWork(const PartInWork&) = delete;
  PartInWork& operator=(const PartInWork&) = delete;
};

/// While it lives, SIGTERM ends the process between parts.
class EndsBetweenParts {
 public:
  EndsBetweenParts()
      : before_(std::signal(SIGTERM, [](int) {
          asked_to_end = 1;
          if (!part_in_work) leave();
        })) {}
  ~EndsBetweenParts() { std::signal(SIGTERM, before_); }
  EndsBetweenParts(const EndsBetweenParts&) = delete;
  EndsBetweenParts& operator=(const EndsBetweenParts&) = delete;

 private:
  void (*before_)(int);
};

constexpr std::uint64_t kMessage = std::uint64_t{1} << 30;  // bytes that an int can count

int part_of_message(std::uint64_t at, std::uint64_t size) {
  return at < size ? static_cast<int>(std::min(kMessage, size - at)) : 0;
}

/// Sends `bytes` to a rank while it receives those of another.
std::string exchange(const std::string& bytes, int to, int from) {
  std::uint64_t size = bytes.size(), coming = 0;
  MPI_Sendrecv(&size, 1, MPI_UINT64_T, to, 0, &coming, 1, MPI_UINT64_T, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  std::string out(coming, '\0');
  for (std::uint64_t at = 0; at < std::max(size, coming); at += kMessage)
    MPI_Sendrecv(bytes.data() + std::min(at, size), part_of_message(at, size), MPI_CHAR, to, 0,
                 out.data() + std::min(at, coming), part_of_message(at, coming), MPI_CHAR, from, 0, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
  return out;
}

void send(const std::string& bytes, int to) {
  const std::uint64_t size = bytes.size();
  MPI_Send(&size, 1, MPI_UINT64_T, to, 0, MPI_COMM_WORLD);
  for (std::uint64_t at = 0; at < size; at += kMessage)
    MPI_Send(bytes.data() + at, part_of_message(at, size), MPI_CHAR, to, 0, MPI_COMM_WORLD);
}

std::string receive(int from) {
  std::uint64_t size = 0;
  MPI_Recv(&size, 1, MPI_UINT64_T, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  std::string out(size, '\0');
  for (std::uint64_t at = 0; at < size; at += kMessage)
    MPI_Recv(out.data() + at, part_of_message(at, size), MPI_CHAR, from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return out;
}

/// Every rank gives every other one what that needs, in turns; only two messages of a rank are under way at a time.
template <class Bytes, class Take>
std::uint64_t exchange_all(const Ranks& ranks, const Bytes& bytes, const Take& take) {
  std::uint64_t sent = 0;
  const std::size_t n = ranks.size();
  for (std::size_t step = 1; step < n; ++step) {
    const std::size_t to = (ranks.rank() + step) % n, from = (ranks.rank() + n - step) % n;
    const std::string given = bytes(to);
    sent += given.size();
    take(from, exchange(given, static_cast<int>(to), static_cast<int>(from)));
  }
  return sent;
}

/// A rank's own parts are files, so that they are not lost when another rank is; what it needs of others' comes as
/// messages.
class RankParts : public distribute::PartStore {
 public:
  RankParts(const Ranks& ranks, const std::string& folder, const distribute::PartKey& key)
      : ranks_(ranks), files_(folder, key), sections_(key.sections) {}

  bool has(const distribute::PartName& name) override { return files_.has(name); }
  void give(const distribute::PartName& name, const Write& write) override { files_.give(name, write); }
  std::string take(const distribute::PartName& name) override {
    if (name.section == ranks_.rank()) return files_.take(name);
    if (!merging_) return parts_.at(distribute::file_name(name));
    const int wanted[kWanted] = {name.stage == distribute::PartStage::sweep ? kSweep : kSolve, name.round};
    const int of = static_cast<int>(name.section);
    MPI_Send(wanted, kWanted, MPI_INT, of, kRequest, MPI_COMM_WORLD);
    return receive(of);
  }
  std::function<std::string()> take_pieces(const distribute::PartName& name) override {
    return files_.take_pieces(name);
  }
  void check(const distribute::PartName& name) override {
    if (name.section == ranks_.rank()) files_.check(name);  // the other ranks have just written theirs
  }
  void exchange_parts(distribute::SectionRun& run, distribute::PartStage stage, int round) {
    // What no later round reads.
    if (stage == distribute::PartStage::solve && round > 2)
      for (std::size_t s = 0; s < sections_; ++s)
        parts_.erase(distribute::file_name({distribute::PartStage::solve, round - 2, s, sections_}));
    const auto name = [&](std::size_t section) { return distribute::PartName{stage, round, section, sections_}; };
    sent_bytes_ += exchange_all(
        ranks_, run.part_for_others(name(ranks_.rank())),
        [&](std::size_t from, std::string part) { parts_[distribute::file_name(name(from))] = std::move(part); });
  }
  /// From now on rank 0 takes whole parts of others, as a merge asks for them.
  void begin_merge() {
    merging_ = true;
    parts_.clear();
  }
  /// Ends the merge on rank 0: tells the others that nothing more is asked for. Returns `status`.
  int end_merge(int status) {
    const int end[kWanted] = {kEnd, status};
    for (int r = 1; r < static_cast<int>(sections_); ++r) MPI_Send(end, kWanted, MPI_INT, r, kRequest, MPI_COMM_WORLD);
    return status;
  }
  /// On the others: sends what rank 0 asks for, and returns the status with which it ends. They wait asleep: meanwhile
  /// it merges, and a rank that polls takes a processor.
  int serve_merge() {
    for (;;) {
      int there = 0;
      while (MPI_Iprobe(0, kRequest, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE) == MPI_SUCCESS && there == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      int wanted[kWanted] = {};
      MPI_Recv(wanted, kWanted, MPI_INT, 0, kRequest, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      if (wanted[0] == kEnd) return wanted[1];
      const distribute::PartStage stage =
          wanted[0] == kSweep ? distribute::PartStage::sweep : distribute::PartStage::solve;
      send(files_.take({stage, wanted[1], ranks_.rank(), sections_}), 0);
    }
  }
  std::uint64_t sent_bytes() const { return sent_bytes_; }

 private:
  // What rank 0 asks for: a stage and a round, or the end and a status.
  static constexpr int kRequest = 1, kWanted = 2;
  static constexpr int kSweep = 0, kSolve = 1, kEnd = 2;

  const Ranks& ranks_;
  distribute::PartFiles files_;
  std::size_t sections_;
  std::map<std::string, std::string> parts_;  ///< of others: what this rank needs of them
  bool merging_ = false;
  std::uint64_t sent_bytes_ = 0;
};

/// Returns the status of rank 0. The others wait asleep while it merges: one that polls takes a processor.
int status_of_first(int status) {
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Ibcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD, &request);
  int done = 0;
  while (MPI_Test(&request, &done, MPI_STATUS_IGNORE) == MPI_SUCCESS && done == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  // Ends a request that could not be tested; the one that is done is null, and nothing is waited for.
  MPI_Wait(&request, MPI_STATUS_IGNORE);
  return status;
}

/// The mean over the ranks in percent of the largest.
double balance_percent(const std::vector<std::uint64_t>& of_ranks) {
  std::uint64_t sum = 0, most = 0;
  for (const std::uint64_t n : of_ranks) sum += n, most = std::max(most, n);
  return most == 0 ? 100.0 : 100.0 * static_cast<double>(sum) / static_cast<double>(most * of_ranks.size());
}

/// Prints the work of every rank on rank 0. `work`: of this rank before the merge.
void tell_work(const Ranks& ranks, const distribute::SectionWork& work, std::uint64_t sent_bytes) {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  const auto milliseconds = [](const timeval& t) {
    return static_cast<std::uint64_t>(t.tv_sec) * 1000 + static_cast<std::uint64_t>(t.tv_usec) / 1000;
  };
  constexpr std::size_t kFigures = 5;
  const std::uint64_t own[kFigures] = {work.stamps, work.voxels, sent_bytes,
                                       milliseconds(use.ru_utime) + milliseconds(use.ru_stime),
                                       static_cast<std::uint64_t>(use.ru_maxrss) / 1024};
  std::vector<std::uint64_t> all(kFigures * ranks.size());
  MPI_Gather(own, kFigures, MPI_UINT64_T, all.data(), kFigures, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  if (ranks.rank() != 0) return;
  std::vector<std::uint64_t> of_ranks[kFigures];
  for (std::size_t i = 0; i < all.size(); ++i) of_ranks[i % kFigures].push_back(all[i]);
  for (std::size_t r = 0; r < ranks.size(); ++r)
    fmt::print(stderr, "rank {}: {} stamps, {} voxels, {} bytes sent, {:.1f} s of processor time, {} MB\n", r,
               of_ranks[0][r], of_ranks[1][r], of_ranks[2][r], static_cast<double>(of_ranks[3][r]) / 1000,
               of_ranks[4][r]);
  fmt::print(stderr, "mean of the ranks: stamps {:.1f} %, voxels {:.1f} %, processor time {:.1f} % of the largest\n",
             balance_percent(of_ranks[0]), balance_percent(of_ranks[1]), balance_percent(of_ranks[3]));
}

int predict_on(const Ranks& ranks, const PredictArguments& arguments, GlobalOptions options) {
  if (ranks.rank() > 0) options.quiet = true;
  PredictOptions asked = arguments.options;
  asked.rows = false;
  asked.throw_if_unwritten = false;
  Diagnostics diagnostics, of_run;
  std::size_t settled = 0;
  ProgressLine progress(options, "reading");
  const RunOptions how = run_options(progress, options, &settled);
  api::Run of_library(how);
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  settle(diagnostics, options);
  const distribute::PartKey key = distribute::part_key(job, ranks.size(), asked.forces_at);
  RankParts store(ranks, asked.output_folder, key);
  int round = 1;
  distribute::SectionWork work;
  std::shared_ptr<simulate::ReadPrograms> programs;
  const auto compute = [](const auto& part) {
    const PartInWork in_work;
    part();
  };
  {
    const EndsBetweenParts ends;
    distribute::SectionRun run(job, key, store, of_library.steps(), of_run);
    compute([&] { run.sweep(ranks.rank()); });
    store.exchange_parts(run, distribute::PartStage::sweep, 1);
    for (bool again = true; again;) {
      compute([&] { run.solve(ranks.rank(), round); });
      store.exchange_parts(run, distribute::PartStage::solve, round);
      again = run.is_static() && round < distribute::kMaxSectionRounds && (round == 1 || run.solved_again(round) > 0);
      if (again) ++round;
    }
    work = run.work();
    if (ranks.rank() == 0) programs = run.take_programs();
  }
  progress.clear();
  if (options.verbosity > 0) tell_work(ranks, work, store.sent_bytes());
  store.begin_merge();
  if (ranks.rank() > 0) return store.serve_merge();
  const PredictResult merged = api::merge_parts(job, key, round, store, asked, std::move(programs), of_library);
  progress.clear();
  return store.end_merge(finish_prediction(merged, settled, arguments.json, options));
}

/// How the predictions of a compensation were shared.
void tell_predictions(const distribute::CrewFigures& f) {
  fmt::print(stderr, "{} predictions, {} of them from the one before: {} pieces, {} rounds, {} pieces solved\n",
             f.predictions, f.from_the_last, f.pieces, f.rounds, f.solved);
}

/// Every rank compensates, and the predictions are shared; rank 0 writes.
int compensate_on(const Ranks& ranks, const CompensateArguments& arguments, const GlobalOptions& options) {
  const distribute::Crew crew{
      ranks.rank(), ranks.size(), [&](const std::function<std::string(std::size_t)>& bytes) {
        std::vector<std::string> out(ranks.size());
        exchange_all(ranks, bytes, [&](std::size_t from, std::string given) { out[from] = std::move(given); });
        return out;
      }};
  distribute::CrewPredictions shared(crew);
  int status = kDone;
  if (ranks.rank() == 0) {
    status = run_compensate(arguments, options, shared.predictor());
  } else {
    CompensateOptions asked = arguments.options;
    asked.dry_run = true;  // rank 0 writes
    try {
      api::compensate(read_job(arguments.job), asked, {}, shared.predictor());
    } catch (const BeyondModel&) {  // so does rank 0
    }
  }
  if (options.verbosity > 0 && ranks.rank() == 0) tell_predictions(shared.figures());
  return status_of_first(status);
}

/// Ends all ranks. Errors of the input are found by every rank and said by the first; the others say errors of their
/// own alone.
[[noreturn]] void end_all(const Ranks& ranks, const std::function<void()>& say) {
  if (ranks.rank() > 0) std::this_thread::sleep_for(std::chrono::seconds(2));
  say();
  std::fflush(nullptr);
  remove_empty_folders();
  MPI_Abort(MPI_COMM_WORLD, kInputWrong);
  std::abort();
}

template <class Work>
int run_on_ranks(const GlobalOptions& options, const Work& work) {
  const Ranks ranks;
  try {
    return work(ranks);
  } catch (const InputError& problem) {
    end_all(ranks, [&] { print_diagnostics(problem.diagnostics(), options); });
  } catch (const std::exception& problem) {
    end_all(ranks, [&] { print_error(problem.what()); });
  }
}

}  // namespace

int run_predict_on_ranks(const PredictArguments& arguments, const GlobalOptions& options) {
  return run_on_ranks(options, [&](const Ranks& ranks) { return predict_on(ranks, arguments, options); });
}

int run_compensate_on_ranks(const CompensateArguments& arguments, const GlobalOptions& options) {
  return run_on_ranks(options, [&](const Ranks& ranks) { return compensate_on(ranks, arguments, options); });
}

#endif

}  // namespace camber::cli
