#include "repath/plain_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "nc/emit/text_rules.h"
#include "nc/language.h"
#include "nc/modal_codes.h"

namespace camber::repath {
namespace {

bool is_coordinate(char letter) { return letter >= 'X' && letter <= 'Z'; }
bool is_of_arc(char letter) { return (letter >= 'I' && letter <= 'K') || letter == 'R'; }
bool is_motion(const nc::Word& w) { return w.letter == 'G' && w.value >= 0 && w.value <= 3; }
int tenths_of(const nc::Word& w) { return static_cast<int>(std::lround(10 * w.value)); }

/// A code or speed that acts at the start of its block and says nothing but itself: where it repeats what is in force
/// it may be left out. The key is that of its modal group; none: not such a word.
std::optional<int> modal_key(const nc::Word& w) {
  constexpr int kMCodes = 1000, kSpeed = 2000;
  if (w.letter == 'S') return kSpeed;
  if (w.letter == 'M') {
    const nc::MGroup group = nc::m_code(tenths_of(w));
    if (group == nc::MGroup::spindle || group == nc::MGroup::coolant) return kMCodes + static_cast<int>(group);
    return std::nullopt;
  }
  if (w.letter != 'G') return std::nullopt;
  const nc::GGroup group = nc::g_code(tenths_of(w)).group;
  switch (group) {
    case nc::GGroup::plane:
    case nc::GGroup::distance:
    case nc::GGroup::arc_distance:
    case nc::GGroup::feed_mode:
    case nc::GGroup::unit:
    case nc::GGroup::path_control:
    case nc::GGroup::cutter_radius:
    case nc::GGroup::tool_length:
    case nc::GGroup::work_offset:
      return static_cast<int>(group);
    default:
      return std::nullopt;
  }
}

/// Returns whether the word is one of these that may change in the first block of a run.
bool may_lead(const nc::Word& w) {
  if (w.letter == 'S') return true;
  if (w.letter == 'M') return w.value != 5 && w.value != 9;  // these act at the end of their block
  const nc::GGroup group = nc::g_code(tenths_of(w)).group;
  return group != nc::GGroup::cutter_radius && group != nc::GGroup::tool_length && group != nc::GGroup::work_offset;
}

/// Reads the program from its top and keeps what is in force.
class Walk {
 public:
  Walk(const nc::Program& program, bool arcs)
      : program_(program),
        rules_(nc::language_of(program).text_rules(program)),
        arcs_(arcs),
        jumps_(rules_->numbers_are_targets()) {}

  std::vector<std::uint16_t> run() {
    std::vector<std::uint16_t> out(program_.blocks.size());
    for (std::size_t b = 0; b < out.size(); ++b) {
      const nc::Block& block = program_.blocks[b];
      if (block.word_count == 0 && !block.flow) continue;
      const Apart inside = apart(b, false), first = apart(b, true);
      out[b] = static_cast<std::uint16_t>(static_cast<unsigned>(inside) | static_cast<unsigned>(first) << 8);
      if (block.skip != 0)
        take_skipped(b);
      else
        take(b);
    }
    return out;
  }

 private:
  Apart apart(std::size_t b, bool first) const {
    const nc::Block& block = program_.blocks[b];
    if (block.skip != 0) return Apart::skip;
    if (block.flow) return Apart::macro;
    if (block.divided) return Apart::several;
    if (depends_on_switch_) return Apart::behind_skip;
    if (!rules_->motion_is_modal()) return apart_of(rules_->beside(static_cast<std::uint32_t>(b)));
    std::size_t at = block.offset;
    const std::string& text = program_.source.text();
    const auto blank = [&](std::size_t to) {
      for (; at < to; ++at)
        if (text[at] != ' ' && text[at] != '\t') return false;
      return true;
    };
    for (const nc::Word& w : program_.words_of(b)) {
      if (!blank(w.offset)) return Apart::comment;
      at = w.offset + w.length;
      if (std::isnan(w.value)) return Apart::macro;
      if (is_coordinate(w.letter) || w.letter == 'F' || (w.letter == 'G' && w.value == 1)) continue;
      if (arcs_ && (is_of_arc(w.letter) || (is_motion(w) && w.value >= 2))) continue;
      if (w.letter == 'N' && !jumps_) continue;
      if (w.letter == 'N') return Apart::number;
      if (is_motion(w) || !(repeats(w) || (first && modal_key(w) && may_lead(w)))) return Apart::word;
    }
    return blank(block.offset + block.length) ? Apart::nothing : Apart::comment;
  }

