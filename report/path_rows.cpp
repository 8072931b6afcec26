#include "report/path_rows.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <set>

#include "base/units.h"

namespace camber::report {
namespace {

using simulate::StampLoad;

constexpr std::array kQuantities{&PathRow::feed_mm_per_min, &PathRow::force_N, &PathRow::deflection_um,
                                 &PathRow::chip_um,         &PathRow::margin,  &PathRow::error_um,
                                 &PathRow::shift_um};

/// A tooth later than this many passings after the one before begins a new cut.
constexpr double kLatestPassings = 1.5;
constexpr double kLongestPassing_s = 0.25;

/// The larger value; NaN is less than everything.
void raise(double& value, double to) {
  if (!(value >= to)) value = to;
}

void raise_magnitude(double& value, double to) {
  if (!(std::abs(value) >= std::abs(to))) value = to;
}

/// For each row the stamps [from, to) between it and the next one; where there are none, the last stamp before it as
/// long as the cut goes on.
template <class Take>
void for_each_row_stamps(std::vector<PathRow>& rows, const std::vector<removal::Stamp>& stamps, Take take) {
  std::size_t at = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::size_t from = at;
    while (at < stamps.size() && (r + 1 == rows.size() || stamps[at].t_s < rows[r + 1].t_s)) ++at;
    if (at > from) {
      take(rows[r], from, at);
    } else if (at > 0 && at < stamps.size() && !stamps[at].first) {
      const double passing_s = stamps[at].t_s - stamps[at - 1].t_s;
      if (passing_s < kLongestPassing_s && rows[r].t_s - stamps[at - 1].t_s < kLatestPassings * passing_s)
        take(rows[r], at - 1, at);
    }
  }
}

}  // namespace

PathRow PathCollector::row_of(const feedmodel::TimedSample& s) const {
  PathRow row;
  row.t_s = s.t_s;
  row.place_mm = s.position_mm;
  row.command_mm = s.command_mm;
  const nc::Move& move = program_.moves[s.move];
  row.block = move.block + 1;
  row.cutting = move.kind == nc::MoveKind::linear || move.kind == nc::MoveKind::arc;
  row.feed_command_mm_per_min = mm_per_min_from_mm_per_s(s.feed_command_mm_per_s);
  row.feed_mm_per_min = mm_per_min_from_mm_per_s(s.velocity_mm_per_s.norm());
  return row;
}

void PathCollector::close_period() {
  if (!open_) return;
  rows_.push_back(first_);
  const bool slow_first = slowest_.t_s <= fastest_.t_s;
  for (const PathRow* row : {slow_first ? &slowest_ : &fastest_, slow_first ? &fastest_ : &slowest_})
    if (row->t_s > rows_.back().t_s) rows_.push_back(*row);
  open_ = false;
}

void PathCollector::add(const PathRow& row) {
  if (open_ && (row.t_s >= ends_s_ || row.cutting != first_.cutting)) close_period();
  if (!open_) {
    first_ = slowest_ = fastest_ = row;
    ends_s_ = row.t_s + period_s_ * 0.999;
    open_ = true;
  }
  if (row.feed_mm_per_min < slowest_.feed_mm_per_min) slowest_ = row;
  if (row.feed_mm_per_min > fastest_.feed_mm_per_min) fastest_ = row;
}

void PathCollector::add(std::span<const feedmodel::TimedSample> samples) {
  for (const auto& sample : samples) add(row_of(sample));
}

void PathCollector::add(std::span<const feedmodel::TimedSample> samples,
                        std::span<const feedmodel::JointSample> joints) {
  assert(joints.size() == samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    PathRow row = row_of(samples[i]);
    row.axis = joints[i].tool.axis;
    row.rotary_rad = joints[i].position_rad;
    row.tool = static_cast<std::uint32_t>(std::max(0, program_.state_of(program_.moves[samples[i].move]).tool));
    add(row);
  }
}

