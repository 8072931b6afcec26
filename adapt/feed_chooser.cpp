#include "adapt/feed_chooser.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/control_options.h"
#include "motion/operations.h"

namespace camber::adapt {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kExcess = 1.01;       // of the allowed speed
constexpr double kReached = 0.97;      // of a feed that counts as reached
constexpr double kChange_s = 0.03;     // that a change of feed must save
constexpr double kMinLength_mm = 0.2;  // of a block that a split makes
constexpr double kWiden_mm = 0.3;      // first widening of a slow passage
constexpr double kMaxWiden_mm = 6;
constexpr int kWidenRounds = 5;  // then passages are lowered

FeedBounds bounds_of(const machine::Job& job, const FeedCells& cells) {
  const machine::AdaptSettings& s = *job.adapt;
  const double block_time = job.machine.control.block_time_s;
  constexpr double kBlockTimes = 1.5;  // of margin
  double fastest = s.highest_feed_mm_per_s;
  if (fastest <= 0)  // not given: feeds stay as they are
    for (const Cell& c : cells.cells()) fastest = std::max(fastest, c.feed_mm_per_s);
  return {.lowest_mm_per_s = s.lowest_feed_mm_per_s,
          .highest_mm_per_s = fastest,
          .step_fraction = s.step_fraction,
          .change_s = kChange_s + 2 * block_time,
          .min_length_mm = std::max(kMinLength_mm, kBlockTimes * block_time * fastest)};
}

}  // namespace

double milling_time_s(const simulate::SimulatedProgram& program) {
  double out = 0;
  for (const removal::ToolRun& run : program.path.runs)
    for (std::size_t k = run.from + 1; k < run.from + run.count && run.kind == removal::RunKind::milling; ++k)
      if (!program.path.stamps[k].first) out += program.path.stamps[k].t_s - program.path.stamps[k - 1].t_s;
  return out;
}

FeedChooser::FeedChooser(const machine::Job& job, const simulate::SimulatedProgram& given, const FeedCells& cells)
    : job_(job), given_(given), cells_(cells), bounds_(bounds_of(job, cells)) {
  for (const Cell& c : cells.cells()) {
    const auto tool = job.tools.find(given.moves_in_part().state_of(given.moves_in_part().moves[c.move]).tool);
    radius_mm_.push_back(tool == job.tools.end() ? 0 : tool->second.diameter_mm / 2);
  }
  top_speed_ = with_constant(bounds_.highest_mm_per_s)->speed_mm_per_s;
}

std::shared_ptr<FeedCandidate> FeedChooser::with(std::vector<double> feed) const {
  auto out = std::make_shared<FeedCandidate>();
  out->feed_mm_per_s = std::move(feed);
  out->emission = nc::emit_edits(given_.text(), given_.moves_in_program(), cells_.edits(given_, out->feed_mm_per_s),
                                 kinematics::decimals_for(job_.machine.control, given_.text()));
  Diagnostics repeated;  // those of the given program
  machine::Job job = job_;
  out->operations = motion::moved_ranges(motion::as_lines(job_.operations, given_.text(), given_.moves_in_part()),
                                         out->emission.block_of_line);
  job.operations = out->operations;
  out->program = motion::simulate_motion(SourceText(job_.program, out->emission.text), job, {}, repeated);
  out->map = nc::MoveMap(given_.moves_in_part(), out->program.moves_in_part(), out->emission.block_of_line);
  out->speed_mm_per_s = greatest_speeds(*out);
  return out;
}

std::shared_ptr<FeedCandidate> FeedChooser::with_constant(double feed_mm_per_s) const {
  std::vector<double> feed(cells_.size());
  for (std::size_t i = 0; i < feed.size(); ++i)
    feed[i] = cells_[i].kept == Kept::no ? feed_mm_per_s : cells_[i].feed_mm_per_s;
  return with(std::move(feed));
}

std::vector<double> FeedChooser::greatest_speeds(const FeedCandidate& candidate) const {
  std::vector<double> out(cells_.size(), -1);
  const auto& stamps = candidate.program.path.stamps;
  const std::vector<double> speed = speeds_of(job_, candidate.program);
  for (std::size_t k = 0; k < stamps.size(); ++k) {
    const auto place = candidate.map.given(stamps[k].move, stamps[k].fraction);
    const std::size_t c = cells_.find(place.move, place.fraction);
    if (c != FeedCells::kNone) out[c] = std::max(out[c], speed[k]);
  }
  // Cells between two passings are crossed as fast as the faster of them.
  for (const auto& [from, end] : cells_.chains()) {
    std::vector<double> before(end - from, -1);
    for (std::size_t i = from; i < end; ++i)
      before[i - from] = out[i] >= 0 ? out[i] : i > from ? before[i - from - 1] : -1;
    double after = -1;
    for (std::size_t i = end; i-- > from;) {
      after = out[i] >= 0 ? out[i] : after;
      const double fastest = std::max(before[i - from], after);
      out[i] = fastest >= 0 ? fastest : candidate.feed_mm_per_s[i];
    }
  }
  return out;
}

