// Frames: datum shift, mirror image, rotation, scale; tilted planes; tool-centre-point control.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "base/units.h"
#include "nc/heidenhain/klartext.h"

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

/// The map from programmed coordinates to the frame of the moves. Without a machine of which the rotary axes are known
/// a tilted plane is taken as it is programmed: as if the part lay with that side up, its datum in the plane.
void Klartext::update_frame() {
  Frame frame;
  const bool untilted = tilt_ && options_.rotary_axes.empty();
  if (tilt_) {
    frame.linear = linear_of(in_plane_, tool_axis_);
    frame.shift_mm = shift_of(in_plane_, tool_axis_);
  }
  if (!untilted) {
    if (tilt_) {
      frame.linear = *tilt_ * frame.linear;
      frame.shift_mm = *tilt_ * frame.shift_mm;
    }
    const Matrix base = linear_of(base_, tool_axis_);
    frame.linear = base * frame.linear;
    frame.shift_mm = base * frame.shift_mm + shift_of(base_, tool_axis_);
  }
  const Vec3 origin = offsets_.origin_mm(54, out_.moves.empty());
  frame.shift_mm += origin;
  frame.origin_mm = origin;
  frame.shift_only = frame.linear == Matrix::Identity();
  frame.plain = frame.shift_only && frame.shift_mm == Vec3::Zero();
  frame.inverse = frame.shift_only ? Matrix(Matrix::Identity()) : Matrix(frame.linear.inverse());
  frame_ = frame;
  const auto found = std::ranges::find(out_.frames, frame);
  const auto index = static_cast<std::uint32_t>(found - out_.frames.begin());
  if (found == out_.frames.end()) out_.frames.push_back(frame);
  if (index == state_.frame) return;
  state_.frame = index;
  state_changed_ = true;
}

/// CYCL DEF 7: X+10, IX+10; several axes may stand in one part.
void Klartext::shift_datum(Cursor at, std::size_t offset) {
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
      const double value = known(read_value(at, parameters_), begin);
      if (value != 0)
        error(begin, "not-supported",
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
    const double value = known(read_value(at, parameters_), begin) * unit_mm();
    double& shift = transform().shift_mm[axis - 'X'];
    shift = step ? shift + value : value;
  }
  update_frame();
}

void Klartext::set_mirror(Cursor at) {
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

void Klartext::set_rotation(Cursor at) {
  const std::size_t begin = at.offset();
  double value = 0;
  if (at.more()) {
    const bool step = at.accept_prefix("IROT");
    if (!step && !at.accept_prefix("ROT"))
      throw FormulaError(at.offset(), "cycle", fmt::format("{} in a rotation; ROT was expected", at.word()));
    value = rad_from_deg(known(read_value(at, parameters_), begin));
    if (step) value += transform().rotation_rad;
  }
  transform().rotation_rad = value;
  update_frame();
}

void Klartext::set_scale(Cursor at) {
  const std::size_t begin = at.offset();
  double value = 1;
  if (at.more()) {
    if (!at.accept_prefix("SCL"))
      throw FormulaError(at.offset(), "cycle", fmt::format("{} in a scale; SCL was expected", at.word()));
    value = known(read_value(at, parameters_), begin);
  }
  if (!(value > 0))
    throw FormulaError(begin, "scaling", fmt::format("a scale of {}; greater than zero was expected", value));
  transform().scale = value;
  update_frame();
}

/// CYCL DEF 26.1 X 1.4 Y 0.6 CCX+15 CCY+20.
void Klartext::set_axis_scale(Cursor at) {
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
    const double value = known(read_value(at, parameters_), begin);
    if (centre)
      t.axis_scale_centre_mm[axis - 'X'] = value * unit_mm();
    else if (!(value > 0))
      throw FormulaError(begin, "scaling", fmt::format("a scale of {}; greater than zero was expected", value));
    else
      t.axis_scale[axis - 'X'] = value;
  }
  update_frame();
}

/// TRANS DATUM, MIRROR, ROTATION, SCALE of newer controls.
void Klartext::run_transform(const Statement& s) {
  Cursor at = cursor(s);
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
  error(s.begin, "not-a-word",
        fmt::format("TRANS {} is not known; DATUM, MIRROR, ROTATION or SCALE was expected", what));
}

// --- tilted planes

