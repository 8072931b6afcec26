#include "cli/mpi_run.h"

#include <cstdlib>

#include "cli/console.h"

#ifdef CAMBER_MPI
#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include <fmt/format.h>
#include <mpi.h>

#include "api/commands/sections.h"
#include "base/output_file.h"
#include "cli/progress.h"
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

int run_predict_on_ranks(const SectionsArguments&, const GlobalOptions&) { return kCommandLineWrong; }

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

/// `bytes` of one rank to all others, in messages that an int can count.
void send_to_all(std::string& bytes, int from) {
  constexpr std::uint64_t kMessage = std::uint64_t{1} << 30;
  std::uint64_t size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, from, MPI_COMM_WORLD);
  bytes.resize(size);
  for (std::uint64_t at = 0; at < size; at += kMessage)
    MPI_Bcast(bytes.data() + at, static_cast<int>(std::min(kMessage, size - at)), MPI_CHAR, from, MPI_COMM_WORLD);
}

/// A rank's own part is also a file, so that it is not lost when another rank is; the others' come as messages.
class RankParts : public api::PartStore {
 public:
  RankParts(const Ranks& ranks, const std::string& folder, const api::PartKey& key)
      : ranks_(ranks), files_(folder, key), sections_(key.sections) {}

  bool has(const api::PartName& name) override {
    if (!files_.has(name)) return false;
    parts_[api::file_name(name)] = files_.take(name);
    return true;
  }
  void give(const api::PartName& name, std::string content) override {
    files_.give(name, content);
    parts_[api::file_name(name)] = std::move(content);
  }
  std::string take(const api::PartName& name) override { return parts_.at(api::file_name(name)); }
  void gather(api::PartStage stage, int round) override {
    // What no later stage reads.
    if (stage == api::PartStage::solve && round > 2)
      for (std::size_t s = 0; s < sections_; ++s)
        parts_.erase(api::file_name({api::PartStage::solve, round - 2, s, sections_}));
    for (std::size_t s = 0; s < sections_; ++s) {
      std::string& part = parts_[api::file_name({stage, round, s, sections_})];
      send_to_all(part, static_cast<int>(s));
      if (s == ranks_.rank()) sent_bytes_ += part.size();
    }
  }
  std::uint64_t sent_bytes() const { return sent_bytes_; }

 private:
  const Ranks& ranks_;
  api::PartFiles files_;
  std::size_t sections_;
  std::map<std::string, std::string> parts_;
  std::uint64_t sent_bytes_ = 0;
};

/// What every rank has done, on rank 0.
void tell_work(const Ranks& ranks, const simulate::SectionWork& work, std::uint64_t sent_bytes) {
  const std::uint64_t own[3] = {work.stamps, work.voxels, sent_bytes};
  std::vector<std::uint64_t> all(3 * ranks.size());
  MPI_Gather(own, 3, MPI_UINT64_T, all.data(), 3, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  if (ranks.rank() != 0) return;
  std::uint64_t sum = 0, most = 0;
  for (std::size_t r = 0; r < ranks.size(); ++r) {
    fmt::print(stderr, "rank {}: {} stamps, {} voxels, {} bytes sent\n", r, all[3 * r], all[3 * r + 1], all[3 * r + 2]);
    sum += all[3 * r];
    most = std::max(most, all[3 * r]);
  }
  fmt::print(stderr, "stamps: the mean of the ranks is {:.1f} % of the largest\n",
             most == 0 ? 100.0 : 100.0 * static_cast<double>(sum) / static_cast<double>(most * ranks.size()));
}

int predict_on(const Ranks& ranks, SectionsArguments arguments, GlobalOptions options) {
  if (ranks.rank() > 0) options.quiet = true;
  arguments.sections = ranks.size();
  const auto begin = std::chrono::steady_clock::now();
  Diagnostics diagnostics, of_run;
  ProgressLine progress(options, "reading");
  const machine::Job job = machine::read_job(arguments.job, diagnostics);
  settle(diagnostics, options);
  const api::PartKey key = api::part_key(job, arguments.sections, arguments.forces_at);
  RankParts store(ranks, arguments.output_folder, key);
  api::SectionRun run(job, key, store, section_steps(progress), of_run);
  run.sweep(ranks.rank());
  store.gather(api::PartStage::sweep, 1);
  int round = 1;
  for (bool again = true; again;) {
    run.solve(ranks.rank(), round);
    store.gather(api::PartStage::solve, round);
    again = run.is_static() && round < api::kMaxSectionRounds && (round == 1 || run.solved_again(round) > 0);
    if (again) ++round;
  }
  progress.clear();
  if (options.verbosity > 0) tell_work(ranks, run.work(), store.sent_bytes());
  int status = kDone;
  if (ranks.rank() == 0)
    status = merge_and_write(job, key, round, store, {arguments.output_folder, arguments.json}, options, begin);
  MPI_Bcast(&status, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return status;
}

/// What is wrong with the input is found by every rank, and said by the first.
[[noreturn]] void end_all(const Ranks& ranks, const std::function<void()>& say) {
  if (ranks.rank() == 0) {
    say();
    std::fflush(nullptr);
  }
  remove_empty_folders();
  MPI_Abort(MPI_COMM_WORLD, kInputWrong);
  std::abort();
}

}  // namespace

int run_predict_on_ranks(const SectionsArguments& arguments, const GlobalOptions& options) {
  const Ranks ranks;
  try {
    return predict_on(ranks, arguments, options);
  } catch (const InputError& problem) {
    end_all(ranks, [&] { print_diagnostics(problem.diagnostics(), options); });
  } catch (const std::exception& problem) {
    end_all(ranks, [&] { print_error(problem.what()); });
  }
}

#endif

}  // namespace camber::cli
