#include "feedmodel/feed_csv.h"

#include <cassert>
#include <filesystem>

#include <fmt/format.h>

#include "base/numbers.h"
#include "base/units.h"
#include "nc/durations.h"

namespace camber::feedmodel {
namespace {

/// Avoids "-0.000", so that a resting axis has the same bytes whichever way it came to rest.
double clean(double value, double half_step) { return value > -half_step && value < half_step ? 0.0 : value; }

/// Returns the free bytes on the disk of the nearest folder above `path` that exists.
double free_bytes_at(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code ec;
  fs::path folder = fs::absolute(path, ec).lexically_normal();
  while (!fs::is_directory(folder, ec) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, ec);
  return ec ? 1e18 : static_cast<double>(space.available);
}

}  // namespace

FeedCsv::FeedCsv(const nc::Interpretation& program, const std::string& path, const std::string& rotary_axes)
    : program_(program), rotary_axes_(rotary_axes), file_(path) {
  file_.stream() << "t_s,block,x_mm,y_mm,z_mm,vx_mm_per_min,vy_mm_per_min,vz_mm_per_min,feed_cmd_mm_per_min,"
                    "feed_mm_per_min";
  for (const char axis : rotary_axes_) file_.stream() << ',' << axis << "_deg";
  if (!rotary_axes_.empty()) file_.stream() << ",tip_x_mm,tip_y_mm,tip_z_mm,axis_x,axis_y,axis_z";
  file_.stream() << '\n';
}

void FeedCsv::append(const TimedSample& s, double feed_mm_per_s) {
  const auto position = [&](int i) { return clean(s.position_mm[i], 0.5e-5); };
  const auto speed = [&](int i) { return clean(mm_per_min_from_mm_per_s(s.velocity_mm_per_s[i]), 0.5e-3); };
  append_cells(text_, 6, {s.t_s});
  append_cells(text_, 0, {static_cast<double>(program_.moves[s.move].block + 1)});
  append_cells(text_, 5, {position(0), position(1), position(2)});
  append_cells(text_, 3,
               {speed(0), speed(1), speed(2), mm_per_min_from_mm_per_s(s.feed_command_mm_per_s),
                mm_per_min_from_mm_per_s(feed_mm_per_s)});
}

void FeedCsv::append(const JointSample& joints) {
  for (const char axis : rotary_axes_)
    append_cells(text_, 5, {clean(deg_from_rad(joints.position_rad[axis - 'a']), 0.5e-5)});
  const Vec3 &tip = joints.tool.tip_mm, &axis = joints.tool.axis;
  append_cells(text_, 5, {clean(tip.x(), 0.5e-5), clean(tip.y(), 0.5e-5), clean(tip.z(), 0.5e-5)});
  append_cells(text_, 9, {clean(axis.x(), 0.5e-9), clean(axis.y(), 0.5e-9), clean(axis.z(), 0.5e-9)});
}

void FeedCsv::write(std::span<const TimedSample> samples) {
  text_.clear();
  for (const TimedSample& s : samples) {
    append(s, s.velocity_mm_per_s.norm());
    text_.back() = '\n';
  }
  file_.stream() << text_;
}

void FeedCsv::write(std::span<const TimedSample> samples, std::span<const JointSample> joints) {
  assert(samples.size() == joints.size());
  text_.clear();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    append(samples[i], joints[i].feed_mm_per_s);
    append(joints[i]);
    text_.back() = '\n';
  }
  file_.stream() << text_;
}

void check_feed_csv_size(const nc::Interpretation& program, const machine::Machine& machine, const std::string& path,
                         Diagnostics& diagnostics) {
  check_feed_csv_size(nc::programmed_time_s(program), machine.control.period_s, free_bytes_at(path), path, diagnostics);
}

void check_feed_csv_size(double time_s, double period_s, double free_bytes, const std::string& path,
                         Diagnostics& diagnostics) {
  constexpr double kBytesPerRow = 85, kMany = 4e9;
  const double rows = time_s / period_s, bytes = rows * kBytesPerRow;
  const bool fits = bytes <= free_bytes;
  if (fits && bytes <= kMany) return;
  std::string message =
      fmt::format("{:.1f} h of motion are {:.3g} rows, about {:.0f} GB", time_s / 3600, rows, bytes / 1e9);
  if (!fits)
    message += fmt::format(", but {:.0f} GB are free on the disk; a shorter program was expected", free_bytes / 1e9);
  diagnostics.add({fits ? Severity::warning : Severity::error, {path, 0, 0}, std::move(message), "output-size", {}});
}

}  // namespace camber::feedmodel
