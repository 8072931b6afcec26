#include "nc/machine_state.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace camber::nc {

void MoveWriter::add(MoveKind kind, const Vec3& to, double feed, bool reference, bool canned) {
  if (out_.states.empty() || !(out_.states.back() == state_.modal)) out_.states.push_back(state_.modal);
  Move m;
  m.start_mm = state_.position_mm;
  m.end_mm = to;
  m.feed_mm_per_s = feed;
  m.block = block_;
  m.state = static_cast<std::uint32_t>(out_.states.size() - 1);
  m.kind = kind;
  m.exact_stop = exact_stop_ || state_.modal.path_control == PathControl::exact_stop;
  m.reference = reference;
  m.canned = canned;
  out_.moves.push_back(m);
  state_.position_mm = to;
}

void MoveWriter::rapid(const Vec3& to, bool reference, bool canned) { add(MoveKind::rapid, to, 0, reference, canned); }

void MoveWriter::line(const Vec3& to, double feed, bool canned) {
  // Who cuts knows where he is.
  state_.known = {true, true, true};
  add(MoveKind::linear, to, feed, false, canned);
}

void MoveWriter::arc(const Vec3& to, const Arc& arc, double feed) {
  state_.known = {true, true, true};
  add(MoveKind::arc, to, feed, false, false);
  out_.moves.back().arc = static_cast<std::uint32_t>(out_.arcs.size());
  out_.arcs.push_back(arc);
}

void MoveWriter::dwell(double seconds, bool canned) {
  add(MoveKind::dwell, state_.position_mm, 0, false, canned);
  out_.moves.back().dwell_s = seconds;
}

std::optional<double> cutting_feed(const MachineState& s, const BlockWords& words, double length_mm, const char* name) {
  if (s.modal.feed_mode == FeedMode::inverse_time && !words.has('F')) {
    words.error(nullptr,
                fmt::format("{} under G93 without F; F (one over minutes) was expected in every cutting block", name),
                "feed-missing");
    return std::nullopt;
  }
  if (!s.feed) {
    words.error(nullptr, fmt::format("{} without a feed; F was expected here or in a block before", name),
                "feed-missing");
    return std::nullopt;
  }
  if (*s.feed <= 0) {
    words.error(words.word('F'),
                fmt::format("F{:g} on a cutting move ({}); the feed must be greater than zero", *s.feed, name),
                "feed-zero");
    return std::nullopt;
  }
  switch (s.modal.feed_mode) {
    case FeedMode::inverse_time:
      return length_mm * *s.feed / 60;
    case FeedMode::per_revolution:
      if (s.modal.spindle_speed_rpm <= 0) {
        words.error(nullptr, fmt::format("{} under G95 (feed per revolution) with the spindle at S0", name),
                    "feed-zero");
        return std::nullopt;
      }
      return *s.feed * s.modal.spindle_speed_rpm / 60;
    case FeedMode::per_minute:
      break;
  }
  return mm_per_s_from_mm_per_min(*s.feed);
}

}  // namespace camber::nc
