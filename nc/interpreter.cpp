#include "nc/interpreter.h"

#include <algorithm>

#include <fmt/format.h>

#include "nc/block_interpreter.h"

namespace camber::nc {

BlockInterpreter::BlockInterpreter(const Program& program, const InterpreterOptions& options, Reporter& report,
                                   Interpretation& out)
    : program_(program),
      options_(options),
      report_(report),
      out_(out),
      frames_(options.work_offsets_mm),
      frames_used_(!options.work_offsets_mm.empty()),
      tool_offsets_(options.tool_offsets) {
  state_.inch = options.inch.value_or(false);
  state_.absolute_arc_centre = options.absolute_arc_centre;
  unit_given_ = options.inch.has_value();
  update_frame();
}

bool BlockInterpreter::run(std::uint32_t block) {
  const auto words = program_.words_of(block);
  if (words.empty() || (program_.blocks[block].skip && options_.skip_slash_blocks)) return true;
  block_ = block;
  request_ = {};
  words_.read(words, report_);
  if (!words_.g().empty() && !read_g_codes()) return false;
  read_feed();
  read_spindle_speed();
  read_tool();
  if (!words_.m().empty() && !read_m_codes_before()) return false;
  check_letters();
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
  if (code.tenths < 0) return program_.source.text().substr(code.word->offset, code.word->length);
  if (code.tenths % 10 == 0) return fmt::format("{}{}", letter, code.tenths / 10);
  return fmt::format("{}{}.{}", letter, code.tenths / 10, code.tenths % 10);
}

bool BlockInterpreter::written_with_point(const Word& word) const {
  return std::string_view(program_.source.text()).substr(word.offset, word.length).find('.') != std::string_view::npos;
}

namespace {

/// The first block behind `block` that still holds words, if any.
std::optional<std::size_t> next_with_words(const Program& program, std::size_t block) {
  for (std::size_t i = block + 1; i < program.blocks.size(); ++i)
    if (program.blocks[i].word_count > 0) return i;
  return std::nullopt;
}

/// Runs the program once. Returns what the interpreter thinks of its arc centres.
bool run_program(const Program& program, const InterpreterOptions& options, Reporter& report, Interpretation& out) {
  BlockInterpreter interpreter(program, options, report, out);
  out.moves.reserve(program.blocks.size());
  const std::size_t blocks = program.blocks.size();
  std::size_t block = 0;
  while (block < blocks && !report.full() && interpreter.run(static_cast<std::uint32_t>(block))) ++block;
  const auto after = block < blocks && !report.has_errors() ? next_with_words(program, block) : std::nullopt;
  if (after)
    report.warning(program.words_of(*after).front().offset, "after-end",
                   "the blocks behind the end of the program (M2, M30) are not run");
  interpreter.finish();
  return interpreter.centres_look_absolute();
}

/// Some CAM systems write absolute arc centres and leave G90.1 to the control. It shows: no arc fits otherwise.
std::optional<Interpretation> try_absolute_centres(const Program& program, InterpreterOptions options,
                                                   Diagnostics& diagnostics) {
  options.absolute_arc_centre = true;
  Interpretation out;
  Reporter report(program.source, diagnostics);
  run_program(program, options, report, out);
  if (report.has_errors()) return std::nullopt;
  const auto first_arc = std::find_if(out.moves.begin(), out.moves.end(), [](const Move& m) { return m.arc == 0; });
  report.warning(
      program.words_of(first_arc->block).front().offset, "arc-centre",
      fmt::format("the {} arcs of the program fit with absolute centres only; G90.1 is assumed", out.arcs.size()));
  report.finish();
  return out;
}

}  // namespace

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  Interpretation out;
  Reporter report(program.source, diagnostics);
  if (run_program(program, options, report, out) && !options.absolute_arc_centre)
    if (auto absolute = try_absolute_centres(program, options, diagnostics)) return std::move(*absolute);
  report.finish();
  return out;
}

}  // namespace camber::nc
