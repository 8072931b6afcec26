// Against the kinematics modules of LinuxCNC, where they are installed. A module is a shared object that asks its host
// for pins (HAL); the functions below are that host.
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "base/units.h"
#include "kinematics/chain.h"
#include "tests/kinematics/machines.h"

namespace {
std::map<std::string, double>* pins = nullptr;
std::map<std::string, int> whole_pins;
}  // namespace

#define HOST extern "C" __attribute__((visibility("default")))
HOST int hal_init(const char*) { return 1; }
HOST int hal_ready(int) { return 0; }
HOST int hal_exit(int) { return 0; }
HOST void* hal_malloc(long size) { return std::calloc(1, static_cast<std::size_t>(size)); }
HOST int hal_pin_float_newf(int, double** data, int, const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  std::array<char, 128> name{};
  std::vsnprintf(name.data(), name.size(), format, values);
  va_end(values);
  *data = &(*pins)[name.data()];
  return 0;
}
HOST int hal_pin_bit_new(const char* name, int, int** data, int) {
  *data = &whole_pins[name];
  return 0;
}
HOST int hal_pin_s32_new(const char* name, int, int** data, int) {
  *data = &whole_pins[name];
  return 0;
}
HOST void rtapi_print(const char*, ...) {}
HOST void rtapi_print_msg(int, const char*, ...) {}

namespace camber::kinematics {
namespace {

struct EmcPose {
  double x = 0, y = 0, z = 0, a = 0, b = 0, c = 0, u = 0, v = 0, w = 0;
};

/// A module with its pins.
class Module {
 public:
  explicit Module(const std::string& name, const char* coordinates) {
    pins = &pins_;
    handle_ = dlopen(("/usr/lib/linuxcnc/modules/" + name + ".so").c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle_) return;
    if (auto* parameter = static_cast<const char**>(dlsym(handle_, "rtapi_info_address_coordinates")))
      *reinterpret_cast<const char**>(const_cast<char*>(*parameter)) = coordinates;
    auto* start = reinterpret_cast<int (*)()>(dlsym(handle_, "rtapi_app_main"));
    inverse_ = reinterpret_cast<Inverse>(dlsym(handle_, "kinematicsInverse"));
    ready_ = start && inverse_ && start() == 0;
  }
  ~Module() {
    if (handle_) dlclose(handle_);
  }
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  bool present() const { return handle_ != nullptr; }
  bool ready() const { return ready_; }
  double& pin(const std::string& name) {
    const auto at = pins_.find(name);
    EXPECT_NE(at, pins_.end()) << name;
    return at == pins_.end() ? pins_[name] : at->second;
  }
  /// In the order of the coordinates.
  std::array<double, 9> joints(const EmcPose& pose) const {
    std::array<double, 9> out{};
    unsigned long inverse_flags = 0, forward_flags = 0;
    EXPECT_EQ(inverse_(&pose, out.data(), &inverse_flags, &forward_flags), 0);
    return out;
  }

