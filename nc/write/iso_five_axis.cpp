// Programs with rotary axes in G code: G43.4, G234 or M428, G68.2 and G254.
#include <algorithm>

#include <fmt/format.h>

#include "base/units.h"
#include "nc/five_axis_words.h"
#include "nc/frames.h"
#include "nc/write/five_axis_text.h"

namespace camber::nc {
namespace {

constexpr std::initializer_list<double> kTipControl{43.4, 43.5, 234};

class IsoFiveAxisText : public FiveAxisCodes {
 public:
  using FiveAxisCodes::FiveAxisCodes;

  std::string_view control_words() const override { return "G43.4, G43.5, G234 or M428"; }

  void pass(std::uint32_t block) override {
    std::string number;
    const auto words = program_.words_of(block);
    for (const Word& w : words)
      if (w.letter == 'H')
        number = program_.source.text().substr(w.offset + w.value_at, static_cast<std::size_t>(w.length - w.value_at));
    for (const Word& w : words) {
      if (w.letter == 'G' && (w.value == 43 || w.value == 44)) {
        length_active_ = true;
        length_number_ = number;
      }
      if (w.letter == 'G' && w.value == 49) length_active_ = false;
    }
  }

  std::vector<std::string> control_on(std::uint32_t block) const override {
    std::vector<std::string> out;
    const std::string number = length_active_ && !length_number_.empty() ? length_number_ : "0";
    if (by_code()) {
      if (!BlockEdit(program_, block).find_code('G', {43})) out.push_back(tip_control() + " H" + number);
      return out;
    }
    if (!length_active_) out.emplace_back("G43 H0");
    out.push_back(fmt::format("M{}", dialect_.tip_control_on_m));
    return out;
  }

  std::vector<std::string> control_off() const override {
    if (by_code()) return {length_active_ ? "G43 H" + (length_number_.empty() ? "0" : length_number_) : "G49"};
    std::vector<std::string> out{fmt::format("M{}", dialect_.tip_control_off_m)};
    if (!length_active_) out.emplace_back("G49");
    return out;
  }

  /// Where a G code switches it on, G43 and G49 of the same length switch it off.
  void keep_control(BlockEdit& edit) const override {
    if (!by_code()) return;
    if (const Word* w = edit.find_code('G', {43})) edit.replace(*w, tip_control().substr(1));
    if (const Word* w = edit.find_code('G', {49})) edit.take_out(*w);
  }

  /// The tool length stays.
  void take_out_control(BlockEdit& edit) const override {
    const double on = dialect_.tip_control_on_m, off = dialect_.tip_control_off_m;
    for (const Word& w : edit.words()) {
      if (w.letter == 'G' && std::find(kTipControl.begin(), kTipControl.end(), w.value) != kTipControl.end())
        edit.replace(w, "43");
      else if (w.letter == 'M' && on != 0 && (w.value == on || w.value == off))
        edit.take_out(w);
    }
  }

  void take_out_curve(BlockEdit& edit, bool arc, bool direction) const override {
    if (!arc && !direction) return;
    for (const char letter : {'I', 'J', 'K', 'R', 'P'})
      if (const Word* w = edit.find(letter)) edit.take_out(*w);
  }

  FrameLines tilted_frame(const Vec3& axis, int decimals, bool) const override {
    FrameLines out;
    const Vec3 angles = rounded_angles(leaning_frame(axis), decimals);
    std::string line = "G68.2";
    for (const char letter : {'X', 'Y', 'Z'}) line += " " + word(letter, 0, decimals);
    for (int i = 0; i < 3; ++i) line += " " + word("IJK"[i], deg_from_rad(angles[i]), decimals);
    out.before = {line, "G53.1"};
    out.behind = {"G69"};
    out.work_from_frame = euler_zxz(angles);
    return out;
  }

  FrameLines dynamic_frame() const override { return {.before = {"G254"}, .behind = {"G255"}}; }

 private:
  bool by_code() const { return dialect_.tip_control_on_m == 0; }
  std::string tip_control() const { return std::string(five_axis_words(dialect_).tip_control); }

  bool length_active_ = false;
  std::string length_number_ = "0";  ///< of H
};

}  // namespace

std::unique_ptr<FiveAxisText> iso_five_axis_text(const Program& program, const Dialect& dialect) {
  return std::make_unique<IsoFiveAxisText>(program, dialect);
}

}  // namespace camber::nc
