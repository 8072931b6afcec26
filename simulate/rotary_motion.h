#pragma once
// Programs that turn rotary axes, for the commands that cut: their moves as the text has them, and on the part.
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "base/diagnostics.h"
#include "feedmodel/part_tracking.h"
#include "feedmodel/timed_path.h"
#include "kinematics/part_path.h"
#include "machine/job_file.h"
#include "nc/interpreter.h"
#include "nc/program.h"

namespace camber::simulate {

/// The moves in the coordinates of the program's text, with lines as the machine runs them, and the tool along them.
class RotaryMotion {
 public:
  RotaryMotion(const machine::Machine& machine, nc::Interpretation text)
      : text_(std::move(text)), path_(machine, text_) {}
  RotaryMotion(const RotaryMotion&) = delete;
  RotaryMotion& operator=(const RotaryMotion&) = delete;

  const nc::Interpretation& text() const { return text_; }
  const kinematics::PartPath& path() const { return path_; }

 private:
  nc::Interpretation text_;
  kinematics::PartPath path_;  ///< of text_
};

/// As the control of the job's machine reads the program. With `rotary_axes`, words of the axes of its chain are read;
/// the work offset G54 is that of [compensation] work_offset_mm, unless the program sets it (G10 L2). On a preset it is
/// zero where the job has none, and the length of a tool its overhang and its holder's, unless the program sets it.
nc::InterpreterOptions interpreter_options(const machine::Job& job, bool rotary_axes);

/// True where the text has words other than 0 of rotary axes, tool-centre-point control or frames that turn with them,
/// and the machine a chain; true of all programs in Klartext or for a Sinumerik there. Other programs are read as those
/// of a machine without rotary axes.
bool names_rotary_axes(const machine::Machine& machine, const nc::Program& text);

/// Nothing without rotary motion. Errors at the program's blocks:
///  [not-read]                   arcs that are none on the part;
///  [work-offset], [tool-length] the tool's place on the part depends on a value that is not known.
std::shared_ptr<const RotaryMotion> read_rotary_motion(const machine::Machine& machine, const nc::Program& text,
                                                       const nc::Interpretation& moves, Diagnostics& diagnostics);

/// Error [rotary-motion] for commands that read three axes alone; `what` begins the message ("adapt chooses feeds").
void refuse_rotary_motion(const RotaryMotion* rotary, const nc::Program& text, const std::string& what,
                          Diagnostics& diagnostics);

/// predict_joints in the part's frame, run by run.
using PartSink = std::function<void(const feedmodel::PartSamples&)>;
feedmodel::FeedSummary predict_on_part(const RotaryMotion& rotary, const machine::Machine& machine,
                                       const PartSink& sink);

}  // namespace camber::simulate
