#pragma once
// Summary of a program: what a person wants to know before it runs.
#include <cstddef>
#include <limits>
#include <vector>

#include "base/geometry.h"
#include "nc/move.h"
#include "nc/program_text.h"

namespace camber::nc {

/// A box around points; empty until the first one.
struct Extents {
  Vec3 min_mm = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max_mm = Vec3::Constant(-std::numeric_limits<double>::infinity());
  bool empty() const { return min_mm.x() > max_mm.x(); }
  void add(const Vec3& point_mm);
};

/// Smallest and largest of a figure; empty until the first one.
struct Range {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  bool empty() const { return min > max; }
  void add(double value);
};

struct ToolUse {
  int tool = 0;           ///< 0: before any M6
  std::size_t line = 0;   ///< line of its first M6; without one, of its first move
  std::size_t calls = 0;  ///< times it was brought in and used
  std::size_t cutting_moves = 0;
  double cutting_length_mm = 0, rapid_length_mm = 0;
  Range feed_mm_per_min{};    ///< range over its cutting moves
  Range feed_deg_per_min{};   ///< feeds of moves that turn rotary axes alone
  Range spindle_speed_rpm{};  ///< range over its cutting moves
  Extents cutting{};
};

struct Summary {
  std::size_t blocks = 0;  ///< lines of the file
  std::size_t blocks_with_words = 0;
  std::size_t rapids = 0, lines = 0, arcs = 0, dwells = 0;
  std::size_t canned = 0;                 ///< number of these in drilling cycles
  std::size_t high_speed_contouring = 0;  ///< cutting moves among these under G08 P1, G05 P10000 or G05.1 Q1
  std::size_t cutter_radius = 0;          ///< number of these computed under G41, G42
  std::size_t rotary = 0;                 ///< number of these that turn rotary axes
  std::size_t tip_control = 0;            ///< number of these under tool-centre-point control
  std::size_t tilted_frame = 0;           ///< number of these in a tilted frame (G68.2)
  std::size_t dynamic_offset = 0;         ///< number of these under the dynamic work offset (G254)
  std::size_t reference = 0;  ///< number of these to or from the reference point; in no length and no extents
  bool has_mm = false, has_inch = false;
  std::vector<ToolUse> tools;  ///< tools in the order of their first use
  Extents cutting, rapid;
  double cutting_length_mm = 0, rapid_length_mm = 0;
  double dwell_s = 0;
};

/// Box around the whole move, the bulge of an arc included.
Extents extents_of(const Interpretation& program, const Move& move);

Summary summarize(const Program& text, const Interpretation& program);

}  // namespace camber::nc
