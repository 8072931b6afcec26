#include "copymill/runner.h"

#include <algorithm>
#include <cassert>
#include <ctime>
#include <limits>

#include <fmt/format.h>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "removal/stock.h"

namespace camber::copymill {
namespace {

constexpr double kBeside_mm = 20;  ///< distance beside the stock at which tips enter from the side
constexpr double kNoLimit_mm_per_s = std::numeric_limits<double>::infinity();

double smallest_diameter_mm(const machine::Job& job) {
  double out = std::numeric_limits<double>::infinity();
  for (const auto& [number, tool] : job.tools) out = std::min(out, tool.diameter_mm);
  return out;
}

std::string tool_text(const machine::Tool& tool) {
  switch (tool.type) {
    case machine::ToolType::ball:
      return fmt::format("BALL D{:g}", tool.diameter_mm);
    case machine::ToolType::flat:
      return fmt::format("FLAT D{:g}", tool.diameter_mm);
    case machine::ToolType::bull:
      return fmt::format("BULL NOSE D{:g} R{:g}", tool.diameter_mm, tool.corner_radius_mm);
    case machine::ToolType::drill:
      return fmt::format("DRILL D{:g}", tool.diameter_mm);
    default:
      return fmt::format("D{:g}", tool.diameter_mm);
  }
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

/// Returns the processor time of this thread, ms.
double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace

Runner::Runner(const machine::Job& job, const CopyOptions& options, removal::Stock& stock)
    : job_(job),
      options_(options),
      stock_(stock),
      motion_(job.machine),
      dialect_(kinematics::dialect_of(job.machine.control.kind)),
      writer_(nc::program_writer(dialect_, {.title = "COPY MILLING", .coolant = options.coolant})),
      piece_options_{.tolerance_mm = options.tolerance_mm},
      clear_height_(stock, smallest_diameter_mm(job)) {
  writer_->begin();
}

void Runner::begin(const OperationCut& cut, Standing& standing, double safe_z, PathDepth* depth, double lowest) {
  cut_.emplace(cut);
  standing_ = &standing;
  depth_ = depth;
  safe_z_ = rounded({0, 0, safe_z + 0.5 * piece_options_.increment_mm}, piece_options_.increment_mm).z();
  summary_ = {};
  summary_.tool = cut.operation.tool, summary_.mode = cut.operation.mode;
  notes_.clear();
  at_.reset();
  const double beside = kBeside_mm + 2 * cut.tool.diameter_mm;
  const removal::TipBox tips{stock_.min_mm() - Vec3(beside, beside, 0), stock_.max_mm() + Vec3(beside, beside, 0)};
  follower_.emplace(job_, cut.operation, stock_,
                    removal::TipBox{{tips.min_mm.x(), tips.min_mm.y(), lowest - 0.01},
                                    {tips.max_mm.x(), tips.max_mm.y(), safe_z_ + 1}},
                    options_.regions, first_id_, options_.loads);
  writer_->change_tool({.number = cut.tool.number,
                        .comment = tool_text(cut.tool) + ", " + upper(machine::word_of(cut.operation.mode)),
                        .spindle_rpm = cut.operation.spindle_rpm,
                        .safe_z_mm = safe_z_});
}

void Runner::end() {
  summary_.removed_mm3 = follower_->flush();
  removed_mm3_ += summary_.removed_mm3;
  first_id_ = follower_->next_id();
  summary_.load = follower_->figures();
  summary_.changes = follower_->changes();
  summary_.changes.insert(summary_.changes.end(), notes_.begin(), notes_.end());
  std::ranges::stable_sort(summary_.changes, {}, &Change::t_s);
  follower_.reset();
  cut_.reset();
}

Runner::Ended Runner::ended() const {
  return stopped_ ? Ended::stopped : follower_->replan() ? Ended::replan : Ended::done;
}

Runner::Ended Runner::rapid(const Vec3& to) {
  const Vec3 target = rounded(to, piece_options_.increment_mm);
  if (!at_) {  // the first place of a tool: nothing is known of the way there
    at_ = target;
    motion_.place(target);
    writer_->rapid({target.x(), target.y(), safe_z_});
    if (target.z() != safe_z_) writer_->rapid(target);
    return ended();
  }
  if ((target - *at_).norm() <= 0) return ended();
  return run({line_piece(*at_, target)}, true, 1);
}

Runner::Ended Runner::cut(const std::vector<Vec3>& points, bool closed, double feed_share) {
  std::vector<Vec3> from_here{*at_};
  from_here.insert(from_here.end(), points.begin(), points.end());
  if (closed && !points.empty()) from_here.push_back(points.front());
  std::vector<PathPiece> path = pieces_of(from_here, false, piece_options_);
  if (path.empty()) return ended();
  return run(std::move(path), false, feed_share);
}

Runner::Ended Runner::follow(std::vector<PathPiece> path) {
  assert(at_ && !path.empty() && (path.front().from - *at_).norm() < piece_options_.increment_mm);
  return run(std::move(path), false, 1);
}

std::optional<double> Runner::share_at_lowest_feed(const Vec3& tip, const Vec2& direction) {
  return follower_->share_at_lowest_feed(tip, {direction.x(), direction.y(), 0});
}

void Runner::note_slot(const Vec3& tip, double from, double to, Cause cause, double share) {
  notes_.push_back({t_s_, tip, Quantity::radial_engagement, from, to, cause, share});
}

Runner::Ended Runner::run(std::vector<PathPiece> path, bool rapid, double feed_share) {
  if (!rapid && ended() != Ended::done) return ended();
  motion_.start(std::move(path), rapid);
  written_piece_ = 0, written_mm_ = 0;
  if (rapid) first_stamp_ = true;
  last_lowered_ = *at_;
  look_due_ = !rapid;
  if (!rapid) read_stock_here();
  const double begin_s = t_s_;
  // A rapid that begins after the stop lifts the tool.
  const auto halted = [&, lifts = rapid && stopped_] { return rapid ? stopped_ && !lifts : ended() != Ended::done; };
  written_feed_ = commanded_ = feed_mm_per_s(feed_share);
  while (!motion_.finished() && !(halted() && motion_.at_rest())) {
    if (options_.stop_after_s && t_s_ >= *options_.stop_after_s) stopped_ = true;
    tick(rapid, feed_share, halted());
  }
  const Vec3 end = motion_.piece() < motion_.path().size() ? rounded(motion_.tip(), piece_options_.increment_mm)
                                                           : motion_.path().back().to;
  if (!rapid) {
    write_to(motion_.piece(), motion_.along_piece_mm(), written_feed_);
    standing_->cut(cut_->shape, last_lowered_, end);
    clear_height_.lower(cut_->shape, end);
    stamp_at(t_s_, end);
    summary_.cutting_s += t_s_ - begin_s;
  } else {
    writer_->rapid(end);
  }
  at_ = end;
  summary_.time_s += t_s_ - begin_s;
  return ended();
}

void Runner::tick(bool rapid, double feed_share, bool halted) {
  const auto begin = std::chrono::steady_clock::now();
  const double processor_begin_ms = options_.stream ? processor_ms() : 0;
  const Vec3 before = motion_.tip();
  if (!rapid) command(feed_mm_per_s(feed_share));
  const double wanted = halted ? 0 : rapid ? kNoLimit_mm_per_s : commanded_;
  motion_.tick(wanted, {.distance_mm = 0, .speed_mm_per_s = kNoLimit_mm_per_s});
  t_s_ += motion_.period_s();
  if (!rapid) {
    // A tick is short: what lies ahead is looked at in the one after a tooth passing, where that has none.
    const bool passed = stamp_until(t_s_, before, motion_.tip());
    if (!passed && look_due_) look_ahead();
    if (!passed) read_stock_ahead();
    lower_standing(motion_.tip());
  }
  ++ticks_;
  if (options_.stream)
    options_.stream({t_s_, motion_.tip(), (motion_.tip() - before).norm() / motion_.period_s(), rapid ? 0 : load_N_,
                     processor_ms() - processor_begin_ms});
  const auto took = std::chrono::steady_clock::now() - begin;
  tick_time_ += took;
  longest_tick_ = std::max<std::chrono::nanoseconds>(longest_tick_, took);
  if (depth_ && !rapid) depth_->add(motion_.tip());
}

bool Runner::stamp_until(double t_s, const Vec3& before, const Vec3& now) {
  const double passing_s = 60 / (cut_->operation.spindle_rpm * cut_->tool.flutes);
  if (first_stamp_) next_passing_s_ = t_s - motion_.period_s(), last_stamp_ = before;
  const bool any = next_passing_s_ <= t_s;
  for (; next_passing_s_ <= t_s; next_passing_s_ += passing_s) {
    const double share = 1 - (t_s - next_passing_s_) / motion_.period_s();
    stamp_at(next_passing_s_, before + share * (now - before));
  }
  return any;
}

void Runner::stamp_at(double t_s, const Vec3& tip) {
  removal::Stamp stamp;
  stamp.t_s = t_s;
  stamp.pose.tip_mm = tip;
  stamp.feed_per_tooth_mm = tip - last_stamp_;
  stamp.first = first_stamp_;
  if (!first_stamp_ && stamp.feed_per_tooth_mm.norm() <= 0) return;
  last_stamp_ = tip;
  first_stamp_ = false;
  load_N_ = follower_->pass(stamp, commanded_);
  if (look_due_) look_ahead();
  look_due_ = true;
}

/// Looks at the place that the tool reaches if it begins to brake a tooth passing and a tick later.
void Runner::look_ahead() {
  look_due_ = false;
  const double passing_s = 60 / (cut_->operation.spindle_rpm * cut_->tool.flutes);
  const double way = motion_.stopping_mm() + motion_.speed_mm_per_s() * (passing_s + motion_.period_s());
  const FeedMotion::Ahead ahead = motion_.ahead(way);
  const double since_passing = (motion_.tip() - last_stamp_).norm();
  follower_->look_ahead(t_s_, {ahead.place, ahead.direction, since_passing + way, motion_.braking_mm_per_s2()});
}

void Runner::read_stock_here() { follower_->approach(*at_, removal::StepEngager::kAll); }

void Runner::read_stock_ahead() {
  const double way = motion_.stopping_mm() + removal::kTileVoxels * stock_.voxel_mm();
  follower_->approach(motion_.ahead(way).place, 1);
}

/// Another feed from here on.
void Runner::command(double feed) {
  if (feed == commanded_) return;
  write_to(motion_.piece(), motion_.along_piece_mm(), written_feed_);
  commanded_ = written_feed_ = feed;
}

void Runner::lower_standing(const Vec3& tip) {
  const double step = std::max(standing_->cell_mm(), cut_->shape.radius_mm / 16);
  if ((tip - last_lowered_).norm() < step) return;
  standing_->cut(cut_->shape, last_lowered_, tip);
  clear_height_.lower(cut_->shape, tip);
  last_lowered_ = tip;
}

void Runner::write_cut(const PathPiece& piece, double feed) {
  const double feed_mm_per_min = mm_per_min_from_mm_per_s(feed);
  if (piece.arc)
    writer_->arc(piece.to, piece.centre, piece.sweep_rad > 0, feed_mm_per_min);
  else
    writer_->line(piece.to, feed_mm_per_min);
}

void Runner::write_to(std::size_t piece, double along, double feed) {
  const std::vector<PathPiece>& path = motion_.path();
  for (; written_piece_ < piece; ++written_piece_, written_mm_ = 0)
    write_cut(part_of(path[written_piece_], written_mm_, path[written_piece_].length_mm, piece_options_.increment_mm),
              feed);
  if (piece < path.size() && along > written_mm_) {
    write_cut(part_of(path[piece], written_mm_, along, piece_options_.increment_mm), feed);
    written_mm_ = along;
  }
}

void Runner::finish(CopyResult& result) {
  result.program = writer_->finish();
  result.text = nc::text_of(dialect_, result.program);
  result.blocks = writer_->lines();
  result.time_s = t_s_;
  result.ticks = ticks_;
  const double per_ms = 1e-6;
  if (ticks_ > 0) result.tick_mean_ms = per_ms * static_cast<double>(tick_time_.count()) / static_cast<double>(ticks_);
  result.tick_max_ms = per_ms * static_cast<double>(longest_tick_.count());
  result.removed_mm3 = removed_mm3_;
  result.stopped = stopped_;
}

}  // namespace camber::copymill
