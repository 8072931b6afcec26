#include <string>
#include <vector>

#include "base/units.h"
#include "nc/emit/number_style.h"
#include "posture/posture_program.h"

namespace camber::posture {
namespace {

/// The rotary axes as words, and their angles as written.
std::vector<std::string> rotary_words(const kinematics::Chain& chain, Vec3& rad, int decimals,
                                      const nc::FiveAxisText& text) {
  std::vector<std::string> out;
  for (const char letter : chain.rotary_axes()) {
    double& angle = rad[letter - 'a'];
    const double deg = nc::rounded(deg_from_rad(angle), decimals);
    out.push_back(text.word(static_cast<char>(letter - 'a' + 'A'), deg, decimals));
    angle = rad_from_deg(deg);
  }
  return out;
}

}  // namespace

WrittenFrame frame_text(const kinematics::Chain& chain, nc::OneDirection written, const Vec3& axis, int decimals,
                        const nc::FiveAxisText& text) {
  WrittenFrame out;
  Vec3 upright = Vec3::Zero(), rad = chain.solve_tool_axis(axis, {}).joints.rotary_rad;
  nc::FrameLines lines;
  if (written == nc::OneDirection::dynamic) {
    lines = text.dynamic_frame();
    lines.before.insert(lines.before.begin(), text.rapid_line(rotary_words(chain, rad, decimals, text)));
    lines.work_from_frame = chain.table_rotation(rad);
    out.axis = lines.work_from_frame * chain.pose({}, 0).axis;
  } else {
    const bool negative = !chain.rotary_axes().empty() && rad[chain.rotary_axes().front() - 'a'] < 0;
    lines = text.tilted_frame(axis, decimals, negative);
    out.axis = lines.work_from_frame.col(2);
  }
  lines.behind.push_back(text.rapid_line(rotary_words(chain, upright, decimals, text)));
  out.frame.frame_from_work = lines.work_from_frame.transpose();
  out.frame.before = std::move(lines.before);
  out.frame.behind = std::move(lines.behind);
  return out;
}

}  // namespace camber::posture
