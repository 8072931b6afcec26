#include "calib/protocol_programs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "nc/write/program_writer.h"

namespace camber::calib {
namespace {

constexpr std::array kAngles = {10.0, 20.0, 30.0, 60.0, 90.0, 120.0, 180.0};
constexpr std::array kFeeds = {100.0, 300.0, 600.0, 1000.0, 1500.0};
constexpr std::array kSides = {0.5, 1.0, 3.0, 6.0};
constexpr std::array kZigzags = {5.0, 15.0, 25.0, 35.0, 40.0, 45.0, 50.0, 75.0};
constexpr std::array kZigzagFeeds = {1000.0, 3000.0};
constexpr std::array kRadii = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
constexpr std::array kCircleFeeds = {500.0, 1500.0, 4000.0};
constexpr std::array kChords = {0.5, 0.3, 0.2, 0.1, 0.06, 0.04, 0.02, 0.01};
constexpr std::array kTurns = {1.0, 5.0, 20.0, 90.0};                // degrees
constexpr std::array kTurnFeeds = {300.0, 1000.0, 3000.0, 30000.0};  // degrees/min
constexpr std::array kRapids = {1.0, 3.0, 10.0, 30.0, 100.0};
constexpr std::array<std::array<int, 2>, 3> kPlaneAxes = {{{0, 1}, {1, 2}, {2, 0}}};
constexpr std::array<const char*, 3> kPlanes = {"xy", "yz", "zx"};
constexpr std::array<nc::Plane, 3> kArcPlanes = {nc::Plane::xy, nc::Plane::yz, nc::Plane::zx};
constexpr double kSaturationFeed = 10000.0;  // mm/min
constexpr double kSaturationRadius = 40.0;   // mm; chords of 0.5 mm turn by 0.7 degrees
constexpr double kSaturationLength = 15.0;   // mm of each chord length
constexpr double kZigzagSide = 4.0;          // mm
constexpr int kZigzagSides = 24;

/// One program of parts that begin and end in the origin.
class Writer {
 public:
  Writer(const machine::Machine& machine, const std::string& name, std::string tells)
      : machine_(machine),
        dialect_(kinematics::dialect_of(machine.control.kind)),
        writer_(nc::program_writer(dialect_, {.title = name, .decimals = 6, .corner_tolerance_mm = 0.01})) {
    program_.name = name + std::string(dialect_.file_extension);
    program_.tells = std::move(tells);
    writer_->begin();
    writer_->rapid(Vec3::Zero());
    rest();
  }

  ProtocolProgram finish() {
    program_.text = nc::text_of(dialect_, writer_->finish());
    return std::move(program_);
  }

  double feed_within_limits(double feed_mm_per_min) const {
    double least = feed_mm_per_min;
    for (const machine::Axis& axis : machine_.axis)
      least = std::min(least, mm_per_min_from_mm_per_s(axis.max_velocity_mm_per_s));
    return least;
  }

  /// Points of a plane as feed moves, from the origin; back to it by a rapid.
  void part(int plane, const std::vector<std::array<double, 2>>& points, double angle_deg, double feed, double size) {
    ProtocolPart part = begin(feed_within_limits(feed), kPlanes[plane], size);
    part.angle_deg = angle_deg;
    for (const auto& [first, second] : points) {
      Vec3 to = Vec3::Zero();
      to[kPlaneAxes[plane][0]] = first;
      to[kPlaneAxes[plane][1]] = second;
      writer_->line(to, part.feed_mm_per_min);
    }
    end(part);
    go_back();
  }

  void circle(int plane, double radius, double feed) {
    ProtocolPart part = begin(feed_within_limits(feed), kPlanes[plane], radius);
    writer_->arc(Vec3::Zero(), {-radius, 0}, true, part.feed_mm_per_min, kArcPlanes[plane]);
    end(part);
    rest();
  }

  /// Out and back twice, from 0.
  void turn(char letter, double to_deg, double feed_deg_per_min) {
    ProtocolPart part = begin(feed_deg_per_min, std::string(1, letter), std::abs(to_deg));
    const char word = static_cast<char>(letter - 'a' + 'A');
    for (int i = 0; i < 2; ++i)
      for (const double angle : {to_deg, 0.0}) writer_->turn(word, angle, feed_deg_per_min);
    end(part);
    rest();
  }

  void rapid(int axis, double to_mm) {
    Vec3 to = Vec3::Zero();
    to[axis] = to_mm;
    writer_->rapid(to);
    rest();
    go_back();
  }

  void stop_exactly() { writer_->stop_exactly(); }

 private:
  ProtocolPart begin(double feed, const std::string& plane, double size) const {
    ProtocolPart part;
    part.feed_mm_per_min = feed;
    part.plane = plane;
    part.size_mm = size;
    part.line_first = line() + 1;
    return part;
  }

  void end(ProtocolPart& part) {
    part.line_last = line();
    program_.parts.push_back(part);
  }

  void go_back() {
    rest();
    writer_->rapid(Vec3::Zero());
    rest();
  }

  void rest() { writer_->dwell(0.2); }
  int line() const { return static_cast<int>(writer_->lines()); }

