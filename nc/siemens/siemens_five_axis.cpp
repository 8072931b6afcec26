// Sinumerik programs with rotary axes: TRAORI and TRAFOOF, CYCLE800.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "base/units.h"
#include "nc/frames.h"
#include "nc/siemens/line_parser.h"
#include "nc/siemens/siemens_language.h"
#include "nc/write/five_axis_text.h"

namespace camber::nc::siemens {
namespace {

class SiemensFiveAxis : public FiveAxisCodes {
 public:
  using FiveAxisCodes::FiveAxisCodes;

  std::string_view control_words() const override { return "TRAORI"; }
  std::vector<std::string> control_on(std::uint32_t) const override { return {"TRAORI"}; }
  std::vector<std::string> control_off() const override { return {"TRAFOOF"}; }

  /// Also CYCLE800 that swivels nothing, which TRAORI does not stand.
  void keep_control(BlockEdit& edit) const override {
    take_out_items(edit, [](const Item& i) {
      return i.row->does == Does::transform_on || i.row->does == Does::transform_off || i.row->does == Does::cycle800;
    });
  }
  void take_out_control(BlockEdit& edit) const override {
    take_out_items(
        edit, [](const Item& i) { return i.row->does == Does::transform_on || i.row->does == Does::transform_off; });
  }

  /// X12.5, X=12.5.
  bool keeps_form(const Word& word) const override {
    const std::string& text = program_.source.text();
    for (std::size_t i = word.offset + std::size_t{1}; i < word.offset + std::size_t{word.value_at}; ++i)
      if (text[i] != '=' && text[i] != ' ' && text[i] != '\t') return false;
    return true;
  }
  void take_out(BlockEdit& edit, const Word& word) const override {
    if (const Statement* s = tree_of(program_).statement(edit.block()))
      for (const Item& i : s->items)
        if (i.offset == word.offset) return edit.take_out(i.offset, i.length);
    edit.take_out(word);
  }

  void take_out_curve(BlockEdit& edit, bool arc, bool) const override {
    if (arc)
      for (const char letter : {'I', 'J', 'K', 'R'})
        if (const Word* w = edit.find(letter)) take_out(edit, *w);
    take_out_items(edit, [&](const Item& i) {
      return i.row->name == "A3" || i.row->name == "B3" || i.row->name == "C3" || (arc && i.row->name == "TURN");
    });
  }

  /// CYCLE800 with mode 57: about X, the new Y, the new Z.
  FrameLines tilted_frame(const Vec3& axis, int decimals, bool negative) const override {
    const Eigen::Matrix3d wanted = euler_zxz(leaning_frame(axis));
    const Vec3 angles =
        rounded_angles({std::atan2(-wanted(1, 2), wanted(2, 2)), std::asin(std::clamp(wanted(0, 2), -1.0, 1.0)),
                        std::atan2(-wanted(0, 1), wanted(0, 0))},
                       decimals);
    FrameLines out;
    std::string turns;
    for (int i = 0; i < 3; ++i) turns += "," + format_number(deg_from_rad(angles[i]), decimals, style_);
    out.before = {fmt::format("CYCLE800(0,\"\",100000,57,0,0,0{},0,0,0,{})", turns, negative ? -1 : 1)};
    out.behind = {"CYCLE800()"};
    out.work_from_frame = (Eigen::AngleAxisd(angles.x(), Vec3::UnitX()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
                           Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()))
                              .toRotationMatrix();
    return out;
  }

 private:
  template <typename Wanted>
  void take_out_items(BlockEdit& edit, const Wanted& wanted) const {
    const Statement* s = tree_of(program_).statement(edit.block());
    if (!s) return;
    for (const Item& i : s->items)
      if (i.row && wanted(i)) edit.take_out(i.offset, i.length);
  }
};

}  // namespace

std::unique_ptr<FiveAxisText> five_axis_text(const Program& program, const Dialect& dialect) {
  return std::make_unique<SiemensFiveAxis>(program, dialect);
}

}  // namespace camber::nc::siemens
