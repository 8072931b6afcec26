#include "calib/test_piece.h"

#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace camber::calib {
namespace {

constexpr std::array kFeedsPerTooth{1.0 / 300, 1.0 / 150, 1.0 / 75};  // of the diameter
constexpr std::array kOverhang{3.0, 6.0};                             // of the diameter
constexpr std::array<const char*, 2> kLength{"short", "long"};

/// A cell of the block: one tool at one feed. Lengths in diameters, from the cell's corner.
constexpr double kCellX = 5.5, kCellY = 8.5, kEdge = 0.3;
constexpr double kBoreX = 1.4, kBoreY = 1.4;
constexpr double kSlotXY = 4, kSlotXFrom = 1.2, kSlotXTo = 4.2;      // along X at this Y
constexpr double kSlotYX = 4.2, kSlotYFrom = 5.4, kSlotYTo = 7.6;    // along Y at this X
constexpr double kDepth = 0.5, kAllowance = 1.0 / 30, kWiden = 0.1;  // walls stand off the middle line by this

class Program {
 public:
  explicit Program(const TestPieceOptions& options) : d_(options.diameter_mm), options_(options) {
    text_ = "%\n(TEST PIECE FOR CAMBER FIT-PARTS)\n(BLOCK";
    text_ += fmt::format(" {:.0f} X {:.0f} X {:.0f} MM, ITS UPPER CORNER AT X0 Y0 Z0)\n",
                         3 * kCellX * d_ + 2 * kEdge * d_, 2 * kCellY * d_ + 2 * kEdge * d_, 2 * d_);
    text_ += "G21 G17 G40 G49 G80 G90\n";
  }

  std::string run() {
    for (int tool = 0; tool < 2; ++tool) {
      add(fmt::format("T{} M6 ({}, {:.0f} MM STICK-OUT)\nG0 G54 X0. Y0. S{:.0f} M3\nG0 Z5.\n", tool + 1,
                      tool == 0 ? "SHORT" : "LONG", kOverhang[static_cast<std::size_t>(tool)] * d_,
                      options_.spindle_rpm));
      for (int feed = 0; feed < 3; ++feed) cell(tool, feed);
    }
    return text_ + "G0 Z50.\nM30\n%\n";
  }

  double corner_x(int feed) const { return (kEdge + feed * kCellX) * d_; }
  double corner_y(int tool) const { return (kEdge + tool * kCellY) * d_; }
  double feed_mm_per_min(int feed) const {
    return kFeedsPerTooth[static_cast<std::size_t>(feed)] * d_ * options_.flutes * options_.spindle_rpm;
  }

 private:
  void add(const std::string& lines) { text_ += lines; }

  void cell(int tool, int feed) {
    x_ = corner_x(feed), y_ = corner_y(tool);
    const double f = feed_mm_per_min(feed);
    bore(f);
    slot({kSlotXFrom, kSlotXY}, {kSlotXTo, kSlotXY}, f);
    slot({kSlotYX, kSlotYFrom}, {kSlotYX, kSlotYTo}, f);
  }

  /// Down a helix that leaves the allowance, then a circle at full depth.
  void bore(double feed) {
    const double x = x_ + kBoreX * d_, y = y_ + kBoreY * d_, r = d_ / 2, rough = r - kAllowance * d_;
    const double depth = kDepth * d_;
    constexpr int kTurns = 6;
    add(fmt::format("G0 X{:.4f} Y{:.4f}\nG0 Z1.\nG1 Z0. F{:.1f}\n", x + rough, y, feed));
    for (int i = 1; i <= kTurns; ++i) add(fmt::format("G3 I{:.4f} J0. Z{:.4f}\n", -rough, -depth * i / kTurns));
    add(fmt::format("G3 I{:.4f} J0.\nG3 X{:.4f} Y{:.4f} I{:.4f} J0.\n", -rough, x - r, y, -(rough + r) / 2));
    add(fmt::format("G3 I{:.4f} J0.\nG3 X{:.4f} Y{:.4f} I{:.4f} J0.\nG0 Z5.\n", r, x + rough, y, (rough + r) / 2));
  }

  /// To and fro down the middle line, then around both walls.
  void slot(std::array<double, 2> from, std::array<double, 2> to, double feed) {
    const double ax = x_ + from[0] * d_, ay = y_ + from[1] * d_, bx = x_ + to[0] * d_, by = y_ + to[1] * d_;
    const bool along_x = from[1] == to[1];
    const double depth = kDepth * d_, w = kWiden * d_, rough = w - kAllowance * d_;
    constexpr int kPasses = 6;
    add(fmt::format("G0 X{:.4f} Y{:.4f}\nG0 Z1.\nG1 Z0. F{:.1f}\n", ax, ay, feed));
    for (int i = 1; i <= kPasses; ++i)
      add(fmt::format("G1 X{:.4f} Y{:.4f} Z{:.4f}\n", i % 2 == 1 ? bx : ax, i % 2 == 1 ? by : ay,
                      -depth * i / kPasses));
    add(fmt::format("G1 X{:.4f} Y{:.4f}\nG1 X{:.4f} Y{:.4f}\n", bx, by, ax, ay));
    for (const double off : {rough, w}) {
      const double ox = along_x ? 0 : off, oy = along_x ? -off : 0;
      add(fmt::format("G1 X{:.4f} Y{:.4f}\nG1 X{:.4f} Y{:.4f}\n", ax + ox, ay + oy, bx + ox, by + oy));
      add(fmt::format("G3 X{:.4f} Y{:.4f} I{:.4f} J{:.4f}\n", bx - ox, by - oy, -ox, -oy));
      add(fmt::format("G1 X{:.4f} Y{:.4f}\n", ax - ox, ay - oy));
      add(fmt::format("G3 X{:.4f} Y{:.4f} I{:.4f} J{:.4f}\n", ax + ox, ay + oy, ox, oy));
    }
    add(fmt::format("G1 X{:.4f} Y{:.4f}\nG0 Z5.\n", ax, ay));
  }

