// A cut in a tilted frame: written in the frame (G68.2), in one that turns with the table (G254), in positions of the
// axes and under tool-centre-point control it is one cut.
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "simulate/predict_path.h"
#include "tests/support/plate_job.h"

namespace camber::simulate {
namespace {

/// A ball, since under a flat bottom rounding decides where an edge rubs.
machine::Job framed_job(const std::string& machine) {
  return testing::job_without_inertia(machine, {{-2, -2, -1}, {2, 2, 0.2}});
}

/// How X, Y and Z are written.
enum class Written { tip, axes, tilted, dynamic };

/// A line, a half circle and a line in the plane through (0, 0, -0.3) square to the tool.
class Writer {
 public:
  Writer(const machine::Machine& machine, const Vec3& angles_deg, Written how)
      : machine_(machine), chain_(machine), how_(how), angles_(rad_from_deg(1) * angles_deg) {
    axis_ = chain_.pose({Vec3::Zero(), angles_}, 0).axis;
    // Euler angles of G68.2: the frame's Z is turned about Z and then tilted about X.
    tilt_ = std::acos(axis_.z());
    about_ = std::atan2(axis_.x(), -axis_.y());
    plane_ = (Eigen::AngleAxisd(about_, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt_, Vec3::UnitX())).toRotationMatrix();
  }

  std::string program() const {
    const Vec3 by_x = plane_.col(0), by_y = plane_.col(1);
    const Vec3 start = kOrigin - 4 * by_x, corner = kOrigin + by_x, end = corner + 2 * by_y;
    const std::string arc = fmt::format("G3 {} {} F900\n", words("XYZ", end), words("IJK", by_y, true));
    return "G21 G90 G94\nG10 L2 P1 X0 Y0 Z-100\nG10 L1 P1 R90\nT1 M6\nS6000 M3\nG54\nG0 X0 Y0 Z200\n" + angle_words() +
           mode() + "G0 " + words("XYZ", start + 9 * axis_) + "\nG1 " + words("XYZ", start) + " F300\n" +
           words("XYZ", corner) + " F900\n" + (has_arc() ? arc : "") + "G1 " + words("XYZ", start + 2 * by_y) +
           "\nG0 " + words("XYZ", start + 9 * axis_) + "\nM30\n";
  }
  /// The arc lies in a plane that G17 has in frames alone; the others go straight from end to end.
  bool has_arc() const { return how_ == Written::tilted; }
  const Vec3& axis() const { return axis_; }
  Vec3 in_part(const Vec3& in_plane) const { return kOrigin + plane_ * in_plane; }

 private:
  std::string angle_words() const {
    std::string out = "G0";
    for (const char letter : machine_.kinematics.rotary_axes())
      out += fmt::format(" {}{:.10f}", static_cast<char>(letter - 'a' + 'A'), deg_from_rad(angles_[letter - 'a']));
    return out + "\n";
  }

  std::string mode() const {
    switch (how_) {
      case Written::tip:
        return "G43.4 H1\n";
      case Written::tilted:
        return fmt::format("G68.2 X{} Y{} Z{} I{:.10f} J{:.10f} K0\nG53.1\nG43 H1\n", kOrigin.x(), kOrigin.y(),
                           kOrigin.z(), deg_from_rad(about_), deg_from_rad(tilt_));
      case Written::dynamic:
        return "G254\nG43 H1\n";
      case Written::axes:
        break;
    }
    return "G43 H1\n";
  }

  /// Of a place on the part, or of a way on it.
  Vec3 written(const Vec3& p, bool way) const {
    const Vec3 zero(0, 0, 100);  // of the machine, in the program's X Y Z
    switch (how_) {
      case Written::tip:
        return p;
      case Written::tilted:
        return plane_.transpose() * (way ? p : Vec3(p - kOrigin));
      case Written::dynamic:
        return chain_.table_rotation(angles_).transpose() * p;
      case Written::axes:
        break;
    }
    return *chain_.linear_mm(p - zero, angles_, 90) - Vec3(0, 0, 90) + machine_.kinematics.gauge_point_mm + zero;
  }

  std::string words(const char* letters, const Vec3& p, bool way = false) const {
    const Vec3 v = written(p, way);
    std::string out;
    for (int i = 0; i < (way ? 2 : 3); ++i) out += fmt::format("{}{:.9f} ", letters[i], v[i]);
    return out;
  }

