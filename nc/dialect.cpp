#include "nc/dialect.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "nc/dialects.h"
#include "nc/modal_codes.h"
#include "nc/program_text.h"

namespace camber::nc {
namespace {

const Dialect* dialect_with(bool Dialect::*fact) { return &*std::ranges::find(kDialects, true, fact); }

bool has_o_words(const Program& program) {
  return !program.macro.expressions.names.empty() ||
         std::ranges::any_of(program.macro.statements, [](const Statement& s) { return s.o_word; });
}

/// G154, or one of G110 to G129 that nobody else has.
bool has_haas_offsets(const Program& program) {
  constexpr int kPolar = 1120, kG154 = 1540;
  return std::ranges::any_of(program.words, [](const Word& w) {
    if (w.letter != 'G' || !(w.value >= 110 && w.value <= 154)) return false;
    const int tenths = static_cast<int>(10 * w.value + 0.5);
    return tenths == kG154 || (haas_work_offset_of(tenths) > 0 && tenths != kPolar);
  });
}

/// Its own ending of a file's name, or G28.1 and G30.1, which nobody else has.
bool is_for_linuxcnc(const Program& program) {
  const std::string_view name = program.source.name();
  constexpr std::string_view kEnding = ".ngc";
  const bool ends = name.size() > kEnding.size() &&
                    std::ranges::equal(name.substr(name.size() - kEnding.size()), kEnding,
                                       [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  return ends || std::ranges::any_of(program.words, [](const Word& w) {
           return w.letter == 'G' && (std::abs(w.value - 28.1) < 1e-9 || std::abs(w.value - 30.1) < 1e-9);
         });
}

constexpr bool unique(bool Dialect::*fact) { return std::ranges::count(kDialects, true, fact) == 1; }
static_assert(unique(&Dialect::shown_by_o_words) && unique(&Dialect::shown_by_m97) &&
                  unique(&Dialect::haas_work_offsets) && unique(&Dialect::stores_reference_points),
              "a construct shows one dialect");

}  // namespace

std::span<const Dialect> dialects() { return kDialects; }

const Dialect& default_dialect() { return kDialects.front(); }

const Dialect* dialect_named(std::string_view name) {
  const auto found = std::ranges::find(kDialects, name, &Dialect::name);
  return found != kDialects.end() ? &*found : nullptr;
}

const Dialect* dialect_shown_by(const Program& program) {
  if (has_o_words(program)) return dialect_with(&Dialect::shown_by_o_words);
  if (program.macro.local_calls) return dialect_with(&Dialect::shown_by_m97);
  if (has_haas_offsets(program)) return dialect_with(&Dialect::haas_work_offsets);
  if (is_for_linuxcnc(program)) return dialect_with(&Dialect::stores_reference_points);
  return nullptr;
}

}  // namespace camber::nc
