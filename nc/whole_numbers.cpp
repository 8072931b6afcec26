#include "nc/whole_numbers.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace camber::nc {

/// Returns the unit of a number without a point that counts increments: of a length, an angle or a time; 1 for letters
/// that are no quantities in this block.
double WholeNumbers::unit_of(char letter, bool& is_angle) const {
  const Dialect& dialect = at_.dialect();
  constexpr double kTime_s = 0.001;
  const double length = modal_.state().inch ? dialect.least_increment_inch : dialect.least_increment_mm;
  const int frame_code = at_.request.frame_code.word ? at_.request.frame_code.tenths : 0;
  const bool arc = modal_.is_arc();
  is_angle = std::string_view("ABCa").find(letter) != std::string_view::npos ||
             (letter == 'R' && (frame_code == 680 || frame_code == 682)) ||
             (letter >= 'I' && letter <= 'K' && frame_code == 682) ||
             (frames_.frame().polar && letter == "XYZ"[axes_of(modal_.plane()).second]);
  if (at_.request.dwell && (letter == 'X' || letter == 'U')) return kTime_s;
  if (is_angle) return dialect.least_increment_deg;
  switch (letter) {
    case 'F':
      if (modal_.state().feed_mode == FeedMode::inverse_time) return 1;
      if (modal_.state().feed_mode == FeedMode::per_revolution)
        return modal_.state().inch ? dialect.whole_feed_per_turn_inch : dialect.whole_feed_per_turn_mm;
      return modal_.state().inch ? dialect.whole_feed_inch : dialect.whole_feed_mm;
    case 'I':
    case 'J':
      return frame_code == 510 ? 1 : length;  // scales: see scale_value
    case 'K': {
      const bool of_cycle = modal_.cycle_g() != 0 &&
                            !(dialect.pecks_by_ijk && (modal_.cycle_g() == 73 || modal_.cycle_g() == 83)) &&
                            modal_.plane() == Plane::xy;
      return frame_code == 510 || of_cycle ? 1 : length;  // of a cycle: repeats
    }
    case 'Q':
      return modal_.cycle_g() != 0 || arc ? length : 1;
    default:
      return length;
  }
}

/// Returns that unit where the word is a number without a point and numbers are increments, else 1. Notes what depends
/// on it.
double WholeNumbers::scale_of(const Word& word) {
  const bool known = at_.options.whole_numbers_are_increments.has_value();
  const bool increments = at_.options.whole_numbers_are_increments.value_or(false);
  if ((known && !increments) || word.value == 0) return 1;
  const char letter = word.letter;
  const bool place = letter >= 'X' && letter <= 'Z';
  if (word.value != std::floor(word.value) || at_.written_with_point(word)) {
    noted_.any_point |= place;
    return 1;
  }
  if (!at_.written_as_number(word)) return 1;  // the value of a variable counts whole units
  bool is_angle = false;
  const double unit = unit_of(letter, is_angle);
  if (increments) return unit;
  if (unit == 1 || letter == 'F') return 1;
  Noted& noted = noted_;
  if (place && !at_.request.dwell)
    noted.largest_mm = std::max(noted.largest_mm, std::abs(word.value) * modal_.unit_mm());
  if (noted.file) {
    ++noted.more;
    return 1;
  }
  noted.file = at_.program;
  noted.offset = word.offset;
  noted.text = at_.program->source.text().substr(word.offset, word.length);
  noted.value = word.value;
  noted.scale = unit;
  noted.is_time = at_.request.dwell && (letter == 'X' || letter == 'U');
  noted.is_angle = !noted.is_time && is_angle;
  noted.inch = modal_.state().inch;
  return 1;
}

void WholeNumbers::scale_block() {
  if (at_.dialect().whole_numbers_setting.empty() && !at_.options.whole_numbers_are_increments) return;
  if (at_.options.whole_numbers_are_increments && !*at_.options.whole_numbers_are_increments) return;
  for (const char letter : std::string_view("XYZUVWIJKRQABCF")) {
    if (!at_.words.has(letter)) continue;
    const double scale = scale_of(at_.words.word(letter));
    if (scale == 1) continue;
    at_.words.scale(letter, scale);
    at_.editable = false;
  }
}

void WholeNumbers::warn() {
  const Noted& w = noted_;
  if (at_.options.whole_numbers_are_increments || !at_.options.dialect || !w.file) return;  // no control is named
  at_.report.set_source(w.file->source);
  at_.report.warning(
      w.offset, "decimal-point",
      fmt::format("{}{} no decimal point; {} is read as {}, but a control set to least increments ({}) reads {}: "
                  "--least-increments, or [control] whole_numbers in machine.toml, says which",
                  w.text, w.more > 0 ? fmt::format(" and {} further words have", w.more) : std::string(" has"), w.text,
                  w.read_with(1), setting(), w.read_with(w.scale)));
}

/// Returns the name of the control's setting; where no control is named, those of all.
std::string WholeNumbers::setting() const {
  if (at_.options.dialect) return std::string(at_.options.dialect->whole_numbers_setting);
  std::string out;
  for (const Dialect& dialect : dialects())
    if (!dialect.whole_numbers_setting.empty())
      out += fmt::format("{}{}: {}", out.empty() ? "" : "; ", dialect.title, dialect.whole_numbers_setting);
  return out;
}

/// "50 mm", "0.05 mm", "2 s", "45 degrees".
std::string WholeNumbers::Noted::read_with(double factor) const {
  const double number = value * factor;
  return is_time    ? fmt::format("{:g} s", number)
         : is_angle ? fmt::format("{:g} degrees", number)
         : inch     ? fmt::format("{:g} inch", number)
                    : fmt::format("{:g} mm", number);
}

void WholeNumbers::add_verdict(RunVerdict& out) const {
  constexpr double kLargestMachine_mm = 10'000;
  const Noted& w = noted_;
  if (at_.options.whole_numbers_are_increments || w.file != &at_.main || w.any_point ||
      w.largest_mm <= kLargestMachine_mm)
    return;
  out.increments_offset = w.offset;
  out.increments_warning = fmt::format(
      "no coordinate has a decimal point, and as millimetres or inches they would lie up to {:.0f} mm away; they are "
      "read as least increments ({} is {}), for a control set so ({}); else: [control] whole_numbers = \"units\" in "
      "machine.toml",
      w.largest_mm, w.text, w.read_with(w.scale), setting());
}

}  // namespace camber::nc
