#include "adapt/adaptation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "adapt/adapter.h"
#include "adapt/feed_chooser.h"
#include "simulate/verdict.h"

namespace camber::adapt {
namespace {

constexpr double kChipRatio = 0.5;  // of the second evaluation that parts the loads
constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<LoadLimit> scaled(std::span<const LoadLimit> limits, double factor) {
  std::vector<LoadLimit> out(limits.begin(), limits.end());
  for (LoadLimit& l : out) l.value *= l.load == Load::chip_min ? 1 : factor;
  return out;
}

AdaptResult Adapter::run() {
  AdaptResult out;
  if (!by_load()) {
    keep_feeds(out);
    finish(out);
    return out;
  }
  observe_given();
  check_limits();
  progress("choosing feeds", 0);
  chooser_.emplace(job_, given(), *cells_);
  contacts_ = contacts_of(*cells_, loads_);
  find_time_limit(out);
  correct(out);
  finish(out);
  return out;
}

void Adapter::observe_given() {
  const nc::MoveMap itself;
  const auto show = simulate::progress_of(options_.progress, "loads as programmed");
  machine::Job rigid = job_;
  rigid.simulation.coupling = machine::Coupling::rigid;
  if (by_surface_) {
    simulate::PredictOptions predict;
    predict.contacts = false;
    predict.chip_ratio = kChipRatio;
    predict.progress = show;
    const auto prediction = simulate::predict(rigid, setup_->target, given(), predict);
    loads_ = observe({job_, given(), itself, prediction.cut.loads, prediction.surface}, *cells_,
                     prediction.cut.loads_at_ratio, kChipRatio);
  } else {
    const auto prediction = simulate::predict_loads(
        rigid, blank(), given(), {.coupling = machine::Coupling::rigid, .chip_ratio = kChipRatio, .progress = show});
    loads_ = observe({job_, given(), itself, prediction.cut.loads}, *cells_, prediction.cut.loads_at_ratio, kChipRatio);
  }
  before_ = loads_;
  peaks_before_ = peaks_of(loads_, limits_);
}

/// Changes speeds, and feeds with them, but no feed by load: chatter is the only limit.
void Adapter::keep_feeds(AdaptResult& out) {
  chooser_.emplace(job_, given(), *cells_);
  std::vector<double> feeds;
  for (const Cell& c : cells_->cells()) feeds.push_back(c.feed_mm_per_s);
  best_ = chooser_->with(std::move(feeds));
  predict(*best_, out.doubts);
  best_chatter_ = std::move(chatter_);
  out.good = true;
  out.in_time = !options_.time_limit_s || best_->program.feed.time_s <= *options_.time_limit_s;
}

std::vector<double> Adapter::allowed(double factor) const {
  return allowed_feeds(*cells_, loads_, scaled(limits_, kAim * factor), flutes_);
}

std::shared_ptr<FeedCandidate> Adapter::choose(double factor, int rounds) const {
  return chooser_->choose(allowed(factor), contacts_, rounds);
}

/// Scales the limits until the program is fast enough.
void Adapter::find_time_limit(AdaptResult& out) {
  if (!options_.time_limit_s) return;
  constexpr double kMin = 0.1, kMax = 20;
  constexpr int kHalvings = 9, kRounds = 3;
  const auto time_s = [&](double factor) { return choose(factor, kRounds)->program.feed.time_s; };
  double low = kMin, high = kMax;
  out.in_time = time_s(high) <= *options_.time_limit_s;
  if (out.in_time && time_s(low) <= *options_.time_limit_s) high = low;
  for (int i = 0; out.in_time && i < kHalvings && high > low; ++i) {
    const double middle = std::sqrt(low * high);
    (time_s(middle) <= *options_.time_limit_s ? high : low) = middle;
  }
  out.limit_factor = high;
  limits_ = scaled(limits_, high);
}

/// Cuts the candidate in the job's coupling and returns its loads.
ObservedLoads Adapter::predict(const FeedCandidate& candidate, std::vector<std::string>& doubts) {
  ++predictions_;
  const auto show = simulate::progress_of(options_.progress, predictions_ == 1 ? "checking" : "checking again");
  simulate::Prediction p;
  if (by_surface_) {
    simulate::PredictOptions predict;
    predict.contacts = false;
    predict.progress = show;
    p = simulate::predict(job_, setup_->target, candidate.program, predict);
  } else {
    auto loads = simulate::predict_loads(job_, blank(), candidate.program,
                                         {.coupling = job_.simulation.coupling, .progress = show});
    p.cut = std::move(loads.cut);
    p.holes = loads.holes;
    p.holes.surface_mm2 = 1;  // the surface is not judged
  }
  if (settings_.limits.chatter_margin)
    chatter_ = by_surface_ ? p.chatter : simulate::find_chatter(job_, candidate.program, p.cut.loads, depths_);
  doubts = simulate::doubts(job_, candidate.program, p);
  if (!by_load()) return {};
  return observe({job_, candidate.program, candidate.map, p.cut.loads, p.surface}, *cells_, loads_);
}

/// Emits, predicts and corrects until no load exceeds its limit and the greatest is near it.
void Adapter::correct(AdaptResult& out) {
  std::vector<double> feeds = allowed(1);
  FeedBrackets brackets(*cells_);
  double best_excess = kInf;
  while (predictions_ < kMaxPredictions) {
    progress("choosing feeds", 0);
    const auto candidate = chooser_->choose(feeds, contacts_);
    std::vector<std::string> doubts;
    ObservedLoads loads = predict(*candidate, doubts);
    Verdict verdict = judge(*candidate, loads, *cells_, given(), limits_, chooser_->bounds());
    brackets.add(candidate->speed_mm_per_s, verdict.of_cell);
    std::vector<double> now = allowed_feeds(*cells_, loads, scaled(limits_, kAim), flutes_);
    for (std::size_t i = 0; i < now.size(); ++i)
      if (now[i] >= 0) now[i] = brackets.speed_mm_per_s(i, now[i], kAim);
    const double excess = std::max(1.0, verdict.excess);
    const bool low = excess == 1 && verdict.peak < kUnderLimit && can_be_raised(*candidate, now);
    const bool settled = excess == 1 && !low;
    if (!low) lower_feeds(verdict, now, feeds);
    const bool faster = !best_ || candidate->program.feed.time_s < best_->program.feed.time_s;
    if (excess < best_excess || (excess == best_excess && (settled || faster))) {
      best_excess = excess;
      best_ = candidate;
      best_loads_ = loads;
      best_chatter_ = chatter_;
      verdict_ = std::move(verdict);
      out.doubts = std::move(doubts);
    }
    if (settled) break;
    for (std::size_t i = 0; low && i < feeds.size(); ++i)
      if (feeds[i] >= 0 && now[i] >= 0) feeds[i] = now[i];
    loads_ = std::move(loads);
  }
  out.good = best_excess == 1;
  loads_ = best_loads_;
}

/// Lowers feeds to what the observed loads allow, in the cells over a limit and beside them: at another feed passings
/// fall elsewhere.
void Adapter::lower_feeds(const Verdict& verdict, std::span<const double> now, std::vector<double>& feeds) const {
  for (const auto& [from, end] : cells_->chains())
    for (std::size_t i = from; i < end; ++i) {
      if (verdict.of_cell[i] <= 1 || now[i] < 0) continue;
      const std::size_t first = i - (i > from ? 1 : 0), last = std::min(i + 1, end - 1);
      for (std::size_t j = first; j <= last; ++j)
        if (feeds[j] >= 0 && (j == i || verdict.of_cell[i] > kOverLimit)) feeds[j] = std::min(feeds[j], now[i]);
    }
}

/// Whether any cell of the cut has a feed that both the loads and the control would let rise by a step.
bool Adapter::can_be_raised(const FeedCandidate& candidate, std::span<const double> now) const {
  const FeedBounds& b = chooser_->bounds();
  for (std::size_t i = 0; i < cells_->size(); ++i) {
    if ((*cells_)[i].kept != Kept::no || contacts_[i] != Contact::cut) continue;
    const double wanted = std::min({now[i], b.highest_mm_per_s, chooser_->top_speed_mm_per_s()[i]});
    if (wanted > candidate.feed_mm_per_s[i] * (1 + b.step_fraction)) return true;
  }
  return false;
}

std::string_view to_string(OverReason reason) {
  switch (reason) {
    case OverReason::lowest_feed:
      return "the feed is the lowest";
    case OverReason::plunge:
      return "feeds along the tool axis are not changed";
    case OverReason::not_editable:
      return "the text does not allow another feed";
    case OverReason::control:
      return "the control does not slow down in time";
    case OverReason::highest_feed:
      return "a limit or the highest feed keeps the chip thinner";
  }
  return "";
}

AdaptResult adapt(const machine::Job& job, Diagnostics& diagnostics, const AdaptOptions& options) {
  if (!job.adapt)
    fail_on_file(job.path,
                 "has no [adapt]; a table with limits = { force_N = 150.0 } and feed_mm_per_min = [300, 3000] was "
                 "expected",
                 "adapt-missing");
  return Adapter(job, diagnostics, options).run();
}

}  // namespace camber::adapt
