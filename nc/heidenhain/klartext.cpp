// Runs the statements of a Klartext program: gives each to the part that it is for, all of which have their own state.
//
//   StatementContext    the statement, its file, parameters; where moves and messages go   klartext_words
//   Modes, Tools        feeds, spindle, tolerance; tools, their axis and lengths            klartext_words
//   DatumFrames         datum shift, mirror image, rotation, scale                          klartext_frames
//   Mover               makes moves from where the tool stands                              klartext_motion
//   RadiusCompensation  RL, RR, R0                                                          klartext_motion
//   Orientation         rotary axes, tilted planes, tool-centre-point control               klartext_frames
//   PathBlocks          L, C, CR, CT, CP, LP; poles                                         klartext_path
//   Contour             RND, CHF, APPR, DEP                                                 klartext_contour
//   Flow, Functions     labels, calls, jumps, formulas; M functions                         klartext_flow
//   Cycles, CycleMoves  definitions, calls, patterns; the moves of a cycle                  klartext_cycles,
//   klartext_holes
//
// A part calls those above it only.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "nc/durations.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/heidenhain/klartext_flow.h"
#include "nc/heidenhain/klartext_motion.h"

namespace camber::nc::heidenhain {
namespace {

class Klartext {
 public:
  Klartext(const Program& main, const InterpreterOptions& options, Diagnostics& diagnostics, Reporter& report,
           Interpretation& out)
      : at_{main, options, report, out}, flow_(at_, modes_, tools_, diagnostics) {}
  Klartext(const Klartext&) = delete;
  void run();

 private:
  void execute(const Statement& s);
  void run_path(const Statement& s);
  void run_functions(const Statement& s);
  void run_dwell(const Statement& s);
  void read_blank_form(const Statement& s);
  void refuse(const Statement& s);

