#include "feedmodel/feed_csv.h"

#include "base/numbers.h"
#include "base/units.h"

namespace camber::feedmodel {
namespace {

/// No "-0.000": the same bytes for a resting axis, whichever way it came to rest.
double clean(double value, double half_step) { return value > -half_step && value < half_step ? 0.0 : value; }

}  // namespace

FeedCsv::FeedCsv(const nc::Interpretation& program, const std::string& path) : program_(program), file_(path) {
  file_.stream() << "t_s,block,x_mm,y_mm,z_mm,vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,"
                    "feed_mm_per_min\n";
}

void FeedCsv::write(std::span<const TimedSample> samples) {
  text_.clear();
  for (const TimedSample& s : samples) {
    const auto position = [&](int i) { return clean(s.position_mm[i], 0.5e-5); };
    const auto speed = [&](int i) { return clean(mm_per_min_from_mm_per_s(s.velocity_mm_per_s[i]), 0.5e-3); };
    append_cells(text_, 6, {s.t_s});
    append_cells(text_, 0, {static_cast<double>(program_.moves[s.move].block + 1)});
    append_cells(text_, 5, {position(0), position(1), position(2)});
    append_cells(text_, 3,
                 {speed(0), speed(1), speed(2), mm_per_min_from_mm_per_s(s.feed_command_mm_per_s),
                  mm_per_min_from_mm_per_s(s.velocity_mm_per_s.norm())});
    text_.back() = '\n';
  }
  file_.stream() << text_;
}

}  // namespace camber::feedmodel
