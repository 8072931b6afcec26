// Drilling cycles G73 and G81 to G89 as the moves that they stand for.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "nc/machine_state.h"

namespace camber::nc {
namespace {

constexpr double kPeckClearance_mm =
    0.25;  // above the last depth, where G83 goes back to rapid and G73 breaks the chip
constexpr double kMostPecks = 10000;

/// Down in pecks. G83 clears the hole each time, G73 only breaks the chip.
void peck(MachineState& s, const BlockWords& words, const Vec3& top, double feed, MoveWriter& writer) {
  const double q = s.cycle.q_mm, depth = top.z() - s.cycle.z_mm;
  if (q <= 0 || depth / q > kMostPecks) {
    words.error(words.word('Q'),
                fmt::format("G{} with Q{:g} mm for a hole of {:g} mm; a peck of a sensible depth was expected",
                            s.cycle.code, q, depth),
                "cycle-peck");
    return;
  }
  const Vec3 down = -Vec3::UnitZ();
  for (double reached = 0; reached < depth - 1e-9;) {
    const double next = std::min(reached + q, depth);
    writer.line(top + next * down, feed, true);
    reached = next;
    if (reached >= depth - 1e-9) break;
    if (s.cycle.code == 83) {
      writer.rapid(top, false, true);
      writer.rapid(top + std::max(0.0, reached - kPeckClearance_mm) * down, false, true);
    } else {
      writer.rapid(top + std::max(0.0, reached - kPeckClearance_mm) * down, false, true);
    }
  }
}

void one_hole(MachineState& s, const BlockWords& words, const Vec3& at, double feed, MoveWriter& writer) {
  const CannedCycle& c = s.cycle;
  const auto height = [&](double z) { return Vec3(at.x(), at.y(), z); };
  const bool reference = !s.all_known();
  writer.rapid(height(s.position_mm.z()), reference, true);
  s.known = {true, true, true};
  writer.rapid(height(c.r_mm), reference, true);
  if (c.code == 73 || c.code == 83)
    peck(s, words, height(c.r_mm), feed, writer);
  else
    writer.line(height(c.z_mm), feed, true);
  if (c.p_s > 0) writer.dwell(c.p_s, true);
  // Taps, reamers and boring bars come out at the feed.
  if (c.code == 74 || c.code == 84 || c.code == 85 || c.code == 89) writer.line(height(c.r_mm), feed, true);
  writer.rapid(height(s.retract_to_r ? c.r_mm : std::max(c.r_mm, c.initial_z_mm)), false, true);
}

}  // namespace

void run_cycle(MachineState& s, const BlockWords& words, const Vec3& at, int repeats, const Vec3& increment,
               MoveWriter& writer) {
  const std::string name = fmt::format("G{}", s.cycle.code);
  const auto feed = cutting_feed(s, words, s.cycle.r_mm - s.cycle.z_mm, name.c_str());
  if (!feed) return;
  if (s.cycle.z_mm > s.cycle.r_mm) {
    words.error(words.word('Z'),
                fmt::format("{}: Z {:g} mm lies above R {:g} mm; a hole below R was expected", name, s.cycle.z_mm,
                            s.cycle.r_mm),
                "cycle-depth");
    return;
  }
  for (int i = 0; i < repeats; ++i) one_hole(s, words, at + i * increment, *feed, writer);
}

}  // namespace camber::nc