  StatementContext at_;
  Modes modes_{at_};
  Tools tools_{at_, modes_};
  DatumFrames frames_{at_, modes_, tools_};
  Mover mover_{at_, modes_, tools_, frames_};
  MotionParts parts_{at_, modes_, tools_, frames_, mover_};
  RadiusCompensation compensation_{parts_};
  Orientation orientation_{parts_, compensation_};
  PathBlocks path_{parts_, orientation_};
  Contour contour_{parts_, compensation_, path_};
  Flow flow_;
  Functions functions_{parts_, compensation_, orientation_, flow_};
  Cycles cycles_{parts_, compensation_, orientation_, flow_};
  std::optional<Vec3> blank_min_mm_;
};

void Klartext::run() {
  while (const Statement* s = flow_.next()) {
    try {
      execute(*s);
    } catch (const FormulaError& e) {
      at_.error(e.offset, e.check, e.what());
      // Where a value or a jump is lacking, loops may never end: what follows says nothing more.
      if (s->kind >= Kind::call_label && s->kind <= Kind::function) break;
    }
  }
  compensation_.end();
  frames_.place_stock();
  contour_.finish();
  flow_.mark_repeated_moves();
  at_.relied_ends.fix(at_.out);
  at_.out.tool_names = tools_.names();
}

void Klartext::execute(const Statement& s) {
  switch (s.kind) {
    case Kind::end_program:
    case Kind::label:
    case Kind::call_label:
    case Kind::call_program:
    case Kind::select_program:
    case Kind::assignment:
    case Kind::function:
      return flow_.run(s);
    case Kind::tool_call:
      return functions_.call_tool(s);
    case Kind::tool_def:
      return tools_.define(s);
    case Kind::blank_form:
      return read_blank_form(s);
    case Kind::cycle_def:
      return cycles_.define(s);
    case Kind::cycle_call:
      return cycles_.run_call(s, functions_);
    case Kind::pattern:
      return cycles_.define_pattern(s);
    case Kind::plane:
      return orientation_.run_plane(s);
    case Kind::tcpm:
      return orientation_.set_tip_control(at_.cursor(s).letters() != "RESET");
    case Kind::transform:
      return frames_.run_transform(s);
    case Kind::dwell:
      return run_dwell(s);
    case Kind::refused:
      return refuse(s);
    case Kind::stop: {
      at_.add_event(EventKind::m_code, 0);
      Cursor at = at_.cursor(s);
      if (at.accept('M'))
        if (const auto code = at.integer()) functions_.run({*code, std::nullopt, s.begin});
      break;
    }
    case Kind::noted: {
      Cursor at(at_.file().source.text(), s.begin, s.end);
      std::string name = at.letters();
      at.advance(name.size());
      at.more();
      const std::string first = at.letters();
      name += " " + (first == "S" ? std::string("S-PULSE") : first);
      at_.warn(s.begin, "no-effect", fmt::format("{} is read without effect", name), name);
      break;
    }
    default:
      if (has_words(s.kind)) run_path(s);
  }
}

/// FUNCTION DWELL TIME 2.5, in seconds; REV 3, in turns of the spindle.
void Klartext::run_dwell(const Statement& s) {
  Cursor at = at_.cursor(s);
  const bool turns = at.accept_prefix("REV");
  if (!turns && !at.accept_prefix("TIME"))
    throw FormulaError(at.offset(), "dwell", "FUNCTION DWELL without TIME or REV; TIME10 was expected");
  const std::size_t offset = at.offset();
  const double count = at_.known_value(at, offset);
  const double rate = turns ? modes_.turns_per_s("FUNCTION DWELL REV") : 1;
  if (!(count > 0) || rate <= 0) return;
  Move& move = mover_.add_move(MoveKind::dwell, mover_.position_mm());
  move.dwell_s = count / rate;
  move.editable = false;
}

void Klartext::refuse(const Statement& s) {
  const Refusal refusal = refusal_of(std::string_view(at_.file().source.text()).substr(s.begin, s.end - s.begin));
  at_.error(s.begin, refusal.check, refusal.message, refusal.alike);
}

void Klartext::read_blank_form(const Statement& s) {
  Cursor at = at_.cursor(s);
  if (!at.accept("FORM")) return at_.error(s.begin, "blank", "BLK without FORM; BLK FORM 0.1 was expected");
  for (const char* form : {"FILE", "ROTATION"})
    if (at.accept(form))
      return at_.warn(s.begin, "no-effect",
                      fmt::format("BLK FORM {} is read without effect; the stock is given in the job", form));
  if (at.accept("CYLINDER")) {
    double radius = 0, length = 0, distance = 0;
    const char axis = at.peek();
    at.advance();
    while (at.more()) {
      if (at.accept_prefix("DIST"))
        distance = read_value(at, at_.parameters);
      else if (at.accept_prefix("RI") || at.accept_prefix("DI"))
        read_value(at, at_.parameters);
      else if (at.accept('R'))
        radius = read_value(at, at_.parameters);
      else if (at.accept('D'))
        radius = 0.5 * read_value(at, at_.parameters);
      else if (at.accept('L'))
        length = read_value(at, at_.parameters);
      else
        throw FormulaError(at.offset(), "blank",
                           fmt::format("{} in BLK FORM CYLINDER; R, L or DIST was expected", at.word()));
    }
    if (axis != 'Z' || radius <= 0 || length <= 0 || at_.out.stock) return;
    const double unit = at_.unit_mm();
    at_.out.stock = ProgramStock{true, Vec3(-radius, -radius, distance - length) * unit,
                                 Vec3(radius, radius, distance) * unit, at_.block};
    return;
  }
  const auto part = at.number();
  const bool first = part && std::abs(*part - 0.1) < 1e-9, second = part && std::abs(*part - 0.2) < 1e-9;
  if (!first && !second) return at_.error(s.begin, "blank", "BLK FORM 0.1, 0.2, CYLINDER or FILE was expected");
  if (first && (at.peek() == 'X' || at.peek() == 'Y' || at.peek() == 'Z') && !is_digit(at.behind(1)) &&
      at.behind(1) != '+' && at.behind(1) != '-')
    at.advance();  // the tool axis
  Vec3 corner = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  while (at.more()) {
    const std::size_t begin = at.offset();
    const bool step = at.peek() == 'I';
    if (step) at.advance();
    const char axis = at.peek();
    if (axis < 'X' || axis > 'Z')
      throw FormulaError(begin, "blank", fmt::format("{} in BLK FORM; X, Y and Z were expected", at.word()));
    at.advance();
    double value = read_value(at, at_.parameters) * at_.unit_mm();
    if (step && blank_min_mm_) value += (*blank_min_mm_)[axis - 'X'];
    corner[axis - 'X'] = value;
  }
  if (first) {
    blank_min_mm_ = corner;
    return;
  }
  if (!blank_min_mm_ || at_.out.stock) return;
  // Some posts have the corners the other way round.
  const Vec3 low = blank_min_mm_->cwiseMin(corner), high = blank_min_mm_->cwiseMax(corner);
  if ((high - low).minCoeff() > 0) at_.out.stock = ProgramStock{false, low, high, at_.block};
}

void Klartext::run_path(const Statement& s) {
  if (s.kind == Kind::functions) return run_functions(s);
  const BlockValues b = modes_.read_values(s);
  if (b.by_parameter) at_.editable = false;
  if (s.kind == Kind::centre) return path_.set_centre(b);
  if (s.kind == Kind::rounding || s.kind == Kind::chamfer) return contour_.set_corner(s, b);
  const std::optional<double> feed_before = modes_.feed();
  modes_.set_feed_mode(b);
  modes_.set_feed(b);
  functions_.run_before(b);
  if (s.kind == Kind::approach) {
    contour_.start_approach(s, b, feed_before);
    return functions_.run_after(b);
  }
  const std::size_t first = at_.out.moves.size();
  if (s.kind == Kind::departure) {
    contour_.depart(s, b);
    return functions_.run_after(b);
  }
  if (b.compensation) compensation_.set(*b.compensation, s.begin);
  for (const auto& f : b.functions)
    if (f.code == 140) path_.retract(f, b);
  switch (s.kind) {
    case Kind::line:
    case Kind::normal_line:
      path_.run_line(b);
      break;
    case Kind::polar_line:
      mover_.line_to(path_.polar_target(b), 7, b);
      if (at_.out.moves.size() > first) at_.out.moves.back().editable = false;
      break;
    case Kind::circle:
      path_.run_circle(b);
      break;
    case Kind::radius_arc:
      path_.run_radius_arc(b);
      break;
    case Kind::tangent_arc:
    case Kind::polar_tangent_arc:
      path_.run_tangent_arc(b, s.kind == Kind::tangent_arc ? mover_.target(b) : path_.polar_target(b));
      break;
    case Kind::polar_circle:
      path_.run_polar_circle(b);
      break;
    default:
      break;
  }
  if (at_.out.moves.size() > first) contour_.after_move(first);
  // M99 calls at the end of the block; M89 behind each block that positions, M99 then ends it.
  const bool positions = s.kind == Kind::line || s.kind == Kind::polar_line;
  if (b.has(99)) {
    cycles_.call(s.begin);
    functions_.end_modal_cycle();
  } else if (functions_.cycle_is_modal() && positions && (b.moves() || s.kind == Kind::polar_line) && !b.has(91) &&
             !b.has(92)) {
    cycles_.call(s.begin);
  }
  functions_.run_after(b);
}

/// M, F and S alone.
void Klartext::run_functions(const Statement& s) {
  const BlockValues b = modes_.read_values(s);
  modes_.set_feed_mode(b);
  modes_.set_feed(b);
  functions_.run_before(b);
  for (const auto& f : b.functions)
    if (f.code == 140) path_.retract(f, b);
  if (b.has(99)) {
    cycles_.call(s.begin);
    functions_.end_modal_cycle();
  }
  functions_.run_after(b);
}

}  // namespace

Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  Interpretation out;
  Reporter report(program.source, diagnostics);
  {
    Klartext run(program, options, diagnostics, report, out);
    run.run();
    report.set_source(program.source);
    check_durations(program, out, report);
    report.finish();
  }
  return out;
}

}  // namespace camber::nc::heidenhain
