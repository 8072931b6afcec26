#include "nc/interpreter.h"

#include <algorithm>

#include <fmt/format.h>

#include "nc/block_interpreter.h"
#include "nc/durations.h"
#include "nc/program_files.h"
#include "nc/sequencer.h"

namespace camber::nc {

BlockInterpreter::BlockInterpreter(const Program& program, const InterpreterOptions& options, Reporter& report,
                                   Interpretation& out)
    : main_(&program),
      program_(&program),
      options_(options),
      report_(report),
      out_(out),
      frames_(options.work_offsets_mm),
      frames_used_(!options.work_offsets_mm.empty()),
      tool_offsets_(options.tool_offsets) {
  for (const auto& [number, angles] : options.rotary_offsets_rad) frames_.offsets.at(number).rotary_rad = angles;
  start_open_ = !options.rotary_axes.empty();  // nobody knows where the machine stands
  state_.inch = options.inch.value_or(false);
  state_.absolute_arc_centre = options.absolute_arc_centre;
  unit_given_ = options.inch.has_value();
  update_frame();
}

bool BlockInterpreter::run(const RunBlock& block) {
  if (block.words.empty()) return true;
  program_ = &block.program;
  block_ = block.called_from;
  editable_ = block.editable;
  request_ = {};
  words_.read(block.words, report_);
  if (!words_.g().empty() && !read_g_codes()) return false;
  if (options_.whole_numbers_are_increments) scale_whole_numbers();
  read_feed();
  read_spindle_speed();
  read_tool();
  if (!words_.m().empty() && !read_m_codes_before()) return false;
  check_letters();
  read_rotary_words();
  if (radius_.active) check_radius_block();
  if (request_.skip_motion) {
    words_.use("XYZIJKPQR");
  } else if (request_.frame_code.word) {
    run_frame_code();
  } else if (request_.dwell) {
    dwell();
  } else if (request_.return_from_reference) {
    return_from_reference();
  } else if (request_.reference) {
    go_to_reference();
  } else if (request_.machine_frame) {
    go_in_machine_frame();
  } else {
    move();
  }
  const bool go_on = words_.m().empty() || read_m_codes_after();
  warn_of_unused_words();
  return go_on;
}

void BlockInterpreter::finish() {
  if (radius_.active) {
    const Radius radius = radius_;
    end_radius();
    const std::string message = fmt::format(
        "G{} is never cancelled; G40 with a straight move off the contour was expected "
        "before the end",
        radius.g_tenths / 10);
    if (radius.radius_mm != 0 && !report_.has_errors())
      report_.error(radius.offset, "cutter-radius", message);
    else if (radius.radius_mm == 0)
      report_.warning(radius.offset, "cutter-radius", message);
  }
  if (next_tool_ >= 0 && !tool_changed_)
    report_.warning(tool_word_offset_, "tool-not-changed",
                    "the program selects tools (T) but never changes one; M6 was expected, all moves count as tool 0");
}

void BlockInterpreter::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  request_.trouble = true;
  report_.error(offset, check, std::move(message), alike);
}

std::string BlockInterpreter::code_text(const Code& code) const {
  const char letter = code.word->letter;
  if (code.tenths < 0) return program_->source.text().substr(code.word->offset, code.word->length);
  if (code.tenths % 10 == 0) return fmt::format("{}{}", letter, code.tenths / 10);
  return fmt::format("{}{}.{}", letter, code.tenths / 10, code.tenths % 10);
}

bool BlockInterpreter::written_with_point(const Word& word) const {
  return std::string_view(program_->source.text()).substr(word.offset, word.length).find('.') != std::string_view::npos;
}

bool BlockInterpreter::written_as_number(const Word& word) const {
  return std::string_view(program_->source.text())
             .substr(word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at))
             .find_first_of("#[ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz") == std::string_view::npos;
}

MachineFacts BlockInterpreter::facts() const {
  MachineFacts f;
  f.position_mm = position_mm_;
  f.unit_mm = unit_mm();
  f.state = &state_;
  f.motion_g = motion_ == Motion::none ? 0 : static_cast<int>(motion_) - 1;
  f.plane_g = plane_ == Plane::xy ? 17 : plane_ == Plane::zx ? 18 : 19;
  f.cycle_g = cycle_.g;
  f.return_to_r = return_to_r_;
  if (feed_)
    f.feed = *feed_ * (state_.feed_mode == FeedMode::per_revolution ? 1 / unit_mm()
                       : state_.feed_mode == FeedMode::inverse_time ? 60
                                                                    : 60 / unit_mm());
  f.selected_tool = next_tool_;
  return f;
}

/// X1000 is a number of least increments where the control counts so (G4 X1000 is a time: see dwell_seconds).
void BlockInterpreter::scale_whole_numbers() {
  if (request_.dwell) return;
  const Dialect& dialect = options_.dialect_or_default();
  const double step = state_.inch ? dialect.least_increment_inch : dialect.least_increment_mm;
  for (const char letter : std::string_view("XYZUVWIJKRQABC")) {
    if (!words_.has(letter) || written_with_point(words_.word(letter)) || words_.word(letter).value == 0) continue;
    words_.scale(letter, step);
    editable_ = false;
  }
}

namespace {

/// Runs the program once. Returns what the interpreter thinks of its arc centres.
bool run_program(ProgramFiles& files, const InterpreterOptions& options, Reporter& report, Interpretation& out) {
  Sequencer sequencer(files, options, report, out);
  sequencer.run();
  return sequencer.centres_look_absolute();
}

/// The dialect that the text shows where none is named, and what it says of dwells.
InterpreterOptions settled(const Program& program, InterpreterOptions options) {
  if (const Dialect* shown = dialect_shown_by(program); shown && !options.dialect) options.dialect = *shown;
  if (options.dialect) options.dwell_p_is_ms |= options.dialect->dwell_p_is_ms;
  options.whole_numbers_are_increments |= options.dialect_or_default().whole_numbers_are_increments;
  return options;
}

/// Some CAM systems write absolute arc centres and leave G90.1 to the control. It shows: no arc fits otherwise.
std::optional<Interpretation> try_absolute_centres(ProgramFiles& files, InterpreterOptions options,
                                                   Diagnostics& diagnostics) {
  options.absolute_arc_centre = true;
  files.forget_runs();
  const Program& program = files.main();
  Interpretation out;
  Reporter report(program.source, diagnostics);
  run_program(files, options, report, out);
  if (report.has_errors()) return std::nullopt;
  const auto first_arc = std::find_if(out.moves.begin(), out.moves.end(), [](const Move& m) { return m.arc == 0; });
  report.warning(
      program.words_of(first_arc->block).front().offset, "arc-centre",
      fmt::format("the {} arcs of the program fit with absolute centres only; G90.1 is assumed", out.arcs.size()));
  check_durations(program, out, report);
  report.finish();
  return out;
}

}  // namespace

Interpretation interpret(const Program& program, const InterpreterOptions& wanted, Diagnostics& diagnostics) {
  const InterpreterOptions options = settled(program, wanted);
  Interpretation out;
  ProgramFiles files(program, diagnostics);
  Reporter report(program.source, diagnostics);
  if (run_program(files, options, report, out) && !options.absolute_arc_centre)
    if (auto absolute = try_absolute_centres(files, options, diagnostics)) return std::move(*absolute);
  check_durations(program, out, report);
  report.finish();
  return out;
}

}  // namespace camber::nc
