#include "nc/spindle_speeds.h"

#include <map>

#include "nc/emit/block_writer.h"
#include "nc/emit/emitted_text.h"
#include "nc/language.h"

namespace camber::nc {
namespace {

constexpr NumberStyle kSpeedStyle{.whole = WholeStyle::plain};

/// The S words of a program, each with the cuts up to the next one.
class SpeedWords {
 public:
  SpeedWords(const Program& program, const Interpretation& moves, std::span<const double> rpm)
      : program_(program), moves_(moves), rpm_(rpm), rules_(language_of(program).text_rules(program)) {}

  SpeedEmission run() {
    std::vector<Event> words;
    for (const Event& e : moves_.events)
      if (e.kind == EventKind::spindle_speed) words.push_back(e);
    for (std::size_t i = 0; i < words.size() && out_.why_not.empty(); ++i)
      plan(words[i], i + 1 < words.size() ? words[i + 1].before_move : moves_.moves.size());
    if (out_.why_not.empty()) write();
    return std::move(out_);
  }

 private:
  double wanted(std::size_t move) const {
    return rpm_[move] > 0 ? rpm_[move] : moves_.state_of(moves_.moves[move]).programmed_spindle_speed_rpm;
  }

  void plan(const Event& word, std::size_t end) {
    double now = 0;
    for (std::size_t m = word.before_move; m < end; ++m) {
      if (moves_.moves[m].feed_mm_per_s <= 0 || wanted(m) == now) continue;
      if (now == 0)
        set(words_, word.block, wanted(m), word.value);
      else if (moves_.moves[m].editable && program_.blocks[moves_.moves[m].block].skip == 0)
        set(lines_, moves_.moves[m].block, wanted(m), word.value);
      else
        refuse("no S word stands where the speed begins", moves_.moves[m].block);
      now = wanted(m);
    }
  }

  struct Speed {
    double rpm = 0, programmed = 0;
  };
  void set(std::map<std::uint32_t, Speed>& places, std::uint32_t block, double rpm, double programmed) {
    const auto [at, fresh] = places.try_emplace(block, Speed{rpm, programmed});
    if (!fresh && at->second.rpm != rpm) refuse("its S word is read again for a cut of another speed", block);
  }

  void refuse(std::string why, std::uint32_t block) {
    if (out_.why_not.empty()) out_.why_not = std::move(why), out_.line = block + std::size_t{1};
  }

  void write() {
    const NumberStyle style = style_of(program_);
    EmittedText text(program_, *rules_);
    std::map<std::uint32_t, bool> blocks;
    for (const auto& [block, speed] : words_) blocks[block] = speed.rpm != speed.programmed;
    for (const auto& [block, speed] : lines_) blocks[block] = true;
    for (const auto& [block, changes] : blocks) {
      if (!changes) continue;
      BlockWriter writer(program_, block, style, *rules_);
      if (const auto w = words_.find(block); w != words_.end() && w->second.rpm != w->second.programmed)
        set_word(writer, w->second);
      if (const auto l = lines_.find(block); l != lines_.end())
        writer.put_before(rules_->speed_line(address(), format_number(l->second.rpm, 0, kSpeedStyle)));
      if (!out_.why_not.empty()) return;
      text.replace(block, writer.text(text.line_end_of(block)));
    }
    out_.emission.text = text.text({});
    out_.emission.block_of_line = text.block_of_lines();
  }

  void set_word(BlockWriter& writer, const Speed& speed) {
    const auto word = rules_->speed_word(writer.block(), speed.programmed);
    if (!word) return refuse("its S word is no plain number of the program", writer.block());
    const std::size_t from = word->offset + word->value_at, length = std::size_t{word->length} - word->value_at;
    writer.replace(from, length, format_number(speed.rpm, 0, kSpeedStyle, program_.source.text().substr(from, length)));
  }

  /// Returns the text of the program's S words before the number: "S", "S1=".
  std::string address() const {
    for (const auto& [block, speed] : words_)
      if (const auto word = rules_->speed_word(block, speed.programmed))
        return program_.source.text().substr(word->offset, word->value_at);
    return "S";
  }

  const Program& program_;
  const Interpretation& moves_;
  std::span<const double> rpm_;
  std::unique_ptr<TextRules> rules_;
  std::map<std::uint32_t, Speed> words_, lines_;  ///< by block: its own S word; a line before it
  SpeedEmission out_;
};

}  // namespace

SpeedEmission emit_spindle_speeds(const Program& program, const Interpretation& moves, std::span<const double> rpm) {
  return SpeedWords(program, moves, rpm).run();
}

}  // namespace camber::nc