/// CYCL DEF 19.1 A-90 B+0 C+0 F ABST: spatial angles; empty: off.
void Klartext::set_working_plane(Cursor at, int part) {
  if (part == 0) return;
  Vec3 angles = Vec3::Zero();
  bool any = false;
  while (at.more()) {
    const std::size_t begin = at.offset();
    const char axis = at.peek();
    const std::string letters = at.letters();
    if (axis >= 'A' && axis <= 'C' && letters.size() == 1) {
      at.advance();
      angles[axis - 'A'] = known(read_value(at, parameters_), begin);
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
    tilt(spatial(angles), Turn::stay, statement_->begin);
}

/// Notes the plane of a feed move.
void Klartext::note_cut_plane() {
  if (!options_.rotary_axes.empty() || cut_planes_.size() > 1) return;
  const auto same = [](const Matrix& a, const Matrix& b) { return (a - b).cwiseAbs().maxCoeff() < 1e-9; };
  if (!cut_planes_.empty() && cut_planes_.back().tilt.has_value() == tilt_.has_value() &&
      (!tilt_ || same(*cut_planes_.back().tilt, *tilt_)))
    return;
  cut_planes_.push_back({tilt_, base_});
  if (cut_planes_.size() == 2)
    warn(statement_->begin, "tilted-plane",
         "the program cuts in more than one plane from here on; without a machine file with [kinematics] they lie over "
         "each other, and no simulation of material is right");
}

/// The blank in the coordinates of the plane in which the program cuts. Where that is more than one, or the blank
/// stands askew in it, there is none.
void Klartext::place_stock() {
  if (!out_.stock || cut_planes_.empty() || (cut_planes_.size() == 1 && !cut_planes_.front().tilt)) return;
  const CutPlane& plane = cut_planes_.front();
  const bool square =
      plane.tilt && (plane.tilt->cwiseAbs().array().round() - plane.tilt->cwiseAbs().array()).abs().maxCoeff() < 1e-9;
  if (cut_planes_.size() > 1 || !square || out_.stock->cylinder) return out_.stock.reset();
  const Matrix linear = linear_of(plane.base, tool_axis_);
  const auto in_plane = [&](const Vec3& p) {
    return Vec3(plane.tilt->transpose() * linear.inverse() * (p - shift_of(plane.base, tool_axis_)));
  };
  const Vec3 a = in_plane(out_.stock->min_mm), b = in_plane(out_.stock->max_mm);
  out_.stock->min_mm = a.cwiseMin(b);
  out_.stock->max_mm = a.cwiseMax(b);
}

void Klartext::tilt(const Matrix& rotation, Turn turn, std::size_t offset) {
  end_compensation();
  const std::uint8_t open_before = open_axes_;
  const bool start_open_before = start_open_;
  if (options_.rotary_axes.empty() && !(tilt_ && *tilt_ == rotation)) carried_over_ = 7;
  tilt_ = rotation;
  in_plane_ = {};
  update_frame();
  if (options_.rotary_axes.empty()) {
    if (!rotation.isIdentity(1e-12))
      warn(offset, "tilted-plane",
           "a tilted plane is read as it is programmed, with the side of the part up that it machines: where it lies "
           "takes "
           "a machine file with [kinematics]",
           "tilted");
    state_.work_frame = WorkFrame::machine;
    return;
  }
  if (state_.tip_control != TipControl::off) set_tip_control(false);
  state_.work_frame = WorkFrame::tilted;
  state_changed_ = true;
  if (!out_.moves.empty() && (direction_unknown_ || rotary_rad_ != Vec3::Zero())) {
    open_axes_ = 7;
    start_open_ = true;
  }
  if (turn == Turn::stay) return;
  const bool keeps_tip = turn == Turn::move;
  if (keeps_tip) set_tip_control(true);
  open_axes_ = keeps_tip ? open_before : 7;
  start_open_ = !keeps_tip || start_open_before;
  Move& move = add_move(MoveKind::rapid, position_mm_);
  move.editable = false;
  direction_target(rotation.col(2), out_.moves.size() - 1);
  set_tip_control(false);
  open_axes_ = keeps_tip ? open_before : 7;
  start_open_ = open_axes_ != 0;
}

void Klartext::reset_tilt(Turn turn) {
  if (tilt_) {
    end_compensation();
    if (options_.rotary_axes.empty() && !tilt_->isIdentity(1e-12)) carried_over_ = 7;
  }
  tilt_.reset();
  in_plane_ = {};
  update_frame();
  if (options_.rotary_axes.empty()) return;
  if (state_.work_frame != WorkFrame::machine) {
    state_.work_frame = WorkFrame::machine;
    state_changed_ = true;
    if (!out_.moves.empty()) {
      open_axes_ = 7;
      start_open_ = true;
    }
  }
  if (turn == Turn::stay) return;
  BlockValues b;
  b.rapid = true;
  for (const RotaryOption& axis : options_.rotary_axes) b.rotary[static_cast<std::size_t>(axis.letter - 'A')] = 0.0;
  turn_only(b);
}

/// PLANE SPATIAL, PROJECTED, EULER, VECTOR, POINTS, RELATIV, AXIAL, RESET.
void Klartext::run_plane(const Statement& s) {
  Cursor at = cursor(s);
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
        values["ROT"] = known(read_value(at, parameters_), begin);
        continue;
      }
      if (begins_number(at)) read_value(at, parameters_);
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
    values[word] = known(read_value(at, parameters_), begin);
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
    const Matrix now = tilt_.value_or(Matrix::Identity());
    return tilt(now * spatial(vector("SPA", "SPB", "SPC")), turns, s.begin);
  }
  if (form == "AXIAL") {
    if (options_.rotary_axes.empty()) return tilt(spatial(vector("A", "B", "C")), turns, s.begin);
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
  error(s.begin, "plane",
        fmt::format(
            "PLANE {} is not known; SPATIAL, PROJECTED, EULER, VECTOR, POINTS, RELATIV, AXIAL or RESET was expected",
            form));
}

bool Klartext::begins_number(Cursor& at) {
  const char c = at.peek();
  return is_digit(c) || c == '+' || c == '-' || c == '.' ||
         (c == 'Q' && (is_digit(at.behind(1)) || at.behind(1) == 'L'));
}

// --- tool-centre-point control

void Klartext::run_tcpm(const Statement& s) {
  Cursor at = cursor(s);
  const bool off = at.letters() == "RESET";
  set_tip_control(!off);
}

void Klartext::set_tip_control(bool on) {
  if (options_.rotary_axes.empty()) return;
  const TipControl control = on ? TipControl::angles : TipControl::off;
  if (control == state_.tip_control) return;
  if (on && state_.work_frame == WorkFrame::tilted) {
    // The tip in the tilted plane: as a frame that is fixed to the part.
    state_.work_frame = WorkFrame::machine;
  }
  if (on) update_tool_length();
  state_.tip_control = control;
  if (!on && tilt_) state_.work_frame = WorkFrame::tilted;
  state_changed_ = true;
  if (!out_.moves.empty() && (direction_unknown_ || rotary_rad_ != Vec3::Zero())) {
    open_axes_ = 7;
    start_open_ = true;
  }
}

}  // namespace camber::nc::heidenhain
