#include "nc/block_interpreter.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

namespace camber::nc {

BlockInterpreter::BlockInterpreter(const Program& program, const InterpreterOptions& options, Reporter& report,
                                   Interpretation& out)
    : at_{options, report, out, program, &program} {}

bool BlockInterpreter::run(const RunBlock& block) {
  if (block.words.empty()) return true;
  at_.program = &block.program;
  at_.block = block.called_from;
  at_.editable = block.editable;
  at_.request = {};
  at_.words.read(block.words, at_.report);
  radius_.read_radius_number();
  if (!at_.words.g().empty() && !read_g_codes()) return false;
  whole_numbers_.scale_block();
  modal_.read_feed();
  modal_.read_spindle_speed();
  modal_.read_tool();
  if (!at_.words.m().empty())
    modal_.read_m_codes_before([&](const Code& c) { return rotary_.read_clamp(c) || rotary_.read_tip_control_m(c); });
  rotary_.check_letters();
  if (at_.dialect().strict) modal_.check_strict_block();
  rotary_.read_rotary_words();
  if (modal_.radius_g() != 0) radius_.check_radius_block();
  const std::size_t moves_before = at_.out.moves.size();
  if (at_.request.skip_motion) {
    at_.words.use("XYZIJKPQR");
  } else if (at_.request.frame_code.word) {
    run_frame_code();
  } else if (at_.request.dwell) {
    dwell();
    if (at_.dialect().dwell_takes_p_alone) move_after_dwell();
  } else if (at_.request.return_from_reference) {
    references_.return_from_reference();
  } else if (at_.request.reference) {
    references_.go_to_reference();
  } else if (at_.request.machine_frame) {
    references_.go_in_machine_frame();
  } else {
    move();
  }
  corners_.finish_corner(moves_before);
  if (!at_.words.corner_words().empty()) corners_.read_corner_words(moves_before);
  const bool go_on = at_.words.m().empty() || modal_.read_m_codes_after();
  warn_of_unused_words();
  return go_on;
}

void BlockInterpreter::finish() {
  corners_.finish();
  whole_numbers_.warn();
  radius_.finish();
  modal_.check_tool_changes();
  at_.relied_ends.fix(at_.out);
}

MachineFacts BlockInterpreter::facts() const {
  MachineFacts f;
  f.position_mm = place_.position_mm;
  modal_.add_facts(f);
  return f;
}

RunVerdict BlockInterpreter::verdict() const {
  RunVerdict out;
  out.centres_look_absolute = arcs_.centres_look_absolute();
  whole_numbers_.add_verdict(out);
  return out;
}

bool BlockInterpreter::read_g_codes() {
  if (at_.words.g().size() > 1) modal_.check_one_of_each_group();
  // Units and feed mode first: they say how the other words of the block are meant.
  for (const Code& code : at_.words.g())
    if (code.tenths == 200 || code.tenths == 210) modal_.set_unit(code.tenths == 200);
  for (const Code& code : at_.words.g())
    if (!read_g_code(code, g_code(code.tenths))) return false;
  return true;
}

bool BlockInterpreter::read_g_code(const Code& code, const GCode& meaning) {
  if (code.tenths == 500 && at_.words.has('S')) {
    at_.error(code.word->offset, "turning",
              "G50 with S (largest spindle speed) belongs to a turning program; milling programs are read");
    return false;
  }
  if (at_.dialect().haas_work_offsets && haas_work_offset_of(code.tenths) > 0) {
    set_work_offset(code);
    return true;
  }
  switch (meaning.group) {
    case GGroup::motion:
      modal_.set_motion(code);
      break;
    case GGroup::cycle:
      if (code.tenths != 800 && modal_.cycle_g() == 0) cycles_.begin();
      modal_.set_cycle(code);
      break;
    case GGroup::plane:
      modal_.set_plane(code);
      break;
    case GGroup::distance:
      modal_.change().incremental = code.tenths == 910;
      break;
    case GGroup::arc_distance:
      modal_.set_arc_centre(code.tenths == 901);
      break;
    case GGroup::feed_mode:
      modal_.set_feed_mode(code.tenths == 930   ? FeedMode::inverse_time
                           : code.tenths == 940 ? FeedMode::per_minute
                                                : FeedMode::per_revolution);
      break;
    case GGroup::unit:
      break;
    case GGroup::cutter_radius:
      radius_.read_radius_code(code);
      break;
    case GGroup::frame:
      read_frame_code(code);
      break;
    case GGroup::tool_length:
      rotary_.set_tool_length(code);
      break;
    case GGroup::work_offset:
      set_work_offset(code);
      break;
    case GGroup::path_control:
      modal_.set_path_control(code.tenths);
      break;
    case GGroup::return_level:
      modal_.set_return_level(code.tenths == 990);
      break;
    case GGroup::one_shot:
      if (code.tenths == 281 || code.tenths == 301) {
        references_.store_reference(code);
        break;
      }
      at_.request.dwell |= code.tenths == 40;
      at_.request.exact_stop |= code.tenths == 90;
      at_.request.machine_frame |= code.tenths == 530;
      if (code.tenths == 280 || code.tenths == 300) {
        at_.request.reference = true;
        at_.request.reference_word = code.word;
      }
      at_.request.return_from_reference |= code.tenths == 290;
      at_.request.single_direction |= code.tenths == 600;
      break;
    case GGroup::contouring:
      modal_.set_contouring(code);
      break;
    case GGroup::macro:
      break;
    case GGroup::no_effect:
      if (code.tenths == 1870 || code.tenths == 1030) at_.words.use("PE");
      break;
    case GGroup::not_read:
      at_.error(code.word->offset, "not-read",
                fmt::format("{} ({}) is not supported", at_.code_text(code), meaning.name), at_.code_text(code));
      at_.request.skip_motion |= meaning.owns_words;
      at_.words.use("D");
      break;
    case GGroup::turning:
      at_.error(code.word->offset, "turning",
                fmt::format("{} ({}) belongs to a turning program; milling programs are read", at_.code_text(code),
                            meaning.name));
      return false;
    case GGroup::unknown:
      at_.error(code.word->offset, "unknown-g",
                fmt::format("{} is not a G code that Camber knows", at_.code_text(code)));
      at_.request.skip_motion = true;
      break;
  }
  modal_.change();
  return true;
}

void BlockInterpreter::run_frame_code() {
  frames_.mark_used();
  const int t = at_.request.frame_code.tenths;
  const bool moves_origin = t == 100 || t == 520 || t == 920;
  if (modal_.state().work_frame != WorkFrame::machine && moves_origin) {
    at_.error(at_.request.frame_code.word->offset, "tilted-frame",
              fmt::format(
                  "{} while {} is active; {} was expected before", at_.code_text(at_.request.frame_code),
                  modal_.state().work_frame == WorkFrame::tilted ? "a tilted frame" : "the dynamic work offset (G254)",
                  modal_.state().work_frame == WorkFrame::tilted ? "G69" : "G255"));
    at_.words.use("XYZIJKLPQRABC");
    return;
  }
  // These take the place of the tool.
  if (t == 920 || ((t == 680 || t == 510) && !at_.words.has_any("XYZ")))
    rotary_.settle_axes_for(t == 920 ? "G92" : t == 680 ? "G68" : "G51", false);
  if (t == 531)
    align_tool();
  else if (t == 682)
    rotary_.set_tilted_frame();
  else
    frames_.run_frame_code();
  frames_.update_frame();
}

void BlockInterpreter::dwell() {
  std::optional<double> seconds;
  const bool p_alone = at_.dialect().dwell_takes_p_alone;
  for (const char letter : {'P', 'X', 'U'})
    if (!seconds && (letter == 'P' || !p_alone)) seconds = at_.dwell_seconds(letter);
  if (!seconds) {
    at_.error(at_.words.offset(), "dwell", "G4 has no time; P with the time was expected");
    return;
  }
  mover_.add_move(MoveKind::dwell, place_.position_mm).dwell_s = *seconds;
}

/// G4 takes P alone: the other words move as if it were not there.
void BlockInterpreter::move_after_dwell() {
  const bool arc = modal_.is_arc();
  const bool moves =
      at_.words.has_any("XYZ") || rotary_.target() || at_.request.cycle_given || (arc && at_.words.has_any("IJKR"));
  if (!moves || at_.request.trouble) return;
  if (arc && modal_.cycle_g() == 0)
    at_.error(at_.words.offset(), "modal-group",
              "G4 with an arc (G2, G3), both of which use P; two blocks were expected");
  else
    move();
}

/// G60: a rapid beyond or short of the place, a stop, and the last way always in the same direction.
void BlockInterpreter::position_in_one_direction() {
  modal_.check_unit();
  if (modal_.motion() != MotionCode::rapid && modal_.motion() != MotionCode::none &&
      modal_.motion() != MotionCode::linear) {
    at_.error(at_.words.offset(), "single-direction", "G60 goes with G0 or G1; an arc or a cycle is active");
    return;
  }
  rotary_.settle_axes_for("G60", false);
  const Vec3 end = mover_.target();
  Vec3 before = end;
  for (int axis = 0; axis < 3; ++axis)
    if (at_.words.has(kAxisLetters[axis])) before[axis] -= at_.options.single_direction_mm[axis];
  if (before != end) {
    Move& first = mover_.add_move(MoveKind::rapid, before);
    first.exact_stop = true;
    first.editable = false;
  }
  Move& last = mover_.add_move(MoveKind::rapid, end);
  last.creeps = before != end;
  if (last.creeps) last.editable = false;
  mover_.settle_axes();
}

void BlockInterpreter::move() {
  const bool axes = at_.words.has_any("XYZ") || rotary_.target();
  if (at_.request.single_direction && axes && modal_.cycle_g() == 0) {
    position_in_one_direction();
    return;
  }
  if (modal_.cycle_g() != 0) {
    cycles_.run_cycle();
    return;
  }
  const bool arc = modal_.is_arc();
  if (arc && (axes || at_.words.has_any("IJKR"))) {
    arcs_.move_on_arc();
  } else if (axes && modal_.motion() == MotionCode::none) {
    const std::string_view letters = "XYZABCIJK";
    const char letter = *std::ranges::find_if(letters, [&](char c) { return at_.words.has(c); });
    at_.error(at_.words.offset_of(letter), "motion-missing",
              fmt::format("{} without a kind of motion; G0, G1, G2 or G3 was expected before", letter), "motion");
  } else if (axes) {
    move_on_line();
  }
}

void BlockInterpreter::move_on_line() {
  modal_.check_unit();
  rotary_.settle_axes_for("cutter radius compensation", modal_.radius_g() == 0);
  const Vec3 end = mover_.target();
  if (modal_.motion() == MotionCode::rapid) {
    mover_.add_move(MoveKind::rapid, end);
  } else {
    mover_.prepare_cutting("G1");
    const auto feed = modal_.cutting_feed((end - place_.position_mm).norm(), "G1");
    mover_.add_move(MoveKind::linear, end).feed_mm_per_s = feed.value_or(0);
  }
  mover_.settle_axes();
}

void BlockInterpreter::warn_of_unused_words() {
  if (at_.request.trouble) return;
  at_.words.use("NOFST");
  if (at_.dialect().strict)
    check_offset_numbers();
  else
    at_.words.use("DH");  // numbers of offsets: the tip is what is programmed
  if (!at_.words.m().empty()) at_.words.use("PQRL");
  const std::uint32_t unused = at_.words.unused();
  if (unused == 0) return;
  for (char letter = 'A'; letter <= 'Z'; ++letter) {
    if ((unused & (1u << (letter - 'A'))) == 0) continue;
    const Word& word = at_.words.word(letter);
    if (letter == 'E')
      at_.error(word.offset, "unknown-letter", "E is not a letter of a milling program", "E");
    else if (word.value != 0 || std::string_view(kAxisLetters).find(letter) != std::string_view::npos)
      at_.report.warning(word.offset, "unused-word",
                         fmt::format("{} has no meaning in this block and is ignored",
                                     at_.program->source.text().substr(word.offset, word.length)),
                         std::string(1, letter));
  }
}

/// D and H beside codes that do not use them, which a strict control refuses.
void BlockInterpreter::check_offset_numbers() {
  for (const char letter : {'D', 'H'}) {
    if (!at_.words.has(letter) || (at_.words.unused() & (1U << (letter - 'A'))) == 0) continue;
    at_.words.use(letter == 'D' ? "D" : "H");
    at_.error(at_.words.offset_of(letter), "offset-number",
              fmt::format("{} in a block without a code that uses it; {} was expected", letter,
                          letter == 'D' ? "G41, G41.1, G42 or G42.1" : "G43"),
              std::string(1, letter));
  }
}

void BlockInterpreter::set_work_offset(const Code& code) {
  if (modal_.set_work_offset(code)) frames_.work_offset_selected();
  modal_.change();
}

void BlockInterpreter::read_frame_code(const Code& code) {
  if (modal_.state().cutter_radius) {
    at_.error(code.word->offset, "cutter-radius",
              fmt::format("{} under G{}; G40 was expected before", at_.code_text(code), modal_.radius_g()));
    at_.request.skip_motion = true;
    return;
  }
  constexpr std::array kWithoutWords{150, 160, 500, 921, 922, 923};
  const int t = code.tenths;
  if (t == 690) {
    rotary_.cancel_tilted_frame();
  } else if (t == 2540 || t == 2550) {
    rotary_.set_dynamic_offset(code);
  } else if (std::ranges::find(kWithoutWords, t) != kWithoutWords.end()) {
    frames_.read_frame_code(code);
  } else {
    if (at_.request.frame_code.word)
      at_.error(code.word->offset, "modal-group",
                fmt::format("{} and {} in one block exclude each other; one of them was expected",
                            at_.code_text(at_.request.frame_code), at_.code_text(code)));
    at_.request.frame_code = code;
    return;
  }
  frames_.mark_used();
  frames_.update_frame();
}

/// G53.1: the rotary axes put the tool along Z of the tilted frame; the linear axes stay.
void BlockInterpreter::align_tool() {
  if (!rotary_.align_tool()) return;
  modal_.check_unit();
  mover_.add_move(MoveKind::rapid, place_.position_mm).editable = false;
}

std::optional<double> BlockInterpreter::offset_value(const OffsetVariable& variable) {
  return frames_.offset_value(variable);
}

void BlockInterpreter::set_offset(const OffsetVariable& variable, double value, std::size_t offset) {
  frames_.set_offset(variable, value, offset);
}

}  // namespace camber::nc
