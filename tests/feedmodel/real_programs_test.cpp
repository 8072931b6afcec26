// Every sample and every real program on one machine: the same time from plan and cycle time, no axis faster than its
// limit, no contour error beyond what the drives explain.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "feedmodel/cycle_time.h"
#include "feedmodel/timed_path.h"
#include "kinematics/control_options.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"
#include "test_paths.h"
#include "tests/support/test_data.h"

namespace camber::feedmodel {
namespace {

namespace fs = std::filesystem;

constexpr double kLimit = 20000 / 60.0, kAcceleration = 2000, kGain = 33;  // of every axis
/// A circle at the greatest acceleration lies a / (2 Kp^2) beside its path; a corner less.
constexpr double kContour_mm = 1.1 * kAcceleration / (2 * kGain * kGain);

machine::Machine machine_for(const fs::path& program) {
  machine::Machine m;
  const std::string end = program.extension();
  m.control.kind = *machine::control_kind_named(end == ".ncf"   ? "haas"
                                                : end == ".eia" ? "mazak"
                                                : end == ".tap" ? "linuxcnc"
                                                                : "fanuc");
  m.control.corner = {.law = machine::CornerLaw::speed_difference, .speed_difference_mm_per_s = 4.1};
  m.control.in_position_mm = machine::kInPositionMm;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = kLimit;
    axis.acceleration_mm_per_s2 = kAcceleration;
    axis.position_gain_per_s = kGain;
  }
  return m;
}

std::vector<fs::path> programs() {
  std::vector<fs::path> all;
  for (const auto& entry : fs::recursive_directory_iterator(CAMBER_SOURCE_DIR "/samples"))
    if (entry.path().extension() == ".nc") all.push_back(entry.path());
  for (const std::string& path : tests::data_files("nc")) all.emplace_back(path);
  all.emplace_back(tests::data_path("nist/box_op5.nc"));
  std::ranges::sort(all);
  return all;
}

/// Nothing for programs that are refused (other languages, lathes).
std::optional<nc::Interpretation> interpreted(const fs::path& path, const machine::Machine& m) {
  try {
    Diagnostics diagnostics;
    const nc::Program text = nc::read_program(SourceText::read(path), diagnostics);
    nc::Interpretation program = nc::interpret(text, kinematics::interpreter_options(m, std::nullopt), diagnostics);
    diagnostics.throw_if_errors();
    return program;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// Distance of the axes, while feed moves are commanded, from the path that has been commanded so far.
class ContourError {
 public:
  explicit ContourError(const nc::Interpretation& program) : program_(program) {}

  void operator()(std::span<const TimedSample> samples) {
    for (const TimedSample& s : samples) {
      trail_.push_back(s.command_mm);
      fastest_ = std::max(fastest_, s.velocity_mm_per_s.cwiseAbs().maxCoeff());
      if (++count_ % kEvery == 0) follow(s.position_mm, program_.moves[s.move].kind != nc::MoveKind::rapid);
      if (trail_.size() < kMaxKept) continue;
      trail_.erase(trail_.begin(), trail_.begin() + static_cast<std::ptrdiff_t>(at_));
      at_ = 0;
    }
  }
  double worst_mm() const { return worst_; }
  double fastest_mm_per_s() const { return fastest_; }

 private:
  static constexpr std::size_t kEvery = 4, kMaxKept = 1u << 16;

  /// The axes follow: from the nearest place of the last time on.
  void follow(const Vec3& axes, bool cutting) {
    double nearest = INFINITY;
    std::size_t best = at_;
    for (std::size_t i = at_; i < trail_.size(); ++i) {
      const double d = distance(axes, i);
      if (d > nearest) continue;
      nearest = d;
      best = i;
    }
    at_ = best > 0 ? best - 1 : 0;
    if (cutting) worst_ = std::max(worst_, nearest);
  }
  double distance(const Vec3& p, std::size_t i) const {
    if (i == 0) return (p - trail_[0]).norm();
    const Vec3 way = trail_[i] - trail_[i - 1], to = p - trail_[i - 1];
    const double u = std::clamp(to.dot(way) / std::max(1e-30, way.squaredNorm()), 0.0, 1.0);
    return (to - u * way).norm();
  }

  const nc::Interpretation& program_;
  std::vector<Vec3> trail_;
  std::size_t at_ = 0, count_ = 0;
  double worst_ = 0, fastest_ = 0;
};

TEST(RealProgramsSlow, AgreeInTimeAndKeepSpeedAndContour) {
  std::size_t read = 0;
  for (const fs::path& path : programs()) {
    const machine::Machine m = machine_for(path);
    const auto program = interpreted(path, m);
    if (!program || program->moves.empty()) continue;
    ++read;
    ContourError contour(*program);
    const FeedSummary feed = predict_feed(*program, m, [&](std::span<const TimedSample> s) { contour(s); });
    const CycleSplit time = cycle_time(*program, m).all.time;
    printf("%-32s %10.3f s, fastest axis %8.1f mm/min, contour error %.3f mm\n", path.filename().c_str(), feed.time_s,
           60 * contour.fastest_mm_per_s(), contour.worst_mm());
    EXPECT_NEAR(feed.time_s, time.cutting_s + time.positioning_s + time.dwell_s, 1e-6) << path;
    EXPECT_LE(contour.fastest_mm_per_s(), kLimit * (1 + 1e-6)) << path;
    EXPECT_LT(contour.worst_mm(), kContour_mm) << path;
  }
  EXPECT_GT(read, 10u);
}

}  // namespace
}  // namespace camber::feedmodel
