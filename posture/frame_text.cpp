#include "posture/posture.h"

#include <cmath>

#include "base/units.h"
#include "nc/frames.h"

namespace camber::posture {
namespace {

std::string fmt_word(char letter, double value, int decimals, const nc::NumberStyle& style) {
  return std::string(" ") + letter + nc::format_number(value, decimals, style);
}

/// "G0 A12.5 C-30.", and the angles as written.
std::string rotary_line(const kinematics::Chain& chain, Vec3& rad, int decimals, const nc::NumberStyle& style) {
  std::string out = "G0";
  for (const char letter : chain.rotary_axes()) {
    double& angle = rad[letter - 'a'];
    const double deg = nc::rounded(deg_from_rad(angle), decimals);
    out += fmt_word(static_cast<char>(letter - 'a' + 'A'), deg, decimals, style);
    angle = rad_from_deg(deg);
  }
  return out;
}

}  // namespace

WrittenFrame frame_text(const kinematics::Chain& chain, nc::OneDirection written, const Vec3& axis, int decimals,
                        const nc::NumberStyle& style) {
  WrittenFrame out;
  Vec3 upright = Vec3::Zero();
  const std::string back = rotary_line(chain, upright, decimals, style);
  if (written == nc::OneDirection::dynamic) {
    Vec3 rad = chain.solve_tool_axis(axis, {}).joints.rotary_rad;
    out.frame.before = {rotary_line(chain, rad, decimals, style), "G254"};
    out.frame.behind = {"G255", back};
    out.frame.frame_from_work = chain.table_rotation(rad).transpose();
    out.axis = out.frame.frame_from_work.transpose() * chain.pose({}, 0).axis;
    return out;
  }
  // Z of the frame along the tool, X as near to that of the program as it gets.
  const double lean = std::acos(std::min(1.0, axis.z())), turn = lean > 1e-9 ? std::atan2(axis.x(), -axis.y()) : 0;
  Vec3 angles(turn, lean, -turn);
  std::string line = "G68.2";
  for (int i = 0; i < 3; ++i) line += fmt_word("XYZ"[i], 0, decimals, style);
  for (int i = 0; i < 3; ++i) {
    const double deg = nc::rounded(deg_from_rad(angles[i]), decimals);
    line += fmt_word("IJK"[i], deg, decimals, style);
    angles[i] = rad_from_deg(deg);
  }
  const Mat3 rotation = nc::euler_zxz(angles);
  out.frame.before = {line, "G53.1"};
  out.frame.behind = {"G69", back};
  out.frame.frame_from_work = rotation.transpose();
  out.axis = rotation.col(2);
  return out;
}

}  // namespace camber::posture
