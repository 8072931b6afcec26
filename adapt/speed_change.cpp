#include "adapt/adaptation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "kinematics/control_options.h"
#include "kinematics/machine_program.h"
#include "nc/emit.h"
#include "nc/spindle_speeds.h"
#include "simulate/chatter.h"
#include "simulate/stable_speed.h"

namespace camber::adapt {
namespace {

constexpr double kAim = 0.98;  ///< aimed-at fraction of the limit

/// The move is one of the job's operations with this tool and speed.
bool is_of(const simulate::SimulatedProgram& program, std::size_t move, const SpeedChange& change) {
  if (!program.selected[move]) return false;
  const nc::ModalState& state = program.moves_in_part().state_of(program.moves_in_part().moves[move]);
  return state.tool == change.tool && state.spindle_speed_rpm == change.before_rpm;
}

/// Speeds that may be used: usual ones or those of the job, at which scaled feeds stay within the job's.
simulate::SpeedBounds bounds_of(const machine::Job& job, const simulate::SimulatedProgram& program,
                                const SpeedChange& change) {
  const machine::AdaptSettings& s = *job.adapt;
  simulate::SpeedBounds out = simulate::usual_speeds(job, change.before_rpm);
  if (s.spindle_rpm) out = {(*s.spindle_rpm)[0], std::min((*s.spindle_rpm)[1], job.machine.spindle.max_rpm)};
  if (s.highest_feed_mm_per_s <= 0) return out;
  double slowest = std::numeric_limits<double>::infinity(), fastest = 0;
  for (std::size_t m = 0; m < program.moves_in_part().moves.size(); ++m) {
    const double feed = program.moves_in_part().moves[m].feed_mm_per_s;
    if (feed <= 0 || !is_of(program, m, change)) continue;
    slowest = std::min(slowest, feed), fastest = std::max(fastest, feed);
  }
  if (fastest <= 0) return out;
  out.highest_rpm = std::min(out.highest_rpm, change.before_rpm * std::max(1.0, s.highest_feed_mm_per_s / fastest));
  out.lowest_rpm = std::max(out.lowest_rpm, change.before_rpm * std::min(1.0, s.lowest_feed_mm_per_s / slowest));
  return out;
}

/// A speed and the feeds of some changes in the text, or why not.
struct TriedText {
  SpeedText text;
  std::string why_not;
};

class SpeedWriter {
 public:
  SpeedWriter(const machine::Job& job, const simulate::SimulatedProgram& program) : job_(job), program_(program) {}

  TriedText with(std::span<const SpeedChange* const> changes) const {
    const auto& moves = program_.moves_in_part().moves;
    std::vector<double> rpm(moves.size(), 0.0);
    for (std::size_t m = 0; m < moves.size(); ++m)
      for (const SpeedChange* c : changes)
        if (is_of(program_, m, *c)) rpm[m] = c->advised_rpm;
    nc::SpeedEmission speeds = nc::emit_spindle_speeds(program_.text(), program_.moves_in_part(), rpm);
    if (!speeds.why_not.empty()) return {{}, fmt::format("{} (line {})", speeds.why_not, speeds.line)};
    const kinematics::MachineProgram at_speed = read(speeds.emission.text);
    const nc::Interpretation& there = at_speed.commanded();
    if (there.moves.size() != moves.size()) return {{}, "the program runs otherwise at another speed"};
    const auto edits = feed_edits(rpm, there);
    if (!edits) return {{}, "the program sets its speed otherwise than by S words"};
    nc::Emission feeds =
        nc::emit_edits(at_speed.text(), there, *edits, kinematics::decimals_for(job_.machine.control, program_.text()));
    if (!feeds.not_made.empty()) {
      const nc::EditNotMade& first = feeds.not_made.front();
      return {{},
              fmt::format("the feed of line {} cannot change with it, where the move belongs to {}",
                          moves[first.move].block + 1, nc::to_string(first.why))};
    }
    for (std::uint32_t& block : feeds.block_of_line)
      if (block != nc::Emission::kNoBlock) block = speeds.emission.block_of_line[block];
    return {{std::move(feeds.text), std::move(feeds.block_of_line)}, {}};
  }