std::vector<double> FeedChooser::ceiling_of(std::span<const double> allowed, std::span<const Contact> contacts) const {
  std::vector<double> out(allowed.begin(), allowed.end());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (out[i] >= top_speed_[i]) out[i] = kInf;  // the axes are no faster there
  slow_entries(contacts, out);
  return least_within(cells_, out, std::max(job_.simulation.voxel_mm, bounds_.min_length_mm / 2));
}

/// From the air the cutter meets material at the least feed of the first radius of the cut.
void FeedChooser::slow_entries(std::span<const Contact> contacts, std::vector<double>& ceiling) const {
  for (const auto& [from, end] : cells_.chains()) {
    double air_mm = kInf;  // since the last contact
    for (std::size_t i = from; i < end; ++i) {
      if (contacts[i] != Contact::cut) {
        air_mm += cells_[i].length_mm;
        continue;
      }
      if (air_mm > radius_mm_[i] / 2) {
        std::size_t last = i;
        while (last + 1 < end && cells_[last + 1].along_mm < cells_[i].along_mm + radius_mm_[i]) ++last;
        double least = kInf;
        for (std::size_t j = last + 1; j-- > i;) {
          if (ceiling[j] < 0) continue;
          ceiling[j] = least = std::min(least, ceiling[j]);
        }
      }
      air_mm = 0;
    }
  }
}

bool FeedChooser::lower_excesses(const FeedCandidate& candidate, std::span<const double> allowed, int round,
                                 std::vector<double>& reach_mm, std::vector<double>& ceiling) const {
  bool any = false;
  for (const auto& [from, end] : cells_.chains())
    for (std::size_t i = from; i < end; ++i) {
      const double limit = std::max(allowed[i], bounds_.lowest_mm_per_s);
      if (allowed[i] < 0 || cells_[i].kept != Kept::no || candidate.speed_mm_per_s[i] <= kExcess * limit) continue;
      any = true;
      reach_mm[i] = std::min(kMaxWiden_mm, 2 * reach_mm[i] + kWiden_mm);
      const double wanted = round < kWidenRounds ? limit : limit * limit / candidate.speed_mm_per_s[i];
      const double low = cells_[i].along_mm - cells_[i].length_mm - reach_mm[i],
                   high = cells_[i].along_mm + reach_mm[i];
      for (std::size_t j = i + 1; j-- > from && cells_[j].along_mm >= low;)
        if (ceiling[j] >= 0) ceiling[j] = std::min(ceiling[j], wanted);
      for (std::size_t j = i + 1; j < end && cells_[j].along_mm - cells_[j].length_mm <= high; ++j)
        if (ceiling[j] >= 0) ceiling[j] = std::min(ceiling[j], wanted);
    }
  return any;
}

bool FeedChooser::lower_unreached(const FeedCandidate& candidate, std::vector<double>& reachable) const {
  bool any = false;
  const auto& feed = candidate.feed_mm_per_s;
  for (const auto& [from, end] : cells_.chains())
    for (std::size_t a = from; a < end;) {
      std::size_t b = a;
      double reached = 0;
      bool raised = false;
      for (; b < end && feed[b] == feed[a]; ++b) {
        reached = std::max(reached, candidate.speed_mm_per_s[b]);
        raised = raised || (cells_[b].kept == Kept::no && feed[b] > cells_[b].feed_mm_per_s * (1 + 1e-9));
      }
      if (raised && reached < kReached * feed[a]) {
        any = true;
        for (std::size_t i = a; i < b; ++i) reachable[i] = std::min(reachable[i], reached);
      }
      a = b;
    }
  return any;
}

std::shared_ptr<FeedCandidate> FeedChooser::choose(std::span<const double> allowed, std::span<const Contact> contacts,
                                                   int rounds) const {
  std::vector<double> ceiling = ceiling_of(allowed, contacts), reachable = top_speed_;
  for (double& speed : reachable)
    if (speed > kReached * bounds_.highest_mm_per_s) speed = bounds_.highest_mm_per_s;
  std::vector<double> reach_mm(cells_.size(), 0.0);
  std::shared_ptr<FeedCandidate> out;
  for (int round = 0; round < rounds; ++round) {
    out = with(plan_feeds(cells_, {ceiling, reachable}, bounds_));
    const bool excess = lower_excesses(*out, allowed, round, reach_mm, ceiling);
    if (!lower_unreached(*out, reachable) && !excess) break;
  }
  return out;
}

}  // namespace camber::adapt
