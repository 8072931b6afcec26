#include "machine/machine_presets.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "machine/toml_table.h"

namespace camber::machine {
namespace {

// Sources: Takata = M. Takata, thesis on the prediction of cycle time, 1999, tables 2.1 and 2.6. Yan & Shirase 1997.
// KAKEN = KAKEN report on deflection-compensated CAM. linear 1999 = American Machinist, "Leaning toward linear", March
// 1999, and Design News, "Machine tools turn to linear motors", 20 September 1999. grbl = grbl 1.1, settings. TNC
// manuals = Heidenhain, technical manuals of the controls, and cycle 32 in the user's manuals. MD = machine data of the
// 840D sl, Detailed Machine Data Description 03/2010. Values marked "estimate" have no published source.

constexpr std::string_view kRouter = R"([control]
period_ms = 1.0                         # 0.5 to 4: estimate; step pulses are planned in segments of this order
block_time_ms = 2.2                     # 1 to 5: grbl: 25 characters a block at 115200 baud
corner = { law = "speed_difference", speed_difference_mm_per_min = 210 }  # 60 to 1000: grbl: junction deviation 0.01 mm at 90 degrees

[axis.x]
max_velocity_mm_per_min = 10000.0       # 2000 to 25000: estimate; data sheets of belt and ball screw routers
acceleration_mm_per_s2 = 500.0          # 50 to 2000: estimate; grbl begins with 10, users set 200 to 1000
stiffness_N_per_um = 3.0                # 0.5 to 15: estimate; push with a spring scale against a dial gauge

[axis.y]
max_velocity_mm_per_min = 10000.0       # 2000 to 25000: estimate; as X
acceleration_mm_per_s2 = 500.0          # 50 to 2000: estimate; as X
stiffness_N_per_um = 3.0                # 0.5 to 15: estimate; as X

[axis.z]
max_velocity_mm_per_min = 5000.0        # 500 to 10000: estimate; lead screw
acceleration_mm_per_s2 = 300.0          # 20 to 1000: estimate
stiffness_N_per_um = 5.0                # 1 to 20: estimate

[spindle]
max_rpm = 30000.0                       # 18000 to 35000: data sheets of trim routers and spindles
)";

constexpr std::string_view kVmc40 = R"([control]
period_ms = 1.0                         # 1 to 8: estimate; Fanuc 0i, Haas
block_time_ms = 1.0                     # 0.4 to 4: KAKEN: 1 and 2 ms
corner = { law = "speed_difference", speed_difference_mm_per_min = 246 }  # 100 to 1000: KAKEN

[axis.x]
max_velocity_mm_per_min = 30000.0       # 20000 to 48000: Takata 30000
max_feed_mm_per_min = 18000.0           # 10000 to 25000: Takata 18000
acceleration_mm_per_s2 = 3500.0         # 1500 to 7000: Takata 3500
position_gain_per_s = 33.0              # 25 to 60: Takata 33
feed_forward_percent = 90.0             # 0 to 100: Takata 90
stiffness_N_per_um = 50.0               # 20 to 100: estimate

[axis.z]
max_velocity_mm_per_min = 18000.0       # 15000 to 40000: Takata 18000
max_feed_mm_per_min = 18000.0           # 10000 to 25000: Takata 18000
acceleration_mm_per_s2 = 3500.0         # 1500 to 7000: Takata 3500
position_gain_per_s = 33.0              # 25 to 60: Takata 33
feed_forward_percent = 90.0             # 0 to 100: Takata 90
stiffness_N_per_um = 60.0               # 30 to 150: estimate

[spindle]
max_rpm = 12000.0                       # 8000 to 15000: Takata 12000
start_time_s = 2.2                      # 1 to 5: Takata 2.2

[tool_change]
chip_to_chip_s = 5.5                    # 3 to 8: Takata 5.5
)";

constexpr std::string_view kVmcLinear = R"([control]
period_ms = 1.0                         # 0.5 to 2: estimate
block_time_ms = 0.5                     # 0.2 to 1: estimate; controls of the 2000s and later
corner = { law = "speed_difference", speed_difference_mm_per_min = 600 }  # 250 to 2000: estimate