 private:
  using Inverse = int (*)(const EmcPose*, double*, const unsigned long*, unsigned long*);
  std::map<std::string, double> pins_;
  void* handle_ = nullptr;
  Inverse inverse_ = nullptr;
  bool ready_ = false;
};

constexpr int kPoses = 20000;
constexpr double kAgreeMm = 1e-10;
constexpr double kLengthMm = 80;

/// The tables of LinuxCNC turn by the right-hand rule, except that conventional-directions is off: see each test.
machine::Machine trunnion(char tilting, const Vec3& point, const Vec3& offset) {
  machine::Machine m;
  m.kinematics.chain = std::string("c") + tilting + "xyz";
  m.kinematics.table_axes = 2;
  machine::RotaryAxis& tilt = m.rotary[static_cast<std::size_t>(tilting - 'a')];
  tilt = {.given = true,
          .direction = tilting == 'a' ? Vec3::UnitX() : Vec3::UnitY(),
          .point_mm = point + offset,
          .positive = machine::PositiveTurn::table};
  m.rotary[2] = {
      .given = true, .direction = Vec3::UnitZ(), .point_mm = point, .positive = machine::PositiveTurn::table};
  return m;
}

void compare_trunnion(Module& module, const std::string& name, char tilting, const Vec3& offset) {
  const Vec3 point(25, -15, -40);
  module.pin(name + ".x-rot-point") = point.x();
  module.pin(name + ".y-rot-point") = point.y();
  module.pin(name + ".z-rot-point") = point.z();
  module.pin(name + (tilting == 'a' ? ".y-offset" : ".x-offset")) = tilting == 'a' ? offset.y() : offset.x();
  module.pin(name + ".z-offset") = offset.z();
  module.pin(name + ".tool-offset") = kLengthMm;
  const Chain chain(trunnion(tilting, point, offset));
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> mm(-300, 300), deg(-400, 400);
  for (int i = 0; i < kPoses; ++i) {
    EmcPose pose{.x = mm(random), .y = mm(random), .z = mm(random), .c = deg(random)};
    (tilting == 'a' ? pose.a : pose.b) = deg(random);
    const auto theirs = module.joints(pose);
    const Vec3 tip(pose.x, pose.y, pose.z - kLengthMm);  // their Z counts to the gauge line
    const auto ours =
        chain.linear_mm(tip, {rad_from_deg(pose.a), rad_from_deg(pose.b), rad_from_deg(pose.c)}, kLengthMm);
    ASSERT_TRUE(ours);
    ASSERT_LE((*ours - Vec3(theirs[0], theirs[1], theirs[2])).norm(), kAgreeMm) << i;
  }
}

TEST(LinuxCncModules, TableTableWithAAndC) {
  Module module("xyzac-trt-kins", "XYZAC");
  if (!module.present()) GTEST_SKIP() << "linuxcnc-uspace is not installed";
  ASSERT_TRUE(module.ready());
  compare_trunnion(module, "xyzac-trt-kins", 'a', {0, 6.5, -30});
}

TEST(LinuxCncModules, TableTableWithBAndC) {
  Module module("xyzbc-trt-kins", "XYZBC");
  if (!module.present()) GTEST_SKIP() << "linuxcnc-uspace is not installed";
  ASSERT_TRUE(module.ready());
  compare_trunnion(module, "xyzbc-trt-kins", 'b', {4.25, 0, -30});
}

/// A head that turns about Z (C) and tilts about Y (B, against the right-hand rule); the pivot is above the tip.
TEST(LinuxCncModules, HeadHeadWithBAndC) {
  Module module("5axiskins", "XYZBCW");
  if (!module.present()) GTEST_SKIP() << "linuxcnc-uspace is not installed";
  ASSERT_TRUE(module.ready());
  constexpr double kPivotMm = 250;
  module.pin("5axiskins.pivot-length") = kPivotMm;
  machine::Machine m;
  m.kinematics.chain = "xyzcb";
  m.rotary[1] = {.given = true,
                 .direction = Vec3::UnitY(),
                 .point_mm = {0, 0, kPivotMm},
                 .positive = machine::PositiveTurn::table};
  m.rotary[2] = {.given = true, .direction = Vec3::UnitZ(), .point_mm = {0, 0, 0}};
  const Chain chain(m);
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> mm(-300, 300), deg(-400, 400);
  for (int i = 0; i < kPoses; ++i) {
    const EmcPose pose{.x = mm(random), .y = mm(random), .z = mm(random), .b = deg(random), .c = deg(random)};
    const auto theirs = module.joints(pose);
    const auto ours = chain.linear_mm({pose.x, pose.y, pose.z}, {0, rad_from_deg(pose.b), rad_from_deg(pose.c)}, 0);
    ASSERT_TRUE(ours);
    ASSERT_LE((*ours - Vec3(theirs[0], theirs[1], theirs[2])).norm(), kAgreeMm) << i;
  }
}

}  // namespace
}  // namespace camber::kinematics