  const machine::Machine& machine_;
  const nc::Dialect& dialect_;
  std::unique_ptr<nc::ProgramWriter> writer_;
  ProtocolProgram program_;
};

using Points = std::vector<std::array<double, 2>>;

/// A closed polygon from the origin whose corners turn by the angle; 180: out and back, twice.
Points polygon(double angle_deg, double side) {
  const int sides = angle_deg == 180 ? 4 : static_cast<int>(std::lround(360 / angle_deg));
  Points points;
  double x = 0, y = 0;
  for (int i = 0; i < sides; ++i) {
    const double heading = rad_from_deg(angle_deg * i);
    x += side * std::cos(heading);
    y += side * std::sin(heading);
    points.push_back({x, y});
  }
  return points;
}

/// Sides that turn to and fro by the angle.
Points zigzag(double angle_deg, double side, int sides) {
  Points points;
  double x = 0, y = 0;
  for (int i = 0; i < sides; ++i) {
    const double heading = rad_from_deg(angle_deg / 2) * (i % 2 ? -1 : 1);
    x += side * std::cos(heading);
    y += side * std::sin(heading);
    points.push_back({x, y});
  }
  return points;
}

/// Chords on a wide circle that begins along the first axis.
Points chords(double length) {
  Points points;
  for (int i = 1; i <= static_cast<int>(std::lround(kSaturationLength / length)); ++i) {
    const double phi = i * length / kSaturationRadius;
    points.push_back({kSaturationRadius * std::sin(phi), kSaturationRadius * (1 - std::cos(phi))});
  }
  return points;
}

ProtocolProgram polygons(const machine::Machine& machine, int plane) {
  Writer w(machine, std::string("protocol_") + kPlanes[plane],
           "corner law, its tolerance or speed step, accelerations of two axes, lag of the drives");
  for (double side : kSides)
    for (double angle : kAngles)
      for (double feed : kFeeds) w.part(plane, polygon(angle, side), angle, feed, side);
  return w.finish();
}

ProtocolProgram corners(const machine::Machine& machine) {
  Writer w(machine, "corners", "the angle above which the control stops at a corner, and for how long");
  for (double angle : kZigzags)
    for (double feed : kZigzagFeeds) w.part(0, zigzag(angle, kZigzagSide, kZigzagSides), angle, feed, kZigzagSide);
  return w.finish();
}

ProtocolProgram circles(const machine::Machine& machine) {
  Writer w(machine, "circles", "the speed that arcs allow, and the radius error of the drives");
  for (int plane = 0; plane < 3; ++plane)
    for (double radius : kRadii)
      for (double feed : kCircleFeeds) w.circle(plane, radius, feed);
  return w.finish();
}

ProtocolProgram saturation(const machine::Machine& machine) {
  Writer w(machine, "saturation", "block processing time T_b = 60000 L_b / V_s and how far the control looks ahead");
  for (double length : kChords) w.part(0, chords(length), 0, kSaturationFeed, length);
  return w.finish();
}

ProtocolProgram rapids(const machine::Machine& machine) {
  Writer w(machine, "rapids", "top speed and acceleration of each axis, and the wait between rapid and feed");
  for (int axis = 0; axis < 3; ++axis) {
    for (double length : kRapids) {
      const double room = machine.axis[axis].travel_mm[1] - machine.axis[axis].travel_mm[0];
      if (length < room / 2) w.rapid(axis, length);
    }
  }
  return w.finish();
}

/// The sense in which the axis may turn by this angle; 0: neither.
int turn_sense(const machine::RotaryAxis& axis, double angle_deg) {
  if (rad_from_deg(angle_deg) <= axis.travel_rad[1]) return 1;
  return rad_from_deg(-angle_deg) >= axis.travel_rad[0] ? -1 : 0;
}

/// Where blocks overlap (G64 of LinuxCNC) their accelerations and the share of them that such a block has make up for
/// each other; on the exact path every block has the whole acceleration.
ProtocolProgram rotary(const machine::Machine& machine) {
  Writer w(machine, "rotary", "top speed, acceleration and lag of each rotary axis");
  const auto turn_all = [&](std::span<const double> feeds) {
    for (const char letter : machine.kinematics.rotary_axes())
      for (const double angle : kTurns)
        for (const double feed : feeds)
          if (const int sense = turn_sense(machine.rotary[static_cast<std::size_t>(letter - 'a')], angle))
            w.turn(letter, sense * angle, feed);
  };
  turn_all(kTurnFeeds);
  if (machine.control.kind.turning_blocks_overlap) {
    w.stop_exactly();
    turn_all(std::span(kTurnFeeds).last(1));
  }
  return w.finish();
}

}  // namespace

std::vector<ProtocolProgram> protocol_programs(const machine::Machine& machine) {
  std::vector<ProtocolProgram> programs;
  for (int plane = 0; plane < 3; ++plane) programs.push_back(polygons(machine, plane));
  programs.push_back(corners(machine));
  programs.push_back(circles(machine));
  programs.push_back(saturation(machine));
  programs.push_back(rapids(machine));
  if (machine.kinematics.given()) programs.push_back(rotary(machine));
  return programs;
}

std::string parts_csv(const ProtocolProgram& program) {
  std::string text = "line_first,line_last,angle_deg,feed_mm_min,plane,size_mm\n";
  for (const ProtocolPart& p : program.parts)
    text += fmt::format("{},{},{:g},{:g},{},{:g}\n", p.line_first, p.line_last, p.angle_deg, p.feed_mm_per_min, p.plane,
                        p.size_mm);
  return text;
}

}  // namespace camber::calib
