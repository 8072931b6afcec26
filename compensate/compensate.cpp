#include "compensate/compensate.h"

#include <algorithm>

#include <fmt/format.h>

#include "compensate/fit_shift.h"
#include "compensate/not_emitted.h"
#include "compensate/shift_path.h"
#include "nc/emit.h"

namespace camber::compensate {

using deflection::MachinedProgram;
using deflection::Prediction;

std::string to_string(Stop stop) {
  switch (stop) {
    case Stop::tolerance:
      return "tolerance";
    case Stop::stalled:
      return "stalled";
    case Stop::rounds:
      break;
  }
  return "rounds";
}

namespace {

constexpr double kSpacing_mm = 1.0;          // between points of a long line
constexpr double kViaTolerance_mm = 0.0005;  // a split of a line must be worth half a micrometre
constexpr double kLeastGain = 0.03;          // a round that lowers the 95th percentile by less has stalled
constexpr int kPatience = 2;                 // rounds without that gain before it counts

/// Points no closer than the control can process blocks.
double spacing_mm(const machine::Job& job, const MachinedProgram& program) {
  double fastest = 0;
  for (const auto& m : program.moves.moves) fastest = std::max(fastest, m.feed_mm_per_s);
  return std::max(kSpacing_mm, fastest * job.machine.control.block_time_s);
}

/// Which place of the path made each point of the surface; does not change from round to round.
class Attribution {
 public:
  Attribution(const ShiftPath& path, const MachinedProgram& program, const Prediction& first, bool own_target) {
    for (const auto& p : first.surface) {
      const std::int32_t id = own_target ? p.target_stamp : p.machined_stamp;
      const bool known = id >= 0 && static_cast<std::size_t>(id) < program.path.stamps.size();
      known_.push_back(known);
      const auto& stamp = program.path.stamps[known ? static_cast<std::size_t>(id) : 0];
      places_.push_back(known ? path.find(stamp.move, stamp.share) : ShiftPath::Place{});
    }
  }
  std::vector<Observation> observe(const std::vector<removal::SurfacePoint>& surface) const {
    std::vector<Observation> out;
    for (std::size_t i = 0; i < surface.size(); ++i)
      if (known_[i]) out.push_back({places_[i], surface[i].normal, surface[i].error_mm, surface[i].area_mm2});
    return out;
  }

 private:
  std::vector<bool> known_;
  std::vector<ShiftPath::Place> places_;
};

std::size_t count_changed(const nc::Program& program, const std::string& text) {
  // Lines of the original that do not stand in the new text, in order; new lines lie between them.
  const SourceText emitted("", text);
  std::size_t at = 1, changed = 0;
  for (std::size_t line = 1; line <= program.source.line_count(); ++line) {
    std::size_t seek = at;
    constexpr std::size_t kWindow = 200;
    while (seek <= emitted.line_count() && seek < at + kWindow && emitted.line(seek) != program.source.line(line))
      ++seek;
    if (seek <= emitted.line_count() && seek < at + kWindow)
      at = seek + 1;
    else
      ++changed;
  }
  return changed;
}

class Loop {
 public:
  Loop(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options)
      : job_(job),
        diagnostics_(diagnostics),
        options_(options),
        program_(deflection::machine_program(SourceText::read(job.program), job, {}, diagnostics)),
        own_target_(job.part.program.empty()),
        target_(own_target_ ? deflection::make_target(job, program_, diagnostics)
                            : deflection::make_target(job, read_target(), diagnostics)),
        path_(program_.moves, program_.selected, spacing_mm(job, program_)) {
    nc::warn_of_uneditable(program_.text, program_.moves, program_.selected, diagnostics);
  }

  Compensation run() {
    Compensation out;
    Prediction first = predict(program_, 0);
    out.feed_before = program_.feed;
    record(first, 0, out);
    out.before_um = first.form_error_um;
    out.surface_before = first.surface;
    out.text = program_.text.source.text();
    const Attribution attribution(path_, program_, first, own_target_);
    take(out, first, program_.feed, out.text, 0);
    std::vector<removal::SurfacePoint> surface = std::move(first.surface);
    int without_gain = 0;
    while (!done(out, without_gain)) {
      const std::size_t limited =
          fit_shift(path_, attribution.observe(surface), {.max_shift_mm = job_.compensation.max_shift_mm});
      const nc::Emission emission = nc::emit_edits(program_.text, program_.moves, path_.edits(kViaTolerance_mm), {});
      const std::string& text = emission.text;
      Diagnostics repeated;  // the emitted program's warnings are the original's
      const MachinedProgram shifted = deflection::machine_program(SourceText(job_.program, text), job_, {}, repeated);
      Prediction prediction = predict(shifted, out.rounds.size());
      record(prediction, limited, out);
      const double best = out.rounds[out.best].error_um.p95, now = prediction.form_error_um.p95;
      without_gain = now < (1 - kLeastGain) * best ? 0 : without_gain + 1;
      if (now < best) {
        take(out, prediction, shifted.feed, text, out.rounds.size() - 1);
        not_made_ = emission.not_made;
      }
      surface = std::move(prediction.surface);
    }
    warn_of_not_emitted(program_.text, program_.moves, not_made_, diagnostics_);
    finish(out);
    return out;
  }

 private:
  MachinedProgram read_target() {
    return deflection::machine_program(SourceText::read(job_.part.program), job_, {}, diagnostics_);
  }

  Prediction predict(const MachinedProgram& program, std::size_t round) const {
    deflection::PredictOptions options;
    options.contacts = false;
    if (options_.progress)
      options.progress = [&](double share) {
        options_.progress(round == 0 ? std::string("as given") : fmt::format("round {}", round), share);
      };
    return deflection::predict(job_, target_, program, options);
  }

  void record(const Prediction& p, std::size_t limited, Compensation& out) const {
    out.rounds.push_back({p.form_error_um, path_.largest_shift_mm(), limited, p.cut.rounds_max, p.cut.unsettled});
  }

  static void take(Compensation& out, const Prediction& p, const feedmodel::FeedSummary& feed, const std::string& text,
                   std::size_t round) {
    out.best = round;
    out.text = text;
    out.after_um = p.form_error_um;
    out.surface_after = p.surface;
    out.feed_after = feed;
    out.max_shift_mm = out.rounds[round].largest_shift_mm;
  }

  bool done(Compensation& out, int without_gain) const {
    const auto& c = job_.compensation;
    if (out.rounds[out.best].error_um.p95 <= c.tolerance_um) {
      out.stop = Stop::tolerance;
      return true;
    }
    if (without_gain >= kPatience) {
      out.stop = Stop::stalled;
      return true;
    }
    out.stop = Stop::rounds;
    return static_cast<int>(out.rounds.size()) > c.max_rounds;
  }

  void finish(Compensation& out) const {
    out.blocks_before = program_.text.source.line_count();
    out.blocks_after = SourceText("", out.text).line_count();
    out.blocks_changed = count_changed(program_.text, out.text);
    out.settled = out.rounds[0].unsettled == 0 && out.rounds[out.best].unsettled == 0;
  }

  const machine::Job& job_;
  Diagnostics& diagnostics_;
  const CompensateOptions& options_;
  MachinedProgram program_;
  bool own_target_;
  deflection::Target target_;
  ShiftPath path_;
  std::vector<nc::EditNotMade> not_made_;  ///< of the best round
};

}  // namespace

Compensation compensate(const machine::Job& job, Diagnostics& diagnostics, const CompensateOptions& options) {
  return Loop(job, diagnostics, options).run();
}

}  // namespace camber::compensate