[axis.x]
max_velocity_mm_per_min = 90000.0       # 60000 to 120000: linear 1999: 90 to 120 m/min
max_feed_mm_per_min = 40000.0           # 20000 to 60000: estimate
acceleration_mm_per_s2 = 14000.0        # 8000 to 20000: linear 1999: 1.4 and 1.6 g
position_gain_per_s = 150.0             # 80 to 300: estimate; direct drives
feed_forward_percent = 95.0             # 50 to 100: estimate
stiffness_N_per_um = 50.0               # 20 to 150: estimate

[axis.z]
max_velocity_mm_per_min = 90000.0       # 50000 to 120000: linear 1999: 90 to 120 m/min
max_feed_mm_per_min = 40000.0           # 20000 to 60000: estimate
acceleration_mm_per_s2 = 14000.0        # 8000 to 20000: linear 1999: 1.4 and 1.6 g
position_gain_per_s = 150.0             # 80 to 300: estimate; direct drives
feed_forward_percent = 95.0             # 50 to 100: estimate
stiffness_N_per_um = 60.0               # 30 to 150: estimate

[spindle]
max_rpm = 20000.0                       # 15000 to 24000: linear 1999: 16000 and 24000

[tool_change]
chip_to_chip_s = 3.0                    # 1.5 to 5: estimate
)";

constexpr std::string_view kHscDieMould = R"([control]
period_ms = 1.0                         # 0.4 to 2: estimate
block_time_ms = 0.25                    # 0.05 to 0.6: estimate; high speed contouring
corner = { law = "blend", tolerance_mm = 0.005 }  # 0.002 to 0.02: estimate; the contour tolerance of finishing

[axis.x]
max_velocity_mm_per_min = 60000.0       # 30000 to 100000: estimate; data sheets
max_feed_mm_per_min = 40000.0           # 20000 to 60000: estimate
acceleration_mm_per_s2 = 12000.0        # 7000 to 25000: linear 1999: 10 m/s2 with screws, more with linear motors
jerk_mm_per_s3 = 300000.0               # 50000 to 1000000: estimate
position_gain_per_s = 120.0             # 60 to 300: estimate
feed_forward_percent = 98.0             # 80 to 100: estimate
stiffness_N_per_um = 60.0               # 30 to 150: estimate

[axis.z]
max_velocity_mm_per_min = 60000.0       # 30000 to 100000: estimate; data sheets
max_feed_mm_per_min = 40000.0           # 20000 to 60000: estimate
acceleration_mm_per_s2 = 12000.0        # 7000 to 25000: linear 1999: 10 m/s2 with screws, more with linear motors
jerk_mm_per_s3 = 300000.0               # 50000 to 1000000: estimate
position_gain_per_s = 120.0             # 60 to 300: estimate
feed_forward_percent = 98.0             # 80 to 100: estimate
stiffness_N_per_um = 80.0               # 40 to 200: estimate

[spindle]
max_rpm = 42000.0                       # 30000 to 60000: data sheets of motor spindles

[tool_change]
chip_to_chip_s = 5.0                    # 2 to 10: estimate
)";

constexpr std::string_view kFiveAxisTrunnion = R"([control]
period_ms = 1.0                         # 0.5 to 4: estimate
block_time_ms = 1.0                     # 0.4 to 2: KAKEN: 1 and 2 ms
corner = { law = "speed_difference", speed_difference_mm_per_min = 400 }  # 100 to 1000: estimate; KAKEN 246

[kinematics]
chain = ["part", "c", "a", "bed", "x", "y", "z", "spindle"]  # a trunnion that tilts about X, a table that turns on it

[axis.x]
max_velocity_mm_per_min = 36000.0       # 20000 to 60000: estimate; data sheets
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 2000 to 10000: estimate
position_gain_per_s = 50.0              # 30 to 100: estimate
feed_forward_percent = 90.0             # 0 to 100: Takata 90
stiffness_N_per_um = 40.0               # 20 to 100: estimate

[axis.z]
max_velocity_mm_per_min = 36000.0       # 20000 to 60000: estimate; data sheets
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 2000 to 10000: estimate
position_gain_per_s = 50.0              # 30 to 100: estimate
feed_forward_percent = 90.0             # 0 to 100: Takata 90
stiffness_N_per_um = 50.0               # 30 to 150: estimate

[axis.a]
direction = [1, 0, 0]
point_mm = [0, 0, 0]                    # -300 to 300: estimate; where the axes' lines lie: the machine's own parameters
positive = "table"
max_velocity_deg_per_min = 9000.0       # 3000 to 36000: estimate; data sheets
acceleration_deg_per_s2 = 600.0         # 200 to 6000: estimate