 private:
  kinematics::MachineProgram read(const std::string& text) const {
    Diagnostics ignored;  // those of the given program are known
    return kinematics::open_program(
        SourceText(job_.program, text), job_.machine,
        {.given = {.inch = job_.inch}, .rotary = kinematics::RotaryWords::never, .language = program_.text().language},
        ignored);
  }

  /// Returns edits of the F words of cuts whose feed does not follow the speed by itself, as it does under G95; nothing
  /// where a cut has another speed than is wanted.
  std::optional<std::vector<nc::MoveEdit>> feed_edits(std::span<const double> rpm,
                                                      const nc::Interpretation& there) const {
    constexpr double kSameFeed = 5e-4;
    std::vector<nc::MoveEdit> out;
    for (std::uint32_t m = 0; m < rpm.size(); ++m) {
      const nc::Move& given = program_.moves_in_part().moves[m];
      if (given.feed_mm_per_s <= 0) continue;
      const double before = program_.moves_in_part().state_of(given).spindle_speed_rpm,
                   wanted = rpm[m] > 0 ? rpm[m] : before;
      if (std::abs(there.state_of(there.moves[m]).spindle_speed_rpm - wanted) > 1e-6 * wanted) return std::nullopt;
      if (rpm[m] <= 0) continue;
      const double feed = given.feed_mm_per_s * wanted / before;
      if (std::abs(there.moves[m].feed_mm_per_s - feed) <= kSameFeed * feed) continue;
      nc::MoveEdit edit;
      edit.move = m, edit.feed_mm_per_s = feed;
      out.push_back(std::move(edit));
    }
    return out;
  }

  const machine::Job& job_;
  const simulate::SimulatedProgram& program_;
};

}  // namespace

std::vector<SpeedChange> find_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                                            std::span<const simulate::StampLoad> loads) {
  const double limit = *job.adapt->limits.chatter_margin;
  simulate::CriticalDepths depths;
  std::vector<SpeedChange> out;
  for (const simulate::ChatterOperation& o : simulate::find_chatter(job, program, loads, depths).operations) {
    SpeedChange c{.tool = o.tool,
                  .before_rpm = o.speed_rpm,
                  .after_rpm = o.speed_rpm,
                  .measured = o.measured,
                  .line = o.line,
                  .margin_before = o.margin,
                  .chatter_hz = o.chatter_hz,
                  .depth_mm = o.depth_mm,
                  .kept_depth_mm = limit * o.depth_mm / o.margin};
    if (o.margin > limit) {
      const simulate::SpeedBounds bounds = bounds_of(job, program, c);
      if (bounds.lowest_rpm < bounds.highest_rpm) {
        const auto found = simulate::find_stable_speed(job, program, loads, o.tool, o.speed_rpm, bounds, kAim * limit);
        c.advised_rpm = found.rpm;
        c.best_rpm = found.best_rpm;
        if (found.best_margin > 0) c.best_depth_mm = limit * o.depth_mm / found.best_margin;
      }
    }
    out.push_back(c);
  }
  return out;
}

SpeedText emit_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                             std::vector<SpeedChange>& changes) {
  std::vector<SpeedChange*> wanted;
  for (SpeedChange& c : changes)
    if (c.advised_rpm > 0) wanted.push_back(&c);
  if (wanted.empty()) return {};
  if (!job.adapt->has(machine::AdaptLever::speed)) {
    for (SpeedChange* c : wanted) c->reason = "levers does not name \"speed\"";
    return {};
  }
  const SpeedWriter writer(job, program);
  TriedText all = writer.with(std::vector<const SpeedChange*>(wanted.begin(), wanted.end()));
  if (all.why_not.empty()) {
    for (SpeedChange* c : wanted) c->after_rpm = c->advised_rpm;
    return std::move(all.text);
  }
  std::vector<const SpeedChange*> made;
  SpeedText out;
  for (SpeedChange* c : wanted) {
    made.push_back(c);
    TriedText tried = writer.with(made);
    if (tried.why_not.empty()) {
      c->after_rpm = c->advised_rpm;
      out = std::move(tried.text);
    } else {
      c->reason = std::move(tried.why_not);
      made.pop_back();
    }
  }
  return out;
}

}  // namespace camber::adapt
