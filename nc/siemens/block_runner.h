#pragma once
// Executes blocks whose words have numbers: gives their words to the parts, each of which has its own state. Which
// block is next: siemens_sequencer.h. Internal to siemens/.
//
//   BlockContext   the block: words, requests, where moves and messages go            siemens_modes
//   Modes          unit, feed, spindle                                                siemens_modes
//   ContourModes   compressors, rounding, CYCLE832                                    siemens_modes
//   ToolWords      T, M6, D                                                           siemens_modes
//   ProgramFrames  work offsets, TRANS, ROT, SCALE, MIRROR                            siemens_frames
//   Mover          makes moves from where the tool and the rotary axes stand          siemens_rotary
//   RadiusWords    G40, G41, G42                                                      siemens_contour
//   PathBlocks     lines, arcs, dwells, machine coordinates                           siemens_motion
//   Corners        RND, CHF, CHR                                                      siemens_contour
//   Cycles         drilling, pockets, threads, patterns                               siemens_cycles
//
// A part calls those above it only.
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "nc/canned_cycles.h"
#include "nc/siemens/siemens_motion.h"

namespace camber::nc::siemens {

class Cycles : MotionParts {
 public:
  explicit Cycles(const MotionParts& parts) : MotionParts(parts) {}

  void drill(const CycleCall& call);
  void mill_thread(const CycleCall& call);
  void mill_pocket(const CycleCall& call);
  void mill_slots(const CycleCall& call);
  void mill_face(const CycleCall& call);
  /// A pattern of holes: the places, in program coordinates. `visit` runs behind each move.
  void run_pattern(const CycleCall& call, const BlockPlace& place, const std::function<void()>& visit);
  void set_stock(const CycleCall& call, std::uint32_t block);

 private:
  void run_pocket(const PocketCycle& pocket, const CycleCall& call);
  double sense_of(int cdir) const;
  double bottom_mm(const CycleCall& call) const;
  bool begin_milling(const CycleCall& call);
  double cutter_radius_mm(const CycleCall& call, bool needed);
  void rapid_to_height(double height_mm);
  void go(CycleStep::Kind kind, const Vec3& program_mm, double feed_mm_per_s, int g);
  void go_round(const Vec3& end, const Vec3& centre, double sweep_rad, double feed_mm_per_s);
  std::optional<double> cycle_feed(double given, const CycleCall& call, const char* what);

  std::size_t count_ = 0;  ///< of the moves of all cycles
};

class BlockRunner : public SystemValues {
 public:
  BlockRunner(const Program& program, const InterpreterOptions& options, Reporter& report, Interpretation& out);
  BlockRunner(const BlockRunner&) = delete;

  // One block: begin, then words, then execute.
  void begin(const BlockPlace& place);
  void add_plain(std::span<const Word> words);
  BlockWords& words() { return at_.words; }
  bool goes_to_fixed_point() const;
  void set_command(const WordRow& row, std::uint32_t offset);
  void set_tool_name(const std::string& name, std::uint32_t offset) { tools_.set_name(name, offset); }
  /// Carries the block out. Returns false at the end of the program (M2, M30); `ends_subprogram`: M17 was in it.
  bool execute(bool& ends_subprogram);
  /// Returns whether the last executed block has moved X, Y or Z: MCALL acts behind it.
  bool has_moved() const { return moved_; }

  void run_cycle(const CycleCall& call, const BlockPlace& place);
  bool drills(const CycleCall& call) const { return call.row->does == Does::drilling; }
  Cycles& cycles() { return cycles_; }
  Modes& modes() { return modes_; }
  void leave_for_machine_place(char axis, const std::string& name, std::uint32_t offset);
  /// OFFN=, CTOL=, RNDM=, FB=, FRC=, FRCM=
  void set_number(const WordRow& row, double value);
  /// POS, POSA: the axis goes there by itself.
  void position_axis(char letter, const Slot& slot);
  void orient_spindle() { at_.add_event(EventKind::spindle_orient, 0); }
  void set_frame_variable(const std::string& name, const std::vector<double>& indexes,
                          const std::vector<std::string>& index_names, const Value& value, std::uint32_t offset);
  void finish();

  struct Saved {
    Motion motion;
    Plane plane;
    bool absolute, inch;
    FeedMode feed_mode;
    Affine programmable;
    int work_offset;
  };
  std::shared_ptr<const Saved> saved_modes() const;
  void restore(const Saved& saved);

  std::optional<Value> system_value(const std::string& name, const std::vector<Value>& indexes,
                                    const std::vector<std::string>& index_names) override;
  double unit_mm() const override { return modes_.unit_mm(); }

 private:
  void read_g_codes();
  void read_g_code(const CodeWord& code);
  void read_m_codes_before();
  bool read_m_codes_after(bool& ends_subprogram);
  void check_letters();

  BlockContext at_;
  Modes modes_{at_};
  ContourModes contouring_{modes_};
  ToolWords tools_{at_, modes_};
  ProgramFrames frames_{at_, modes_};
  Mover mover_{at_, modes_, frames_};
  MotionParts parts_{at_, modes_, tools_, frames_, mover_};
  RadiusWords radius_{parts_};
  PathBlocks path_{parts_};
  Corners corners_{parts_};
  Cycles cycles_{parts_};
  bool moved_ = false;
};

}  // namespace camber::nc::siemens