  inline static const Vec3 kOrigin = Vec3(0.2, -0.1, -0.3);
  const machine::Machine& machine_;
  kinematics::Chain chain_;
  Written how_;
  Vec3 angles_, axis_;
  double tilt_ = 0, about_ = 0;
  Mat3 plane_;
};

SimulatedProgram motion_of(const machine::Job& job, const std::string& text) {
  Diagnostics found;
  SimulatedProgram out = motion::simulate_motion(SourceText("p.nc", text), job, {}, found);
  for (const auto& d : found.all()) EXPECT_NE(d.severity, Severity::error) << d.message;
  return out;
}

std::string without_arc(std::string program) {
  const auto from = program.find("G3 ");
  return program.erase(from, program.find('\n', from) + 1 - from);
}

Prediction cut_of(const machine::Job& job, const SimulatedProgram& program) {
  Diagnostics found;
  return predict(job, make_target(job, program, found), program, {});
}

void expect_one_cut(const machine::Job& job, const SimulatedProgram& is, const SimulatedProgram& should) {
  const auto &a = is.path.stamps, &b = should.path.stamps;
  ASSERT_GT(b.size(), 60u);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    ASSERT_LT((a[k].pose.tip_mm - b[k].pose.tip_mm).norm(), 1e-6) << k;
    ASSERT_LT((a[k].pose.axis - b[k].pose.axis).norm(), 1e-9) << k;
    ASSERT_LT((a[k].feed_per_tooth_mm - b[k].feed_per_tooth_mm).norm(), 1e-6) << k;
    ASSERT_NEAR(a[k].fraction, b[k].fraction, 1e-6) << k;
  }
  const Prediction p = cut_of(job, is), q = cut_of(job, should);
  double largest_N = 0, difference_N = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest_N = std::max(largest_N, q.cut.loads[k].lateral_max_N);
    difference_N = std::max(difference_N, std::abs(p.cut.loads[k].lateral_max_N - q.cut.loads[k].lateral_max_N));
  }
  EXPECT_GT(largest_N, 30);
  EXPECT_LT(difference_N, 5e-3 * largest_N);  // stamps between readings are interpolated
  EXPECT_GT(q.cut.stock_mm3, 1);
  EXPECT_NEAR(p.cut.stock_mm3, q.cut.stock_mm3, 1e-4 * q.cut.stock_mm3);
  EXPECT_NEAR(p.form_error_um.p95, q.form_error_um.p95, 1e-2 * q.form_error_um.p95);
}

}  // namespace

TEST(TiltedFrameCut, IsTheCutOfTheSamePathInEveryOtherWriting) {
  const struct {
    const char* machine;
    Vec3 angles_deg;
    bool dynamic;
  } cases[] = {{"table_bc", {0, 25, 40}, true}, {"head_table", {0, 20, -30}, false}};
  for (const auto& [name, angles, dynamic] : cases) {
    SCOPED_TRACE(name);
    const machine::Job job = framed_job(name);
    const auto text = [&](Written how) { return Writer(job.machine, angles, how).program(); };
    const SimulatedProgram tilted = motion_of(job, without_arc(text(Written::tilted)));
    ASSERT_TRUE(tilted.turns());
    {
      SCOPED_TRACE("tip control");
      expect_one_cut(job, motion_of(job, text(Written::tip)), tilted);
    }
    {
      SCOPED_TRACE("axes");
      expect_one_cut(job, motion_of(job, text(Written::axes)), tilted);
    }
    SCOPED_TRACE("G254");
    if (dynamic) expect_one_cut(job, motion_of(job, text(Written::dynamic)), tilted);
  }
}

/// G17 of a tilted frame is the frame's plane: the tip goes around in it, and its points go back into the frame.
TEST(TiltedFrameCut, ArcsLieInThePlaneOfTheFrame) {
  const machine::Job job = framed_job("table_bc");
  const Writer writer(job.machine, {0, 25, 40}, Written::tilted);
  const SimulatedProgram program = motion_of(job, writer.program());
  const Vec3 centre = writer.in_part({1, 1, 0});
  std::size_t around = 0;
  for (const removal::Stamp& stamp : program.path.stamps) {
    const nc::Move& move = program.moves_in_part().moves[stamp.move];
    if (move.arc == nc::Move::kNoArc || stamp.fraction <= 0 || stamp.fraction >= 1) continue;
    ++around;
    EXPECT_NEAR((stamp.pose.tip_mm - centre).norm(), 1, 1e-6);
    EXPECT_NEAR((stamp.pose.tip_mm - centre).dot(writer.axis()), 0, 1e-6);
  }
  EXPECT_GT(around, 10u);
  const nc::Interpretation& text = program.moves_in_program();
  for (std::uint32_t m = 0; m < text.moves.size(); ++m) {
    const nc::Move& move = text.moves[m];
    if (text.state_of(move).work_frame != nc::WorkFrame::tilted || move.open_axes == 7) continue;
    const auto words = program.part_path()->text_mm(m, program.moves_in_part().moves[m].end_mm);
    ASSERT_TRUE(words);
    EXPECT_LT((*words - move.end_mm).norm(), 1e-9) << move.block + 1;
  }
}

}  // namespace camber::simulate
