#pragma once
// A program on one machine: its text, and its moves in each frame in which somebody needs them.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "base/diagnostics.h"
#include "base/tool_pose.h"
#include "kinematics/part_path.h"
#include "machine/job_file.h"
#include "nc/emit.h"
#include "nc/interpreter.h"
#include "nc/program_text.h"

namespace camber::kinematics {

/// Whether words of rotary axes are read.
enum class RotaryWords : std::uint8_t {
  never,  ///< they are refused, unless `given` names axes
  /// In a text that has words other than 0 of rotary axes, tool-centre-point control or frames that turn with them, and
  /// in all programs in Klartext or for a Sinumerik; where the axes then stay at 0, the program is one of three axes.
  where_named,
  always,
};

/// What is known of a program beside its text and its machine.
struct ReadingOptions {
  nc::InterpreterOptions given{};  ///< the machine's control adds the rest
  RotaryWords rotary = RotaryWords::where_named;
  /// Instead of those given, in a program of which words of rotary axes are read.
  std::map<int, Vec3> work_offsets_mm{};
  std::map<int, nc::ToolOffset> tool_offsets{};
  std::optional<nc::LanguageId> language{};  ///< not given: as the dialect that is given, else as the text shows
};

/// As a job has it: the work offset G54 is that of [compensation] work_offset_mm, unless the program sets it (G10 L2).
/// On a preset it is zero where the job has none, and the length of a tool its overhang and its holder's.
ReadingOptions reading_of(const machine::Job& job);

/// A program on one machine. Moves in a frame are computed once, when they are first asked for; copies share them.
class MachineProgram {
 public:
  MachineProgram() : MachineProgram(nc::Program{}, nc::Interpretation{}) {}
  /// A program of X, Y and Z alone: its moves are the same in every frame.
  MachineProgram(nc::Program text, nc::Interpretation commanded);
  MachineProgram(nc::Program text, nc::Interpretation commanded, const machine::Machine& machine);

  const nc::Program& text() const { return *text_; }
  /// Keeps the file's name alone.
  void give_up_text();

  /// The rotary axes of the machine turn. What follows of them requires check_offsets(Asked::part).
  bool turns() const { return views_ != nullptr; }
  /// As the text has them.
  const nc::Interpretation& commanded() const { return *commanded_; }
  /// In X Y Z of the text, with lines as the machine runs them: edits of the text go by these.
  const nc::Interpretation& moves_in_program() const { return views_ ? placed() : *commanded_; }
  /// On the part, where everything that cuts looks (PartPath::moves_in_part).
  const nc::Interpretation& moves_in_part() const { return views_ ? on_part() : *commanded_; }
  /// Of the linear axes and the angles, as feed models plan them (place_moves).
  const nc::Interpretation& moves_of_axes() const;
  /// Null where nothing turns.
  const PartPath* part_path() const;
  /// The tool on its true path, on the part.
  ToolPose pose_at(std::uint32_t move, double u) const;

 private:
  struct Views;

  const nc::Interpretation& placed() const;
  const nc::Interpretation& on_part() const;

  std::shared_ptr<const nc::Program> text_;
  std::shared_ptr<const nc::Interpretation> commanded_;
  std::shared_ptr<Views> views_;
};

/// The moves of a text as the control of the machine reads it, with the rotary axes of its chain.
nc::Interpretation read_moves(const nc::Program& text, const machine::Machine& machine, const ReadingOptions& options,
                              Diagnostics& diagnostics);

/// Reads and interprets a program; errors are in `diagnostics` alone.
MachineProgram open_program(SourceText source, const machine::Machine& machine, const ReadingOptions& options,
                            Diagnostics& diagnostics);

/// Errors at the program's blocks, for commands that cut, which throw where there are some; nothing without rotary
/// motion:
///  [work-offset], [tool-length]  see check_offsets(Asked::part);
///  [not-read]                    arcs that are none on the part.
void check_on_part(const MachineProgram& program, Diagnostics& diagnostics);

/// Error [rotary-motion] for commands that read three axes alone; `what` begins the message ("adapt chooses feeds").
void refuse_rotary_motion(const MachineProgram& program, const std::string& what, Diagnostics& diagnostics);

/// One per move: rotary axes turn in it. Such a move is not split, since its pieces would need their own angles. Empty
/// without rotary motion.
std::vector<bool> turning_moves(const MachineProgram& program);
/// Edits of a program's moves in the coordinates of its text, with the angles of the rotary axes as they are.
std::vector<nc::MoveEdit> edits_of_text(const MachineProgram& program, std::vector<nc::MoveEdit> edits);

}  // namespace camber::kinematics
