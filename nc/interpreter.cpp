#include "nc/interpreter.h"

#include <algorithm>

#include <fmt/format.h>

#include "nc/block_interpreter.h"
#include "nc/durations.h"
#include "nc/iso_language.h"
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
  read_radius_number();
  if (!words_.g().empty() && !read_g_codes()) return false;
  scale_whole_numbers();
  read_feed();
  read_spindle_speed();
  read_tool();
  if (!words_.m().empty() && !read_m_codes_before()) return false;
  check_letters();
  if (options_.dialect_or_default().strict) check_strict_block();
  read_rotary_words();
  if (radius_.active) check_radius_block();
  const std::size_t moves_before = out_.moves.size();
  if (request_.skip_motion) {
    words_.use("XYZIJKPQR");
  } else if (request_.frame_code.word) {
    run_frame_code();
  } else if (request_.dwell) {
    dwell();
    if (options_.dialect_or_default().dwell_takes_p_alone) move_after_dwell();
  } else if (request_.return_from_reference) {
    return_from_reference();
  } else if (request_.reference) {
    go_to_reference();
  } else if (request_.machine_frame) {
    go_in_machine_frame();
  } else {
    move();
  }
  finish_corner(moves_before);
  if (!words_.corner_words().empty()) read_corner_words(moves_before);
  const bool go_on = words_.m().empty() || read_m_codes_after();
  warn_of_unused_words();
  return go_on;
}