[axis.c]
direction = [0, 0, 1]
point_mm = [0, 0, 0]                    # -300 to 300: estimate; as A
positive = "table"
max_velocity_deg_per_min = 18000.0      # 6000 to 72000: estimate; data sheets
acceleration_deg_per_s2 = 1200.0        # 300 to 10000: estimate

[spindle]
max_rpm = 18000.0                       # 12000 to 24000: data sheets

[tool_change]
chip_to_chip_s = 5.5                    # 3 to 10: Takata 5.5
)";

constexpr std::string_view kTnc640 = R"([control]
dialect = "heidenhain"
period_ms = 3.0                         # 1 to 6: TNC 640, iTNC 530: path interpolation each 3 ms
block_time_ms = 0.5                     # 0.5 to 4: TNC 640: 0.5 ms for a 3-D line; older iTNC 530 3.6
corner = { law = "blend", tolerance_mm = 0.02 }  # 0.005 to 0.05: estimate; tolerance without cycle 32, a machine parameter

[control.mode.cycle32]
corner = { law = "blend", tolerance_mm = 0.02 }  # 0.005 to 0.05: T of cycle 32 counts
acceleration_law = "bell"
bell_time_ms = 25.0                     # 10 to 60: estimate; twice acceleration over jerk

[axis.x]
max_velocity_mm_per_min = 36000.0       # 20000 to 60000: data sheets of machines with this control
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 2000 to 10000: estimate
position_gain_per_s = 80.0              # 50 to 150: estimate; feed-forward control
feed_forward_percent = 98.0             # 90 to 100: estimate; feed-forward control is the rule
stiffness_N_per_um = 50.0               # 20 to 150: estimate

[axis.z]
max_velocity_mm_per_min = 36000.0       # 20000 to 60000: data sheets of machines with this control
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 2000 to 10000: estimate
position_gain_per_s = 80.0              # 50 to 150: estimate; feed-forward control
feed_forward_percent = 98.0             # 90 to 100: estimate; feed-forward control is the rule
stiffness_N_per_um = 60.0               # 20 to 150: estimate

[cycle]
acceleration_law = "bell"
bell_time_ms = 25.0                     # 10 to 60: estimate; twice acceleration over jerk

[spindle]
max_rpm = 18000.0                       # 8000 to 30000: data sheets

[tool_change]
chip_to_chip_s = 5.5                    # 3 to 10: Takata 5.5
)";

constexpr std::string_view kSinumerik840d = R"([control]
dialect = "siemens"
period_ms = 4.0                         # 1 to 12: MD10070 x MD10050: interpolation each 2 to 8 ms
block_time_ms = 1.0                     # 0.3 to 4: estimate; 840D sl by its processor, 810D and 828D more
corner = { law = "speed_difference", speed_difference_mm_per_min = 1440 }  # 300 to 5000: MD32310 = 1.2: 1.2 x acceleration x period

[control.mode.cycle832]
corner = { law = "blend", tolerance_mm = 0.1 }  # 0.01 to 0.2: tolerance of CYCLE832 counts; else MD33100: 0.1
acceleration_law = "bell"
bell_time_ms = 30.0                     # 10 to 80: estimate

[control.mode.brisk]
acceleration_law = "linear"

[control.mode.soft]
acceleration_law = "bell"
bell_time_ms = 40.0                     # 15 to 100: estimate; twice acceleration over jerk (MD32431)

[axis.x]
max_velocity_mm_per_min = 40000.0       # 20000 to 60000: data sheets of machines with this control
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 1000 to 10000: estimate; MD32300
position_gain_per_s = 66.0              # 16 to 150: MD32200: 1 to 9 (m/min)/mm
feed_forward_percent = 98.0             # 0 to 100: estimate; FFWON is the rule, FFWOF: 0
stiffness_N_per_um = 50.0               # 20 to 150: estimate

[axis.z]
max_velocity_mm_per_min = 40000.0       # 20000 to 60000: data sheets of machines with this control
max_feed_mm_per_min = 20000.0           # 10000 to 40000: estimate
acceleration_mm_per_s2 = 5000.0         # 1000 to 10000: estimate; MD32300
position_gain_per_s = 66.0              # 16 to 150: MD32200: 1 to 9 (m/min)/mm
feed_forward_percent = 98.0             # 0 to 100: estimate; FFWON is the rule, FFWOF: 0
stiffness_N_per_um = 60.0               # 20 to 150: estimate

