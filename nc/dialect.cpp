#include "nc/dialect.h"

#include <algorithm>

#include "nc/dialects.h"
#include "nc/modal_codes.h"
#include "nc/program.h"

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

constexpr bool unique(bool Dialect::*fact) { return std::ranges::count(kDialects, true, fact) == 1; }
static_assert(unique(&Dialect::shown_by_o_words) && unique(&Dialect::shown_by_m97) &&
                  unique(&Dialect::haas_work_offsets),
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
  return nullptr;
}

}  // namespace camber::nc