  static Apart apart_of(nc::Beside beside) {
    switch (beside) {
      case nc::Beside::nothing:
        return Apart::nothing;
      case nc::Beside::comment:
        return Apart::comment;
      case nc::Beside::word:
        return Apart::word;
      case nc::Beside::expression:
        return Apart::macro;
      case nc::Beside::skip:
        return Apart::skip;
      case nc::Beside::several:
        break;
    }
    return Apart::several;
  }

  bool repeats(const nc::Word& w) const {
    if (jumps_) return false;
    const auto key = modal_key(w);
    const auto found = key ? in_force_.find(*key) : in_force_.end();
    return found != in_force_.end() && found->second == w.value;
  }

  void take(std::size_t b) {
    std::uint8_t given = 0;
    bool motion = false;
    for (const nc::Word& w : program_.words_of(b)) {
      if (is_coordinate(w.letter)) given = static_cast<std::uint8_t>(given | 1U << (w.letter - 'X'));
      motion |= is_motion(w) || (w.letter == 'G' && nc::g_code(tenths_of(w)).group == nc::GGroup::cycle);
      note(w);
    }
    if (!depends_on_switch_) return;
    open_axes_ = static_cast<std::uint8_t>(incremental() && given != 0 ? 0 : open_axes_ & ~given);
    open_motion_ = open_motion_ && !motion;
    std::erase_if(open_groups_, [&](int group) { return in_force_.contains(group); });
    depends_on_switch_ = open_axes_ != 0 || open_motion_ || !open_groups_.empty();
  }

  /// Takes a block that the skip switch may leave out: until words say where the tool is and what moves it, all depends
  /// on the switch.
  void take_skipped(std::size_t b) {
    for (const nc::Word& w : program_.words_of(b)) {
      if (is_coordinate(w.letter)) open_axes_ = static_cast<std::uint8_t>(open_axes_ | 1U << (w.letter - 'X'));
      const auto key = modal_key(w);
      if (is_motion(w)) {
        open_motion_ = true;
      } else if (key) {
        if (repeats(w)) continue;
        in_force_.erase(*key);
        if (w.letter == 'G') open_groups_.push_back(*key);
      } else if (w.letter == 'M') {
        note(w);
      } else if (w.letter == 'G' && tenths_of(w) != 40 && tenths_of(w) != 90) {  // a dwell, an exact stop
        constexpr std::uint8_t kAll = 7;
        open_axes_ = kAll;
      }
    }
    depends_on_switch_ = open_axes_ != 0 || open_motion_ || !open_groups_.empty();
  }

  bool incremental() const {
    const auto found = in_force_.find(static_cast<int>(nc::GGroup::distance));
    return found != in_force_.end() && found->second == 91;
  }

  void note(const nc::Word& w) {
    if (const auto key = modal_key(w)) {
      in_force_[*key] = w.value;
    } else if (w.letter == 'M') {
      // A tool change, a stop, an unknown code: what of spindle and coolant is in force behind it is not known.
      std::erase_if(in_force_, [](const auto& entry) { return entry.first >= 1000; });
    }
  }

  const nc::Program& program_;
  std::unique_ptr<nc::TextRules> rules_;
  bool arcs_, jumps_;
  std::map<int, double> in_force_;
  bool depends_on_switch_ = false, open_motion_ = false;
  std::vector<int> open_groups_;
  std::uint8_t open_axes_ = 0;
};

}  // namespace

std::string_view reason_of(Apart apart) {
  constexpr std::array<std::string_view, static_cast<std::size_t>(Apart::count)> kReasons{
      "",
      "a comment or a sign in the block",
      "a word in the block that changes something else",
      "a block number in a program with macros or subprograms",
      "expressions, statements or calls",
      "block skip (/)",
      "a block before it that may be skipped (/)",
      "several blocks in a line, or several moves in a block",
      "another feed",
      "another spindle speed, plane, offset or mode",
      "other lines between",
      "an exact stop",
      "inverse time or feed per revolution",
      "cutter radius compensation",
      "turned, scaled or polar coordinates",
      "a loop, an expression, a subprogram, a corner word or a cycle"};
  return kReasons[static_cast<std::size_t>(apart)];
}

PlainBlocks::PlainBlocks(const nc::Program& program, bool arcs) : blocks_(Walk(program, arcs).run()) {}

std::vector<nc::Word> further_words_of(std::span<const nc::Word> words) {
  std::vector<nc::Word> out;
  for (const nc::Word& w : words)
    if (w.letter != 'N' && !is_coordinate(w.letter) && !is_of_arc(w.letter) && !is_motion(w)) out.push_back(w);
  return out;
}

}  // namespace camber::repath
