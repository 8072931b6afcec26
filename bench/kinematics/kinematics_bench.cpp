// A million random poses on each machine of samples/kinematics, there and back: the largest differences, and the time.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include <Eigen/Geometry>

#include "kinematics/chain.h"

namespace {

using namespace camber;  // NOLINT(google-build-using-namespace)
using kinematics::Chain;
using kinematics::Joints;

constexpr int kPoses = 1000000;
constexpr double kLengthMm = 117.25;

struct Worst {
  double tip_mm = 0, axis = 0;
  int missing = 0;
  double us = 0;  ///< for a pose and both of its branches, and the joints of each
};

template <class MakePose>
Worst round_trips(const Chain& chain, const MakePose& make_pose) {
  Worst worst;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < kPoses; ++i) {
    const ToolPose pose = make_pose();
    const kinematics::Branches found = chain.branches(pose, kLengthMm, {});
    if (found.count != 2) ++worst.missing;
    for (std::size_t b = 0; b < found.count; ++b) {
      const ToolPose back = chain.pose(found.joints[b], kLengthMm);
      worst.tip_mm = std::max(worst.tip_mm, (back.tip_mm - pose.tip_mm).norm());
      worst.axis = std::max(worst.axis, (back.axis - pose.axis).norm());
    }
  }
  worst.us = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count() / kPoses;
  return worst;
}

void print(const char* name, const char* poses, const Worst& w) {
  std::printf("%-18s %-14s %9.1e mm %9.1e axis %d missing %.2f us\n", name, poses, w.tip_mm, w.axis, w.missing, w.us);
}

void run(const char* name, const std::string& folder) {
  Diagnostics diagnostics;
  const Chain chain(machine::read_machine(folder + "/" + name + ".toml", diagnostics));
  std::mt19937_64 random(24);
  std::uniform_real_distribution<double> mm(-1000, 1000), rad(-4 * kPi, 4 * kPi), exponent(-18, -1);
  print(name, "random", round_trips(chain, [&] {
          Joints q;
          for (int i = 0; i < 3; ++i) q.linear_mm[i] = mm(random);
          for (const char letter : chain.rotary_axes()) q.rotary_rad[letter - 'a'] = rad(random);
          return chain.pose(q, kLengthMm);
        }));
  const Vec3 pole = chain.rotary_axes()[0] == 'c' ? Vec3::UnitZ() : Vec3::UnitY();
  const Vec3 side = pole.unitOrthogonal(), across = Vec3(1, 1, 1) - pole - side;
  print(
      name, "near the pole", round_trips(chain, [&] {
        const double off = std::pow(10, exponent(random)), way = rad(random);
        const Vec3 to = std::cos(way) * side + std::sin(way) * across;
        return ToolPose{{mm(random), mm(random), mm(random)}, (std::cos(off) * pole + std::sin(off) * to).normalized()};
      }));
}

}  // namespace

int main(int argc, char** argv) {
  const std::string folder = argc > 1 ? argv[1] : "samples/kinematics";
  for (const char* name : {"table_ac_linuxcnc", "table_bc", "table_ab", "head_table", "head_head", "nutating_head"})
    run(name, folder);
  return 0;
}
