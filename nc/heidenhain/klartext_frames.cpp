// Frames: datum shift, mirror image, rotation, scale. Rotary axes, tilted planes, tool-centre-point control.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/units.h"
#include "nc/heidenhain/klartext_motion.h"
#include "nc/rotary_words.h"

namespace camber::nc::heidenhain {
namespace {

using Matrix = Eigen::Matrix3d;

Matrix turn_about(int axis, double degrees) {
  const double turn = std::fmod(degrees, 360.0);
  double c = std::cos(rad_from_deg(turn)), s = std::sin(rad_from_deg(turn));
  if (std::fmod(turn, 90.0) == 0) {  // exactly
    c = std::round(c);
    s = std::round(s);
  }
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  Matrix out = Matrix::Identity();
  out(a, a) = out(b, b) = c;
  out(a, b) = -s;
  out(b, a) = s;
  return out;
}

/// About the fixed X, then Y, then Z.
Matrix spatial(const Vec3& degrees) {
  return turn_about(2, degrees.z()) * turn_about(1, degrees.y()) * turn_about(0, degrees.x());
}

Matrix linear_of(const Transform& t, int tool_axis) {
  Matrix scale = Matrix::Identity() * t.scale;
  for (int axis = 0; axis < 3; ++axis) scale(axis, axis) *= t.axis_scale[axis];
  Matrix mirror = Matrix::Identity();
  for (int axis = 0; axis < 3; ++axis)
    if (t.mirror[static_cast<std::size_t>(axis)]) mirror(axis, axis) = -1;
  Matrix turn = Matrix::Identity();
  if (t.rotation_rad != 0) turn = turn_about(tool_axis, deg_from_rad(t.rotation_rad));
  return mirror * turn * scale;
}

/// Where the transform puts the programmed origin.
Vec3 shift_of(const Transform& t, int tool_axis) {
  const Matrix linear = linear_of(t, tool_axis);
  Vec3 offset = Vec3::Zero();  // scales of single axes have a centre of their own
  for (int axis = 0; axis < 3; ++axis) offset[axis] = t.axis_scale_centre_mm[axis] * (1 / t.axis_scale[axis] - 1);
  return t.shift_mm + linear * offset;
}

}  // namespace

DatumFrames::DatumFrames(StatementContext& at, Modes& modes, Tools& tools)
    : at_(at), modes_(modes), tools_(tools), offsets_(at.options.work_offsets_mm) {
  update_frame();
}

WorkPlane DatumFrames::change_plane(const WorkPlane& plane) {
  WorkPlane before = std::exchange(plane_, plane);
  update_frame();
  return before;
}

/// The map from programmed coordinates to the frame of the moves. Without a machine of which the rotary axes are known
/// a tilted plane is taken as it is programmed: as if the part lay with that side up, its datum in the plane.
void DatumFrames::update_frame() {
  Frame frame;
  const bool untilted = plane_.tilt && !at_.has_rotary_axes();
  if (plane_.tilt) {
    frame.linear = linear_of(plane_.transform, tools_.axis());
    frame.shift_mm = shift_of(plane_.transform, tools_.axis());
  }
  if (!untilted) {
    if (plane_.tilt) {
      frame.linear = *plane_.tilt * frame.linear;
      frame.shift_mm = *plane_.tilt * frame.shift_mm;
    }
    const Matrix base = linear_of(base_, tools_.axis());
    frame.linear = base * frame.linear;
    frame.shift_mm = base * frame.shift_mm + shift_of(base_, tools_.axis());
  }
  const Vec3 origin = offsets_.origin_mm(54, at_.out.moves.empty());
  frame.shift_mm += origin;
  frame.origin_mm = origin;
  frame.shift_only = frame.linear == Matrix::Identity();
  frame.plain = frame.shift_only && frame.shift_mm == Vec3::Zero();
  frame.inverse = frame.shift_only ? Matrix(Matrix::Identity()) : Matrix(frame.linear.inverse());
  frame_ = frame;
  const auto found = std::ranges::find(at_.out.frames, frame);
  const auto index = static_cast<std::uint32_t>(found - at_.out.frames.begin());
  if (found == at_.out.frames.end()) at_.out.frames.push_back(frame);
  if (index == modes_.state().frame) return;
  modes_.change().frame = index;
}

/// CYCL DEF 7: X+10, IX+10; several axes may stand in one part.
void DatumFrames::shift_datum(Cursor at, std::size_t offset) {
  while (at.more()) {
    const std::size_t begin = at.offset();
    if (at.peek() == '#')
      throw FormulaError(begin, "not-supported",
                         "a datum shift from a datum table is not supported; X, Y and Z in CYCL DEF 7 were expected");
    const bool step = at.peek() == 'I' && at.behind(1) != 'N';
    if (step) at.advance();
    const char axis = at.peek();
    if (axis >= 'A' && axis <= 'C') {
      at.advance();
      const double value = at_.known_value(at, begin);
      if (value != 0)
        at_.error(begin, "not-supported",
                  fmt::format("a datum shift of {} is not supported; X, Y and Z were expected", axis));
      continue;
    }
    if (axis < 'X' || axis > 'Z') {
      if (at.letters().empty())
        throw FormulaError(offset, "cycle", fmt::format("{} in CYCL DEF 7; X, Y and Z were expected", at.word()));
      at.advance(at.letters().size());  // a word of comment
      continue;
    }
    at.advance();
    if (!at.more())
      throw FormulaError(begin, "no-number", fmt::format("{} has no number; a number was expected", axis));
    const double value = at_.known_value(at, begin) * at_.unit_mm();
    double& shift = transform().shift_mm[axis - 'X'];
    shift = step ? shift + value : value;
  }
  update_frame();
}

void DatumFrames::set_mirror(Cursor at) {
  std::array<bool, 3> mirror{};
  while (at.more()) {
    const char axis = at.peek();
    if (axis < 'X' || axis > 'Z')
      throw FormulaError(at.offset(), "cycle",
                         fmt::format("{} in a mirror image; X, Y and Z were expected", at.word()));
    mirror[static_cast<std::size_t>(axis - 'X')] = true;
    at.advance();
  }
  transform().mirror = mirror;
  update_frame();
}

void DatumFrames::set_rotation(Cursor at) {
  const std::size_t begin = at.offset();
  double value = 0;
  if (at.more()) {
    const bool step = at.accept_prefix("IROT");
    if (!step && !at.accept_prefix("ROT"))
      throw FormulaError(at.offset(), "cycle", fmt::format("{} in a rotation; ROT was expected", at.word()));
    value = rad_from_deg(at_.known_value(at, begin));
    if (step) value += transform().rotation_rad;
  }
  transform().rotation_rad = value;
  update_frame();
}

void DatumFrames::set_scale(Cursor at) {
  const std::size_t begin = at.offset();
  double value = 1;
  if (at.more()) {
    if (!at.accept_prefix("SCL"))
      throw FormulaError(at.offset(), "cycle", fmt::format("{} in a scale; SCL was expected", at.word()));
    value = at_.known_value(at, begin);
  }
  if (!(value > 0))
    throw FormulaError(begin, "scaling", fmt::format("a scale of {}; greater than zero was expected", value));
  transform().scale = value;
  update_frame();
}

/// CYCL DEF 26.1 X 1.4 Y 0.6 CCX+15 CCY+20.
void DatumFrames::set_axis_scale(Cursor at) {
  Transform& t = transform();
  t.axis_scale = Vec3::Ones();
  t.axis_scale_centre_mm = Vec3::Zero();
  while (at.more()) {
    const std::size_t begin = at.offset();
    const bool centre = at.peek() == 'C' && at.behind(1) == 'C';
    if (centre) at.advance(2);
    const char axis = at.peek();
    if (axis < 'X' || axis > 'Z')
      throw FormulaError(begin, "cycle",
                         fmt::format("{} in CYCL DEF 26; X, Y, Z, CCX, CCY or CCZ was expected", at.word()));
    at.advance();
    const double value = at_.known_value(at, begin);
    if (centre)
      t.axis_scale_centre_mm[axis - 'X'] = value * at_.unit_mm();
    else if (!(value > 0))
      throw FormulaError(begin, "scaling", fmt::format("a scale of {}; greater than zero was expected", value));
    else
      t.axis_scale[axis - 'X'] = value;
  }
  update_frame();
}

/// TRANS DATUM, MIRROR, ROTATION, SCALE of newer controls.
void DatumFrames::run_transform(const Statement& s) {
  Cursor at = at_.cursor(s);
  const std::string what = at.letters();
  at.advance(what.size());
  const bool reset = at.accept("RESET");
  if (what == "DATUM") {
    if (reset) {
      transform().shift_mm = Vec3::Zero();
      return update_frame();
    }
    if (!at.accept("AXIS"))
      throw FormulaError(s.begin, "not-supported",
                         "TRANS DATUM from a table is not supported; TRANS DATUM AXIS was expected");
    return shift_datum(at, s.begin);
  }
  if (what == "MIRROR") {
    at.accept("AXIS");
    return set_mirror(reset ? Cursor({}, 0, 0) : at);
  }
  if (what == "ROTATION") return set_rotation(reset ? Cursor({}, 0, 0) : at);
  if (what == "SCALE") return set_scale(reset ? Cursor({}, 0, 0) : at);
  at_.error(s.begin, "not-a-word",
            fmt::format("TRANS {} is not known; DATUM, MIRROR, ROTATION or SCALE was expected", what));
}

/// Notes the plane of a feed move.
void DatumFrames::note_cut_plane() {
  if (at_.has_rotary_axes() || cut_planes_.size() > 1) return;
  const auto same = [](const Matrix& a, const Matrix& b) { return (a - b).cwiseAbs().maxCoeff() < 1e-9; };
  if (!cut_planes_.empty() && cut_planes_.back().tilt.has_value() == plane_.tilt.has_value() &&
      (!plane_.tilt || same(*cut_planes_.back().tilt, *plane_.tilt)))
    return;
  cut_planes_.push_back({plane_.tilt, base_});
  if (cut_planes_.size() == 2)
    at_.warn(
        at_.statement->begin, "tilted-plane",
        "the program cuts in more than one plane from here on; without a machine file with [kinematics] they lie over "
        "each other, and no simulation of material is right");
}

/// The blank in the coordinates of the plane in which the program cuts. Where that is more than one, or the blank
/// stands askew in it, there is none.
void DatumFrames::place_stock() {
  if (!at_.out.stock || cut_planes_.empty() || (cut_planes_.size() == 1 && !cut_planes_.front().tilt)) return;
  const WorkPlane& plane = cut_planes_.front();
  const bool square =
      plane.tilt && (plane.tilt->cwiseAbs().array().round() - plane.tilt->cwiseAbs().array()).abs().maxCoeff() < 1e-9;
  if (cut_planes_.size() > 1 || !square || at_.out.stock->cylinder) return at_.out.stock.reset();
  const Matrix linear = linear_of(plane.transform, tools_.axis());
  const auto in_plane = [&](const Vec3& p) {
    return Vec3(plane.tilt->transpose() * linear.inverse() * (p - shift_of(plane.transform, tools_.axis())));
  };
  const Vec3 a = in_plane(at_.out.stock->min_mm), b = in_plane(at_.out.stock->max_mm);
  at_.out.stock->min_mm = a.cwiseMin(b);
  at_.out.stock->max_mm = a.cwiseMax(b);
}

void DatumFrames::use_preset(int preset, std::size_t offset) {
  if (preset_ >= 0 && preset != preset_ && !preset_told_) {
    preset_told_ = true;
    at_.warn(offset, "work-offsets",
             "the program uses more than one preset (CYCL DEF 247); their distance is not known, and all are treated "
             "as one frame");
  }
  preset_ = preset;
}

// --- rotary axes

std::optional<Vec3> Orientation::direction() const {
  if (!direction_unknown_ || !at_.out.rotary.back().is_direction) return std::nullopt;
  return at_.out.rotary.back().end;
}

void Orientation::open_all_if_turned() {
  if (!at_.out.moves.empty() && turned()) mover_.set_open({7, true});
}

/// The rotary words of a block that moves.
void Orientation::add_rotary(const BlockValues& b, std::size_t move) {
  if (!at_.has_rotary_axes()) {
    const bool at_zero = std::ranges::all_of(b.rotary, [](const auto& v) { return !v || *v == 0; }) &&
                         (b.to_plane == 0 || !frames_.tilted());
    if (!at_zero)
      at_.warn(
          at_.statement->begin, "rotary-axis",
          "rotary axes turn here; without a machine file with [kinematics] X, Y and Z are read as they are programmed, "
          "and the tool stays upright",
          "rotary");
    return;
  }
  if (b.to_plane != 0 && frames_.tilt()) return direction_target(frames_.tilt()->col(2), move);
  RotaryTarget target;
  target.end = rotary_rad_;
  target.move = static_cast<std::uint32_t>(move);
  for (unsigned i = 0; i < 3; ++i) {
    if (!b.rotary[i]) continue;
    const char letter = static_cast<char>('A' + i);
    const RotaryOption* axis = rotary_axis_of(at_.options.rotary_axes, letter);
    if (!axis) {
      at_.error(at_.statement->begin, "rotary-axis", fmt::format("{} is not an axis of the machine's chain", letter),
                std::string(1, letter));
      continue;
    }
    const double value = rad_from_deg(*b.rotary[i]);
    double& end = target.end[static_cast<Eigen::Index>(i)];
    if ((b.rotary_step & (1U << i)) != 0) {
      end += value;
    } else {
      if ((shortest_way_ || axis->shortest_way) && !direction_unknown_)
        end = shortest_way(value, end);
      else
        end = value;
      if (direction_unknown_ && (shortest_way_ || axis->shortest_way))
        target.shortest = static_cast<std::uint8_t>(target.shortest | 1U << i);
    }
    target.given = static_cast<std::uint8_t>(target.given | 1U << i);
  }
  if (target.given == 0) return;
  const bool turns = target.end != rotary_rad_ || direction_unknown_;
  rotary_rad_ = target.end;
  direction_unknown_ = false;
  at_.out.rotary.push_back(target);
  if (turns && modes_.state().work_frame != WorkFrame::machine) {
    mover_.set_open({7, true});
    at_.out.moves[move].open_axes = 7;
  }
}

/// A block of rotary words alone, or a statement that turns the axes: a move where the machine has such axes.
void Orientation::turn_only(const BlockValues& b) {
  if (!at_.has_rotary_axes()) return add_rotary(b, 0);
  const double feed = b.feed.rapid ? 0 : modes_.cutting_feed("L");
  Move& move = mover_.add_move(b.feed.rapid ? MoveKind::rapid : MoveKind::linear, mover_.position_mm());
  move.feed_mm_per_s = feed;
  if (!has_words(at_.statement->kind) || b.by_parameter) move.editable = false;
  add_rotary(b, at_.out.moves.size() - 1);
}

/// The rotary axes put the tool along a direction in the frame of the moves.
void Orientation::direction_target(const Vec3& direction, std::size_t move) {
  if (!at_.has_rotary_axes()) {
    constexpr double kUpright = 1 - 1e-9;
    if (!frames_.tilted() && direction.z() > kUpright) return;
    at_.warn(
        at_.statement->begin, "rotary-axis",
        "the tool is tilted here; without a machine file with [kinematics] X, Y and Z are read as they are programmed, "
        "and the tool stays upright",
        "rotary");
    return;
  }
  RotaryTarget target;
  target.is_direction = true;
  target.end = direction.normalized();
  target.move = static_cast<std::uint32_t>(move);
  at_.out.rotary.push_back(target);
  direction_unknown_ = true;
}

/// CYCL DEF 19.1 A-90 B+0 C+0 F ABST: spatial angles; empty: off.
void Orientation::set_working_plane(Cursor at, int part) {
  if (part == 0) return;
  Vec3 angles = Vec3::Zero();
  bool any = false;
  while (at.more()) {
    const std::size_t begin = at.offset();
    const char axis = at.peek();
    const std::string letters = at.letters();
    if (axis >= 'A' && axis <= 'C' && letters.size() == 1) {
      at.advance();
      angles[axis - 'A'] = at_.known_value(at, begin);
      any = true;
    } else if (!letters.empty()) {  // F, ABST, DIST
      at.advance(letters.size());
      if (at.more() && (is_digit(at.peek()) || at.peek() == '+' || at.peek() == '-')) at.number();
    } else {
      throw FormulaError(begin, "cycle", fmt::format("{} in CYCL DEF 19; A, B and C were expected", at.word()));
    }
  }
  if (!any || angles == Vec3::Zero())
    reset_tilt(Turn::stay);
  else
    tilt(spatial(angles), Turn::stay, at_.statement->begin);
}

void Orientation::tilt(const Matrix& rotation, Turn turn, std::size_t offset) {
  compensation_.end();
  const Mover::Open before = mover_.open();
  if (!at_.has_rotary_axes() && !(frames_.tilt() && *frames_.tilt() == rotation)) mover_.carry_over();
  frames_.change_plane({rotation, {}});
  if (!at_.has_rotary_axes()) {
    if (!rotation.isIdentity(1e-12))
      at_.warn(
          offset, "tilted-plane",
          "a tilted plane is read as it is programmed, with the side of the part up that it machines: where it lies "
          "takes "
          "a machine file with [kinematics]",
          "tilted");
    modes_.change().work_frame = WorkFrame::machine;
    return;
  }
  if (modes_.state().tip_control != TipControl::off) set_tip_control(false);
  modes_.change().work_frame = WorkFrame::tilted;
  open_all_if_turned();
  if (turn == Turn::stay) return;
  const bool keeps_tip = turn == Turn::move;
  if (keeps_tip) set_tip_control(true);
  mover_.set_open(keeps_tip ? before : Mover::Open{7, true});
  Move& move = mover_.add_move(MoveKind::rapid, mover_.position_mm());
  move.editable = false;
  direction_target(rotation.col(2), at_.out.moves.size() - 1);
  set_tip_control(false);
  const auto open = static_cast<std::uint8_t>(keeps_tip ? before.axes : 7);
  mover_.set_open({open, open != 0});
}

void Orientation::reset_tilt(Turn turn) {
  if (frames_.tilt()) {
    compensation_.end();
    if (!at_.has_rotary_axes() && !frames_.tilt()->isIdentity(1e-12)) mover_.carry_over();
  }
  frames_.change_plane({});
  if (!at_.has_rotary_axes()) return;
  if (modes_.state().work_frame != WorkFrame::machine) {
    modes_.change().work_frame = WorkFrame::machine;
    if (!at_.out.moves.empty()) mover_.set_open({7, true});
  }
  if (turn == Turn::stay) return;
  BlockValues b;
  b.feed.rapid = true;
  for (const RotaryOption& axis : at_.options.rotary_axes) b.rotary[static_cast<std::size_t>(axis.letter - 'A')] = 0.0;
  turn_only(b);
}

/// PLANE SPATIAL, PROJECTED, EULER, VECTOR, POINTS, RELATIV, AXIAL, RESET.
void Orientation::run_plane(const Statement& s) {
  Cursor at = at_.cursor(s);
  const std::string form = at.letters();
  at.advance(form.size());
  std::map<std::string, double> values;
  Turn turns = Turn::stay;
  while (at.more()) {
    const std::size_t begin = at.offset();
    std::string word = at.letters();
    if (word.empty()) throw FormulaError(begin, "plane", fmt::format("{} in PLANE is not understood", at.word()));
    if (word == "STAY" || word == "ABST" || word == "DIST" || word == "COORD" || word == "TABLE" || word == "ROT" ||
        word == "SYM" || word == "SEQ" || word == "FMAX" || word == "FAUTO" || word == "MB" || word == "MAX" ||
        word == "F" || word == "M" || word == "SET") {
      at.advance(word.size());
      if (word == "SET") at.accept('-') || at.accept('_'), at.accept_prefix("UP");
      if (word == "SEQ" || word == "SYM") at.advance();
      if ((word == "ROT" && form == "PROJECTED") && begins_number(at)) {
        values["ROT"] = at_.known_value(at, begin);
        continue;
      }
      if (begins_number(at)) read_value(at, at_.parameters);
      continue;
    }
    if (word == "TURN" || word == "MOVE") {
      turns = word == "MOVE" ? Turn::move : Turn::turn;
      at.advance(word.size());
      continue;
    }
    constexpr std::array<std::string_view, 18> kValues{"SPA",   "SPB",    "SPC", "EULPR", "EULNU", "EULROT",
                                                       "PROPR", "PROMIN", "BX",  "BY",    "BZ",    "NX",
                                                       "NY",    "NZ",     "A",   "B",     "C",     "P"};
    if (std::ranges::find(kValues, word) == kValues.end())
      throw FormulaError(begin, "plane", fmt::format("{} in PLANE {} is not understood", at.word(), form));
    at.advance(word.size());
    if (word == "P" && is_digit(at.peek())) {  // P1X of POINTS
      word += static_cast<char>(at.peek());
      at.advance();
      word += at.letters();
      at.advance(at.letters().size());
    }
    values[word] = at_.known_value(at, begin);
  }
  const auto value = [&](const char* name) {
    const auto found = values.find(name);
    return found == values.end() ? 0.0 : found->second;
  };
  const auto vector = [&](const char* x, const char* y, const char* z) { return Vec3(value(x), value(y), value(z)); };
  if (form == "RESET") return reset_tilt(turns);
  if (form == "SPATIAL") return tilt(spatial(vector("SPA", "SPB", "SPC")), turns, s.begin);
  if (form == "EULER")
    return tilt(turn_about(2, value("EULPR")) * turn_about(0, value("EULNU")) * turn_about(2, value("EULROT")), turns,
                s.begin);
  if (form == "RELATIV" || form == "RELATIVE") {
    const Matrix now = frames_.tilt().value_or(Matrix::Identity());
    return tilt(now * spatial(vector("SPA", "SPB", "SPC")), turns, s.begin);
  }
  if (form == "AXIAL") {
    if (!at_.has_rotary_axes()) return tilt(spatial(vector("A", "B", "C")), turns, s.begin);
    throw FormulaError(s.begin, "not-supported",
                       "PLANE AXIAL on a machine with [kinematics] is not supported; PLANE SPATIAL was expected");
  }
  if (form == "VECTOR") {
    Vec3 base = vector("BX", "BY", "BZ"), normal = vector("NX", "NY", "NZ");
    if (normal.norm() < 1e-6 || base.norm() < 1e-6)
      throw FormulaError(s.begin, "plane",
                         "PLANE VECTOR with a vector of no length; BX BY BZ and NX NY NZ were expected");
    normal.normalize();
    base -= base.dot(normal) * normal;
    if (base.norm() < 1e-6)
      throw FormulaError(s.begin, "plane", "the vectors of PLANE VECTOR are parallel; two directions were expected");
    base.normalize();
    Matrix m;
    m.col(0) = base;
    m.col(2) = normal;
    m.col(1) = normal.cross(base);
    return tilt(m, turns, s.begin);
  }
  if (form == "POINTS") {
    const Vec3 a = vector("P1X", "P1Y", "P1Z"), b = vector("P2X", "P2Y", "P2Z"), c = vector("P3X", "P3Y", "P3Z");
    const Vec3 x = b - a, normal = x.cross(c - a);
    if (normal.norm() < 1e-9)
      throw FormulaError(s.begin, "plane",
                         "the points of PLANE POINTS lie on a line; three points of a plane were expected");
    Matrix m;
    m.col(0) = x.normalized();
    m.col(2) = normal.normalized();
    m.col(1) = Vec3(m.col(2)).cross(Vec3(m.col(0)));
    return tilt(m, turns, s.begin);
  }
  if (form == "PROJECTED") {
    // The plane's traces in the ZX and YZ planes.
    const Vec3 x(std::cos(rad_from_deg(value("PROPR"))), 0, std::sin(rad_from_deg(value("PROPR"))));
    const Vec3 y(0, std::cos(rad_from_deg(value("PROMIN"))), std::sin(rad_from_deg(value("PROMIN"))));
    Matrix m;
    m.col(2) = x.cross(y).normalized();
    m.col(0) = x.normalized();
    m.col(1) = Vec3(m.col(2)).cross(Vec3(m.col(0)));
    const Matrix turned = m * turn_about(2, value("ROT"));
    return tilt(turned, turns, s.begin);
  }
  at_.error(
      s.begin, "plane",
      fmt::format(
          "PLANE {} is not known; SPATIAL, PROJECTED, EULER, VECTOR, POINTS, RELATIV, AXIAL or RESET was expected",
          form));
}

void Orientation::set_tip_control(bool on) {
  if (!at_.has_rotary_axes()) return;
  const TipControl control = on ? TipControl::angles : TipControl::off;
  if (control == modes_.state().tip_control) return;
  if (on && modes_.state().work_frame == WorkFrame::tilted) {
    // The tip in the tilted plane: as a frame that is fixed to the part.
    modes_.change().work_frame = WorkFrame::machine;
  }
  if (on) tools_.update_length();
  modes_.change().tip_control = control;
  if (!on && frames_.tilt()) modes_.change().work_frame = WorkFrame::tilted;
  open_all_if_turned();
}

}  // namespace camber::nc::heidenhain
