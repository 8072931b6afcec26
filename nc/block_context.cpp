#include "nc/block_context.h"

#include <utility>

#include <fmt/format.h>

namespace camber::nc {

void BlockContext::error(std::size_t offset, std::string_view check, std::string message, std::string_view alike) {
  request.trouble = true;
  report.error(offset, check, std::move(message), alike);
}

std::string BlockContext::code_text(const Code& code) const {
  const char letter = code.word->letter;
  if (code.tenths < 0) return program->source.text().substr(code.word->offset, code.word->length);
  if (code.tenths % 10 == 0) return fmt::format("{}{}", letter, code.tenths / 10);
  return fmt::format("{}{}.{}", letter, code.tenths / 10, code.tenths % 10);
}

bool BlockContext::written_with_point(const Word& word) const {
  return std::string_view(program->source.text()).substr(word.offset, word.length).find('.') != std::string_view::npos;
}

bool BlockContext::written_as_number(const Word& word) const {
  return std::string_view(program->source.text())
             .substr(word.offset + word.value_at, static_cast<std::size_t>(word.length - word.value_at))
             .find_first_of("#[ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz") == std::string_view::npos;
}

std::optional<double> BlockContext::dwell_seconds(char letter) {
  if (!words.has(letter)) return std::nullopt;
  const double value = words.value(letter);
  const Word& word = words.word(letter);
  if (value < 0) {
    error(word.offset, "dwell", fmt::format("a dwell of {} {} is negative; zero or more was expected", letter, value));
    return 0.0;
  }
  if (letter != 'P') return value;  // seconds, as scale_whole_numbers has read it
  if (written_with_point(word)) return value;
  if (options.dwell_p_is_ms) return value / 1000.0;
  if (value >= 100)
    report.warning(
        word.offset, "dwell-long",
        fmt::format("a dwell of {} s; where {} without a point counts milliseconds, the control must be named", value,
                    letter),
        "dwell-long");
  return value;
}

}  // namespace camber::nc
