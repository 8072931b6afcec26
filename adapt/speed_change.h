#pragma once
// Spindle speeds that keep the limit on chatter, in the text of a program.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "machine/job_file.h"
#include "simulate/predict.h"

namespace camber::adapt {

/// One tool at one programmed spindle speed.
struct SpeedChange {
  int tool = 0;
  double before_rpm = 0, after_rpm = 0;  ///< the same: not changed
  bool measured = false;                 ///< the tool's modes are given; else its beam's, with a usual damping
  std::size_t line = 0, new_line = 0;    ///< worst tooth passing, of the given and of the new program
  double margin_before = 0, margin_after = 0;
  double chatter_hz = 0;     ///< heard at the worst passing of the given program
  double depth_mm = 0;       ///< axial depth there
  double kept_depth_mm = 0;  ///< axial depth that would keep the limit there at the programmed speed
  double best_rpm = 0;       ///< speed with the least margin of those that may be used; 0: not looked for
  double best_depth_mm = 0;  ///< axial depth that would keep the limit at it
  double advised_rpm = 0;    ///< speed that keeps the limit; 0: none, or not looked for
  double probability = 0;    ///< that the new program chatters, with the modes at their errors
  bool kept = false;         ///< the limit is kept
  std::string reason{};      ///< why the speed that keeps the limit is not in the text; empty: it is, or there is none
};

/// For each tool at each programmed speed: its greatest margin, and the speed that would keep the job's limit.
std::vector<SpeedChange> find_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                                            std::span<const simulate::StampLoad> loads);

/// A program with other S words, and F words that keep the chips.
struct SpeedText {
  std::string text;
  std::vector<std::uint32_t> block_of_line;  ///< see nc::Emission
};

/// Sets advised speeds as far as the text allows; `changes` get after_rpm and reason. Nothing is changed: no text.
SpeedText emit_speed_changes(const machine::Job& job, const simulate::SimulatedProgram& program,
                             std::vector<SpeedChange>& changes);

}  // namespace camber::adapt