std::vector<PathRow> PathCollector::take() {
  close_period();
  return std::move(rows_);
}

std::vector<PathRow> rows_of_program(const simulate::SimulatedProgram& program, const machine::Machine& machine,
                                     const feedmodel::JointSampleSink& also) {
  PathCollector collector(program.moves_in_part());
  if (program.turns())
    feedmodel::predict_on_part(program.moves_of_axes(), machine, [&](const feedmodel::PartSamples& part) {
      if (also) also(part.axes(), part.joints());
      collector.add(part.samples(), part.joints());
    });
  else
    feedmodel::predict_feed(program.moves_in_part(), machine, [&](std::span<const feedmodel::TimedSample> samples) {
      if (also) also(samples, {});
      collector.add(samples);
    });
  return collector.take();
}

std::vector<PathRow> rows_of_cut(std::vector<PathRow> rows, const removal::StampPath& path) {
  if (path.stamps.empty()) return rows;
  constexpr double kAround = 0.02, kLeast_s = 0.5;
  double from_s = path.stamps.front().t_s, to_s = path.stamps.back().t_s;
  const double around_s = std::max(kLeast_s, kAround * (to_s - from_s));
  from_s -= around_s, to_s += around_s;
  std::erase_if(rows, [&](const PathRow& row) { return row.t_s < from_s || row.t_s > to_s; });
  return rows;
}

void add_loads(std::vector<PathRow>& rows, const removal::StampPath& path, std::span<const StampLoad> loads,
               std::span<const simulate::ChatterMargins::Passage> chatter) {
  if (loads.size() != path.stamps.size()) return;
  for_each_row_stamps(rows, path.stamps, [&](PathRow& row, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      raise(row.force_N, loads[k].lateral_max_N);
      raise(row.deflection_um, 1000 * loads[k].contact_deflection_mm.norm());
      raise(row.chip_um, 1000 * loads[k].chip_max_mm);
      if (k < chatter.size() && chatter[k].margin > 0) raise(row.margin, chatter[k].margin);
    }
  });
}

void add_errors(std::vector<PathRow>& rows, const removal::StampPath& path,
                std::span<const removal::SurfacePoint> surface) {
  std::vector<double> worst_um(path.stamps.size(), kNothingHere);
  for (const auto& p : surface)
    if (p.valid && p.machined_stamp >= 0 && static_cast<std::size_t>(p.machined_stamp) < worst_um.size())
      raise_magnitude(worst_um[static_cast<std::size_t>(p.machined_stamp)], 1000 * p.error_mm);
  for_each_row_stamps(rows, path.stamps, [&](PathRow& row, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
      if (std::isfinite(worst_um[k])) raise_magnitude(row.error_um, worst_um[k]);
  });
}

std::vector<std::size_t> rows_to_draw(std::span<const PathRow> rows, std::size_t max_rows) {
  std::vector<std::size_t> kept(rows.size() <= max_rows ? rows.size() : 0);
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  if (rows.size() <= max_rows) return kept;
  const std::size_t runs = std::max<std::size_t>(1, max_rows / (2 * kQuantities.size() + 1));
  const std::size_t length = (rows.size() + runs - 1) / runs;
  for (std::size_t from = 0; from < rows.size(); from += length) {
    const std::size_t to = std::min(rows.size(), from + length);
    std::set<std::size_t> of_run{from};
    for (const auto q : kQuantities) {
      std::size_t least = to, greatest = to;
      for (std::size_t i = from; i < to; ++i) {
        if (!std::isfinite(rows[i].*q)) continue;
        if (least == to || rows[i].*q < rows[least].*q) least = i;
        if (greatest == to || rows[i].*q > rows[greatest].*q) greatest = i;
      }
      if (least != to) of_run.insert({least, greatest});
    }
    kept.insert(kept.end(), of_run.begin(), of_run.end());
  }
  if (kept.back() + 1 != rows.size()) kept.push_back(rows.size() - 1);
  return kept;
}

}  // namespace camber::report
