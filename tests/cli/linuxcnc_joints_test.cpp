// Joints from the text of programs, as camber feed reads it, against those of the control that ran them
// (data/linuxcnc5).
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "api/feed_points.h"
#include "base/units.h"
#include "kinematics/program_joints.h"
#include "machine/machine_model.h"
#include "nc/program_text.h"
#include "test_paths.h"
#include "tests/support/csv_columns.h"
#include "tests/support/test_data.h"

namespace camber {
namespace {

constexpr double kToolLength_mm = 80;

using TraceColumns = std::map<std::string, std::vector<double>>;

TraceColumns trace_columns(const std::string& name) {
  return tests::columns_of(SourceText::read(tests::unpacked_data("linuxcnc5/" + name + "_t.csv")).text());
}

/// The planner's angles, two cycles before those of the joints: its interpolator is x + (second difference of x) / 6.
std::vector<double> planned_angles(const std::vector<double>& joint) {
  std::vector<double> sharp = joint, out(joint.size());
  for (int round = 0; round < 4; ++round)
    for (std::size_t i = 1; i + 1 < joint.size(); ++i)
      sharp[i] = joint[i] - (sharp[i - 1] - 2 * sharp[i] + sharp[i + 1]) / 6;
  for (std::size_t i = 0; i + 2 < joint.size(); ++i) out[i] = sharp[i + 2];
  return out;
}

/// X Y Z (mm) and A C (degrees).
using FiveVector = Eigen::Matrix<double, 5, 1>;

FiveVector five_of(const Vec3& mm, const Vec3& rad) {
  return (FiveVector() << mm, deg_from_rad(rad.x()), deg_from_rad(rad.z())).finished();
}

/// The planner's own position, cycle by cycle, and the joints that were commanded.
struct ControlTrace {
  std::vector<FiveVector> planned, joints;
  std::vector<std::size_t> line;

  explicit ControlTrace(const TraceColumns& t) {
    const bool all_digits = t.contains("a_world_deg");
    const std::vector<double> a = all_digits ? t.at("a_world_deg") : planned_angles(t.at("a_cmd_deg")),
                              c = all_digits ? t.at("c_world_deg") : planned_angles(t.at("c_cmd_deg"));
    for (std::size_t i = 0; i < t.at("t_s").size(); ++i) {
      planned.emplace_back(
          (FiveVector() << t.at("x_world_mm")[i], t.at("y_world_mm")[i], t.at("z_world_mm")[i], a[i], c[i]).finished());
      joints.emplace_back((FiveVector() << t.at("x_cmd_mm")[i], t.at("y_cmd_mm")[i], t.at("z_cmd_mm")[i],
                           t.at("a_cmd_deg")[i], t.at("c_cmd_deg")[i])
                              .finished());
      line.push_back(static_cast<std::size_t>(t.at("line")[i]));
    }
  }
};

nc::Interpretation read_as_feed(const std::string& name, const machine::Machine& machine) {
  Diagnostics diagnostics;
  const nc::Program text =
      nc::read_program(SourceText::read(tests::data_path("linuxcnc5/programs/" + name + ".ngc")), diagnostics);
  nc::InterpreterOptions options;
  options.tool_offsets[1].length_mm = kToolLength_mm;
  if (!name.starts_with("tcp")) options.work_offsets_mm[54] = Vec3::Zero();  // they name joints
  nc::Interpretation moves = api::moves_of_feed(text, machine, options, {}, diagnostics);
  diagnostics.throw_if_errors();
  return moves;
}

struct JointsCompared {
  std::size_t cycles = 0, blocks = 0;
  double worst = 0;  ///< mm, degrees
};

/// Of the cycles in which the planner is on the programmed path of a block, within `on_path` (mm, degrees): the joints
/// that the text gives there, through the control's interpolator x[n] = (q[n-3] + 4 q[n-2] + q[n-1]) / 6.
JointsCompared compare_joints(const std::string& name, double on_path) {
  Diagnostics diagnostics;
  const machine::Machine machine =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/linuxcnc_five_axis.toml", diagnostics);
  const nc::Interpretation moves = read_as_feed(name, machine);
  const ControlTrace trace(trace_columns(name));
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> cycles_of_line;
  for (std::size_t k = 0; k < trace.line.size(); ++k) {
    auto [at, added] = cycles_of_line.try_emplace(trace.line[k], k, k);
    at->second.second = k;
  }
  std::vector<std::optional<FiveVector>> q(trace.line.size());
  JointsCompared out;
  for (kinematics::ProgramJoints joints(machine, moves); !joints.done();) {
    const kinematics::MoveJoints now = joints.next();
    const nc::Move& move = moves.moves[joints.index()];
    const auto cycles = cycles_of_line.find(move.block + 1);
    if (move.kind == nc::MoveKind::dwell || !now.start_known || cycles == cycles_of_line.end()) continue;
    const Vec3 world_mm = *moves.machine_origin_mm - *moves.state_of(move).tool_length_mm * Vec3::UnitZ();
    const FiveVector start = five_of(joints.programmed_mm(joints.at(0)) - world_mm, now.start_rad),
                     way = five_of(joints.programmed_mm(joints.at(1)) - world_mm, now.end_rad) - start;
    if (way.isZero(0)) continue;
    bool any = false;
    for (std::size_t k = cycles->second.first; k <= cycles->second.second; ++k) {
      const double u = way.dot(trace.planned[k] - start) / way.squaredNorm();
      if (u < 0 || u > 1 || (start + u * way - trace.planned[k]).lpNorm<Eigen::Infinity>() > on_path) continue;
      const kinematics::Joints at = joints.at(u);
      q[k] = five_of(at.linear_mm, at.rotary_rad);
      any = true;
    }
    out.blocks += any;
  }
  for (std::size_t n = 3; n < q.size(); ++n) {
    if (!q[n - 3] || !q[n - 2] || !q[n - 1]) continue;
    out.worst =
        std::max(out.worst, ((*q[n - 3] + 4 * *q[n - 2] + *q[n - 1]) / 6 - trace.joints[n]).lpNorm<Eigen::Infinity>());
    ++out.cycles;
  }
  return out;
}

TEST(LinuxCncJoints, OfATraceWithAllDigitsFollowFromTheText) {
  const JointsCompared compared = compare_joints("tcp_singular_g64", 2e-6);
  RecordProperty("worst", std::to_string(compared.worst));
  EXPECT_GT(compared.cycles, 1000U);
  EXPECT_GT(compared.blocks, 100U);
  EXPECT_LE(compared.worst, 1e-5);
}

class RoundedJoints : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, RoundedJoints,
                         testing::Values("rotary_g61", "rotary_g64", "combined_g94_g61", "combined_g94_g64",
                                         "combined_g93_g61", "combined_g93_g64", "tcp_fixed_g61", "tcp_fan_g64",
                                         "tcp_sphere_normal_g64", "tcp_dome_g64", "tcp_dome_g61"),
                         [](const auto& info) { return std::string(info.param); });

/// Positions and angles have four decimals there, and the planner's angles are reckoned back from those of the joints.
TEST_P(RoundedJoints, FollowFromTheTextWithinTheRounding) {
  const JointsCompared compared = compare_joints(GetParam(), 2e-4);
  RecordProperty("worst", std::to_string(compared.worst));
  EXPECT_GT(compared.cycles, 1000U);
  EXPECT_GT(compared.blocks, 20U);
  EXPECT_LE(compared.worst, 5e-4);
}

}  // namespace
}  // namespace camber