void BlockInterpreter::finish() {
  if (corner_.waits && !report_.has_errors())
    report_.error(corner_.offset, "corner-word",
                  fmt::format("{} is not followed by a further move; G1, G2 or G3 was expected", corner_.text));
  warn_of_whole_numbers();
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

/// Returns the unit of a number without a point that counts increments: of a length, an angle or a time; 1 for letters
/// that are no quantities in this block.
double BlockInterpreter::whole_number_unit(char letter, bool& is_angle) const {
  const Dialect& dialect = options_.dialect_or_default();
  constexpr double kTime_s = 0.001;
  const double length = state_.inch ? dialect.least_increment_inch : dialect.least_increment_mm;
  const int frame_code = request_.frame_code.word ? request_.frame_code.tenths : 0;
  const bool arc = motion_ == Motion::clockwise || motion_ == Motion::counter_clockwise;
  is_angle = std::string_view("ABCa").find(letter) != std::string_view::npos ||
             (letter == 'R' && (frame_code == 680 || frame_code == 682)) ||
             (letter >= 'I' && letter <= 'K' && frame_code == 682) ||
             (frame_.polar && letter == "XYZ"[axes_of(plane_).second]);
  if (request_.dwell && (letter == 'X' || letter == 'U')) return kTime_s;
  if (is_angle) return dialect.least_increment_deg;
  switch (letter) {
    case 'F':
      if (state_.feed_mode == FeedMode::inverse_time) return 1;
      if (state_.feed_mode == FeedMode::per_revolution)
        return state_.inch ? dialect.whole_feed_per_turn_inch : dialect.whole_feed_per_turn_mm;
      return state_.inch ? dialect.whole_feed_inch : dialect.whole_feed_mm;
    case 'I':
    case 'J':
      return frame_code == 510 ? 1 : length;  // scales: see scale_value
    case 'K': {
      const bool of_cycle =
          cycle_.g != 0 && !(dialect.pecks_by_ijk && (cycle_.g == 73 || cycle_.g == 83)) && plane_ == Plane::xy;
      return frame_code == 510 || of_cycle ? 1 : length;  // of a cycle: repeats
    }
    case 'Q':
      return cycle_.g != 0 || arc ? length : 1;
    default:
      return length;
  }
}

/// Returns that unit where the word is a number without a point and numbers are increments, else 1. Notes what depends
/// on it.
double BlockInterpreter::whole_number_scale_of(const Word& word) {
  const bool known = options_.whole_numbers_are_increments.has_value();
  const bool increments = options_.whole_numbers_are_increments.value_or(false);
  if ((known && !increments) || word.value == 0) return 1;
  const char letter = word.letter;
  const bool place = letter >= 'X' && letter <= 'Z';
  if (word.value != std::floor(word.value) || written_with_point(word)) {
    whole_numbers_.any_point |= place;
    return 1;
  }
  if (!written_as_number(word)) return 1;  // the value of a variable counts whole units
  bool is_angle = false;
  const double unit = whole_number_unit(letter, is_angle);
  if (increments) return unit;
  if (unit == 1 || letter == 'F') return 1;
  WholeNumbers& noted = whole_numbers_;
  if (place && !request_.dwell) noted.largest_mm = std::max(noted.largest_mm, std::abs(word.value) * unit_mm());
  if (noted.file) {
    ++noted.more;
    return 1;
  }
  noted.file = program_;
  noted.offset = word.offset;
  noted.text = program_->source.text().substr(word.offset, word.length);
  noted.value = word.value;
  noted.scale = unit;
  noted.is_time = request_.dwell && (letter == 'X' || letter == 'U');
  noted.is_angle = !noted.is_time && is_angle;
  noted.inch = state_.inch;
  return 1;
}

void BlockInterpreter::scale_whole_numbers() {
  if (options_.dialect_or_default().whole_numbers_setting.empty() && !options_.whole_numbers_are_increments) return;
  if (options_.whole_numbers_are_increments && !*options_.whole_numbers_are_increments) return;
  for (const char letter : std::string_view("XYZUVWIJKRQABCF")) {
    if (!words_.has(letter)) continue;
    const double scale = whole_number_scale_of(words_.word(letter));
    if (scale == 1) continue;
    words_.scale(letter, scale);
    editable_ = false;
  }
}

RunVerdict BlockInterpreter::verdict() const {
  constexpr double kLargestMachine_mm = 10'000;
  RunVerdict out;
  out.centres_look_absolute = arcs_fit_absolute_ > 0 && arcs_fit_relative_ == 0 && !centre_mode_given_;
  const WholeNumbers& w = whole_numbers_;
  if (options_.whole_numbers_are_increments || w.file != main_ || w.any_point || w.largest_mm <= kLargestMachine_mm)
    return out;
  out.increments_offset = w.offset;
  out.increments_warning = fmt::format(
      "no coordinate has a decimal point, and as millimetres or inches they would lie up to {:.0f} mm away; they are "
      "read as least increments ({} is {}), for a control set so ({}); else: [control] whole_numbers = \"units\" in "
      "machine.toml",
      w.largest_mm, w.text, w.read_with(w.scale), whole_numbers_setting());
  return out;
}

/// "50 mm", "0.05 mm", "2 s", "45 degrees".
std::string BlockInterpreter::WholeNumbers::read_with(double factor) const {
  const double number = value * factor;
  return is_time    ? fmt::format("{:g} s", number)
         : is_angle ? fmt::format("{:g} degrees", number)
         : inch     ? fmt::format("{:g} inch", number)
                    : fmt::format("{:g} mm", number);
}

void BlockInterpreter::warn_of_whole_numbers() {
  const WholeNumbers& w = whole_numbers_;
  if (options_.whole_numbers_are_increments || !options_.dialect || !w.file) return;  // no control is named
  report_.set_source(w.file->source);
  report_.warning(
      w.offset, "decimal-point",
      fmt::format("{}{} no decimal point; {} is read as {}, but a control set to least increments ({}) reads {}: "
                  "--least-increments, or [control] whole_numbers in machine.toml, says which",
                  w.text, w.more > 0 ? fmt::format(" and {} further words have", w.more) : std::string(" has"), w.text,
                  w.read_with(1), whole_numbers_setting(), w.read_with(w.scale)));
}

/// Returns the name of the control's setting; where no control is named, those of all.
std::string BlockInterpreter::whole_numbers_setting() const {
  if (options_.dialect) return std::string(options_.dialect->whole_numbers_setting);
  std::string out;
  for (const Dialect& dialect : dialects())
    if (!dialect.whole_numbers_setting.empty())
      out += fmt::format("{}{}: {}", out.empty() ? "" : "; ", dialect.title, dialect.whole_numbers_setting);
  return out;
}

namespace {

/// Runs the program once.
void run_program(ProgramFiles& files, const InterpreterOptions& options, Reporter& report, Interpretation& out,
                 RunVerdict& verdict) {
  Sequencer sequencer(files, options, report, out);
  sequencer.run();
  out.whole_numbers_are_increments = options.whole_numbers_are_increments.value_or(false);
  verdict = sequencer.verdict();
}

/// The dialect that the text shows where none is named, and what it says of dwells and of numbers without a point.
InterpreterOptions settled(const Program& program, InterpreterOptions options) {
  if (const Dialect* shown = dialect_shown_by(program); shown && !options.dialect) options.dialect = *shown;
  if (options.dialect) options.dwell_p_is_ms |= options.dialect->dwell_p_is_ms;
  const Dialect& dialect = options.dialect_or_default();
  if (!options.whole_numbers_are_increments) {
    if (dialect.whole_numbers_are_increments) options.whole_numbers_are_increments = true;
    if (dialect.whole_numbers_setting.empty()) options.whole_numbers_are_increments = false;
  }
  return options;
}

/// Some CAM systems write absolute arc centres and leave G90.1 to the control. It shows: no arc fits otherwise.
bool try_absolute_centres(ProgramFiles& files, InterpreterOptions options, Diagnostics& diagnostics,
                          Interpretation& found) {
  options.absolute_arc_centre = true;
  files.forget_runs();
  const Program& program = files.main();
  Interpretation out;
  Reporter report(program.source, diagnostics);
  RunVerdict verdict;
  run_program(files, options, report, out, verdict);
  if (report.has_errors()) return false;
  const auto first_arc = std::find_if(out.moves.begin(), out.moves.end(), [](const Move& m) { return m.arc == 0; });
  report.warning(
      program.offset_of(first_arc->block), "arc-centre",
      fmt::format("the {} arcs of the program fit with absolute centres only; G90.1 is assumed", out.arcs.size()));
  check_durations(program, out, report);
  report.finish();
  found = std::move(out);
  return true;
}

}  // namespace

Interpretation interpret_iso(const Program& program, const InterpreterOptions& wanted, Diagnostics& diagnostics) {
  InterpreterOptions options = settled(program, wanted);
  Interpretation out;
  ProgramFiles files(program, diagnostics);
  Reporter report(program.source, diagnostics);
  RunVerdict verdict;
  run_program(files, options, report, out, verdict);
  if (!verdict.increments_warning.empty()) {
    options.whole_numbers_are_increments = true;
    files.forget_runs();
    report.forget();
    out = {};
    report.warning(verdict.increments_offset, "decimal-point", verdict.increments_warning);
    run_program(files, options, report, out, verdict);
  }
  if (verdict.centres_look_absolute && !options.absolute_arc_centre &&
      try_absolute_centres(files, options, diagnostics, out))
    return out;
  check_durations(program, out, report);
  report.finish();
  return out;
}

}  // namespace camber::nc