  double d_;
  const TestPieceOptions& options_;
  std::string text_;
  double x_ = 0, y_ = 0;
};

std::string tool_toml(int tool, const TestPieceOptions& o) {
  return fmt::format(
      "\n[tool.{}]                        # {}\ntype = \"flat\"\ndiameter_mm = {:g}\nflutes = {}\nhelix_deg = 30\n"
      "overhang_mm = {:g}              # holder face to tip: clamp it like this, or write what it is\n"
      "flute_length_mm = {:g}\nroot_stiffness_N_per_um = 20   # fit-parts finds it\n",
      tool + 1, kLength[static_cast<std::size_t>(tool)], o.diameter_mm, o.flutes,
      kOverhang[static_cast<std::size_t>(tool)] * o.diameter_mm, 2.5 * o.diameter_mm);
}

struct Entry {
  std::string name, kind;
  std::array<double, 4> from_to;
  double nominal = 0;
};

std::vector<Entry> features_of(const Program& program, int tool, int feed, double d) {
  const double x = program.corner_x(feed), y = program.corner_y(tool);
  const std::string which =
      fmt::format("{} F{:.0f}", kLength[static_cast<std::size_t>(tool)], program.feed_mm_per_min(feed));
  const double bx = x + kBoreX * d, by = y + kBoreY * d, width = d + 2 * kWiden * d;
  return {{"bore " + which, "bore", {bx, by, bx, by}, 2 * d},
          {"slot x " + which,
           "slot_width",
           {x + kSlotXFrom * d, y + kSlotXY * d, x + kSlotXTo * d, y + kSlotXY * d},
           width},
          {"slot y " + which,
           "slot_width",
           {x + kSlotYX * d, y + kSlotYFrom * d, x + kSlotYX * d, y + kSlotYTo * d},
           width}};
}

std::string feature_toml(const Entry& e, int tool, double depth) {
  const bool bore = e.kind == "bore";
  return fmt::format(
      "\n[[feature]]\nname = \"{}\"\nkind = \"{}\"\naxis_mm = [[{:.4f}, {:.4f}, 0], [{:.4f}, {:.4f}, {:g}]]\n"
      "nominal_mm = {:g}\ndepth_mm = {:g}\ntool = {}\nmeasured = \"measured.csv\"\n",
      e.name, e.kind, e.from_to[0], e.from_to[1], e.from_to[2], e.from_to[3], bore ? -depth : 0, e.nominal, depth / 2,
      tool + 1);
}

}  // namespace

std::vector<TestPieceFile> test_piece(const std::string& machine_path, const TestPieceOptions& o) {
  const double d = o.diameter_mm, depth = kDepth * d;
  Program program(o);
  std::string job = fmt::format(
      "# The test piece of camber protocol --part. Cut it, measure it, fill in measured.csv, then\n"
      "#   camber fit-parts job.toml -o fitted --suggest\n"
      "program = \"test_piece.nc\"\nmachine = \"{}\"\n",
      machine_path);
  for (int tool = 0; tool < 2; ++tool) job += tool_toml(tool, o);
  job += "\n[material]                      # what the block is made of (docs/materials.md)\npreset = \"6061\"\n";
  job += fmt::format("\n[stock]\nbox_mm = [[0, 0, {:g}], [{:g}, {:g}, 0]]\n\n[simulation]\nvoxel_mm = {:g}\n", -2 * d,
                     (3 * kCellX + 2 * kEdge) * d, (2 * kCellY + 2 * kEdge) * d, d / 40);
  std::string table =
      "# value_mm: what the measuring machine says, half way down; one line for each part and feature\n"
      "feature,part,date,value_mm\n";
  for (int tool = 0; tool < 2; ++tool)
    for (int feed = 0; feed < 3; ++feed)
      for (const Entry& e : features_of(program, tool, feed, d)) {
        job += feature_toml(e, tool, depth);
        table += fmt::format("{},1,,\n", e.name);
      }
  return {{"test_piece.nc", "cuts bores and slots with a short and a long tool at three feeds", program.run()},
          {"job.toml", "the same as a job, with its features", job},
          {"measured.csv", "to be filled in", table}};
}

}  // namespace camber::calib
