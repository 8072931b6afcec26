// The program that is written, and its figures.
#include <algorithm>

#include "adapt/adapter.h"
#include "checks/collisions.h"
#include "checks/travel.h"
#include "motion/machine_checks.h"

namespace camber::adapt {

/// Returns, for each emitted line, the block of the given program that it stands for (nc::Emission).
std::vector<std::uint32_t> Adapter::original_blocks() const {
  std::vector<std::uint32_t> out = best_->emission.block_of_line;
  if (stable_)
    for (std::uint32_t& block : out)
      if (block != nc::Emission::kNoBlock) block = stable_blocks_[block];
  return out;
}

std::size_t Adapter::count_changed() const {
  const nc::Program& program = original().text();
  const SourceText text("", best_->emission.text);
  std::vector<bool> same(program.source.line_count(), false), met(same.size(), false);
  const auto of_line = original_blocks();
  for (std::size_t line = 0; line < std::min(of_line.size(), text.line_count()); ++line) {
    const std::size_t block = of_line[line];
    if (block >= same.size()) continue;
    same[block] = !met[block] && text.line(line + 1) == program.source.line(block + 1);
    met[block] = true;
  }
  return static_cast<std::size_t>(std::ranges::count(same, false));
}

void Adapter::check_emitted() {
  machine::Job job = job_;
  job.operations = best_->operations;
  Diagnostics found;
  motion::check_machine(job.machine, best_->program.text(), best_->program.moves_in_part(), found);
  checks::check_travel(job, best_->program.text(), best_->program.moves_in_part(), found);
  checks::check_collisions(job, best_->program, blank(), found);
  for (const Diagnostic& d : found.all())
    if (d.severity == Severity::error) diagnostics_.add(d);
  diagnostics_.throw_if_errors();
}

/// The greatest single feed that keeps the limits; 0: not even the lowest.
double Adapter::constant_feed(double factor) const {
  const std::vector<double> a = allowed(factor);
  const FeedBounds& b = chooser_->bounds();
  double feed = b.highest_mm_per_s;
  for (std::size_t i = 0; i < a.size(); ++i)
    if ((*cells_)[i].kept == Kept::no && a[i] >= 0 && a[i] < chooser_->top_speed_mm_per_s()[i])
      feed = std::min(feed, a[i]);
  return feed < b.lowest_mm_per_s ? 0 : feed;
}

void Adapter::sweep(AdaptResult& out) {
  if (!options_.sweep || !by_load()) return;
  constexpr double kFactors[] = {0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0};
  constexpr int kRounds = 4;
  for (const double factor : kFactors) {
    progress("other limits", (factor - 0.5) / 1.5);
    const auto candidate = choose(factor, kRounds);
    SweepRow row{factor, candidate->program.feed.time_s, candidate->program.text().source.line_count()};
    row.constant_feed_mm_per_s = constant_feed(factor);
    if (row.constant_feed_mm_per_s > 0)
      row.constant_time_s = chooser_->with_constant(row.constant_feed_mm_per_s)->program.feed.time_s;
    out.sweep.push_back(row);
  }
}

/// Margins of the emitted program.
void Adapter::finish_speeds(AdaptResult& out) const {
  if (!settings_.limits.chatter_margin) return;
  out.chatter_limit = *settings_.limits.chatter_margin;
  out.speeds = speeds_;
  for (SpeedChange& c : out.speeds) {
    for (const simulate::ChatterOperation& o : best_chatter_.operations)
      if (o.tool == c.tool && o.speed_rpm == c.after_rpm && o.margin > c.margin_after)
        c.margin_after = o.margin, c.new_line = o.line, c.probability = o.probability;
    c.kept = c.margin_after <= kOverLimit * out.chatter_limit;
  }
}

void Adapter::finish(AdaptResult& out) {
  check_emitted();
  out.text = best_->emission.text;
  out.block_of_line = original_blocks();
  out.time_before_s = original().feed.time_s;
  out.cutting_time_before_s = original().feed.cutting_time_s;
  out.blocks_before = original().text().source.line_count();
  out.loads = verdict_.figures;
  for (std::size_t i = 0; i < out.loads.size(); ++i) out.loads[i].max_before = peaks_before_[i];
  out.over = verdict_.over;
  if (stable_)
    for (OverLimit& o : out.over) o.line = stable_blocks_[o.line - 1] + std::size_t{1};
  finish_speeds(out);
  out.time_after_s = best_->program.feed.time_s;
  out.cutting_time_after_s = best_->program.feed.cutting_time_s;
  out.milling_time_before_s = milling_time_s(original());
  out.milling_time_after_s = milling_time_s(best_->program);
  out.blocks_after = best_->program.text().source.line_count();
  out.blocks_changed = count_changed();
  out.predictions = predictions_;
  if (by_load()) out.constant_feed_mm_per_s = constant_feed(1);
  if (out.constant_feed_mm_per_s > 0) {
    const auto constant = chooser_->with_constant(out.constant_feed_mm_per_s);
    out.constant_time_s = constant->program.feed.time_s;
    out.constant_milling_time_s = milling_time_s(constant->program);
  }
  sweep(out);
  trace(out.trace);
}

void Adapter::trace(PathTrace& out) const {
  double along = 0;
  for (const Cell& c : cells_->cells()) {
    out.along_mm.push_back(along += c.length_mm);
    const std::size_t block = given().moves_in_part().moves[c.move].block;
    out.line.push_back((stable_ ? stable_blocks_[block] : block) + 1);
    out.feed_before_mm_per_s.push_back(original().moves_in_part().moves[c.move].feed_mm_per_s);
  }
  out.feed_after_mm_per_s = best_->feed_mm_per_s;
  out.speed_after_mm_per_s = best_->speed_mm_per_s;
  out.speed_before_mm_per_s.assign(cells_->size(), 0.0);
  const auto& stamps = original().path.stamps;
  const std::vector<double> speeds = speeds_of(job_, original());
  for (std::size_t k = 0; k < stamps.size(); ++k)
    if (const std::size_t c = cells_->find(stamps[k].move, stamps[k].fraction); c != FeedCells::kNone)
      out.speed_before_mm_per_s[c] = std::max(out.speed_before_mm_per_s[c], speeds[k]);
  for (const LoadLimit& l : limits_) {
    if (l.load == Load::chip_min) continue;
    out.load_before.push_back(greatest(*cells_, before_, l.load));
    out.load_after.push_back(greatest(*cells_, best_loads_, l.load));
  }
}

}  // namespace camber::adapt