[spindle]
max_rpm = 18000.0                       # 8000 to 30000: data sheets

[tool_change]
chip_to_chip_s = 5.5                    # 3 to 10: Takata 5.5
)";

/// Cycles by which programs of Heidenhain and Siemens give the tolerance, on machines of any control.
constexpr std::string_view kToleranceCycles = R"(
[control.mode.cycle32]
corner = { law = "blend", tolerance_mm = 0.02 }  # 0.005 to 0.05: T of cycle 32 counts

[control.mode.cycle832]
corner = { law = "blend", tolerance_mm = 0.1 }  # 0.01 to 0.2: tolerance of CYCLE832 counts; else MD33100: 0.1
)";

/// Y is as X where a preset does not give it; the trunnion of "-bc" tilts about Y instead of X.
std::string text_of(const MachinePreset& preset) {
  constexpr std::string_view kX = "[axis.x]\n";
  constexpr std::array<std::array<std::string_view, 2>, 5> kTiltsAboutY{{{"\"c\", \"a\"", "\"c\", \"b\""},
                                                                         {"about X", "about Y"},
                                                                         {"[axis.a]", "[axis.b]"},
                                                                         {"[1, 0, 0]", "[0, 1, 0]"},
                                                                         {"as A", "as B"}}};
  std::string out(preset.toml);
  if (preset.name != "router" && out.find("[control.mode.") == std::string::npos) out += kToleranceCycles;
  const std::size_t x = out.find(kX) + kX.size(), z = out.find("[axis.z]");
  if (out.find("[axis.y]") == std::string::npos) out.insert(z, "[axis.y]\n" + out.substr(x, z - x));
  if (preset.name.ends_with("-bc"))
    for (const auto& [of_x, of_y] : kTiltsAboutY) out.replace(out.find(of_x), of_x.size(), of_y);
  return out;
}

constexpr std::array kPresets{
    MachinePreset{"router", "a router for wood, plastics and light alloys, stepper motors", kRouter},
    MachinePreset{"vmc-40", "a vertical machining centre, ball screws, taper 40", kVmc40},
    MachinePreset{"vmc-linear", "a vertical machining centre with linear motors", kVmcLinear},
    MachinePreset{"hsc-die-mould", "a high speed machine for dies and moulds", kHscDieMould},
    MachinePreset{"five-axis-trunnion", "a five-axis machining centre, tilting trunnion (A) and rotary table (C)",
                  kFiveAxisTrunnion},
    MachinePreset{"five-axis-trunnion-bc", "a five-axis machining centre, tilting trunnion (B) and rotary table (C)",
                  kFiveAxisTrunnion},
    MachinePreset{"tnc-640", "a machining centre with a Heidenhain TNC 640 or iTNC 530", kTnc640},
    MachinePreset{"sinumerik-840d", "a machining centre with a Sinumerik 840D sl or 828D", kSinumerik840d},
};

}  // namespace

std::span<const MachinePreset> machine_presets() { return kPresets; }

bool is_preset(std::string_view machine_path) { return machine_path.starts_with(kPresetPrefix); }

const MachinePreset* find_machine_preset(std::string_view machine_path) {
  if (!is_preset(machine_path)) return nullptr;
  const auto at = std::ranges::find(kPresets, machine_path.substr(kPresetPrefix.size()), &MachinePreset::name);
  return at == kPresets.end() ? nullptr : &*at;
}

std::string unknown_machine_preset(std::string_view machine_path) {
  std::vector<std::string> names;
  for (const MachinePreset& preset : kPresets) names.push_back(std::string(kPresetPrefix) + std::string(preset.name));
  const std::string near = nearest_word(machine_path, names);
  return fmt::format("there is no machine preset \"{}\"{}; {} was expected", machine_path,
                     near.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", near), fmt::join(names, ", "));
}

std::string machine_preset_text(const MachinePreset& preset) {
  return fmt::format(
      "# {}: typical values. Behind each: the range over such machines, and where the value comes from.\n"
      "# Replace the values by those of your machine (docs/guide/machine-file.md), then delete the next line: until\n"
      "# then every result says that the machine is assumed.\n"
      "assumed = \"{}{}\"\n\n{}",
      preset.what, kPresetPrefix, preset.name, text_of(preset));
}

}  // namespace camber::machine
