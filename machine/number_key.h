#pragma once
// A number of a TOML table and the field it fills: one list serves reading, defaults and writing.
#include <span>
#include <string>
#include <string_view>

#include "base/units.h"
#include "machine/toml_table.h"

namespace camber::machine {

/// Conversion at the file's door.
struct FileUnit {
  double (*inside_from_file)(double);
  double (*file_from_inside)(double);
};

inline constexpr FileUnit kAsIs{[](double v) { return v; }, [](double v) { return v; }};
inline constexpr FileUnit kPerMinute{[](double v) { return mm_per_s_from_mm_per_min(v); },
                                     [](double v) { return mm_per_min_from_mm_per_s(v); }};
inline constexpr FileUnit kMilliseconds{[](double v) { return v / 1000.0; }, [](double v) { return v * 1000.0; }};
inline constexpr FileUnit kDegrees{[](double v) { return rad_from_deg(v); }, [](double v) { return deg_from_rad(v); }};
inline constexpr FileUnit kGigapascals{[](double v) { return MPa_from_GPa(v); }, [](double v) { return v / 1000.0; }};
inline constexpr FileUnit kMicrometres{[](double v) { return mm_from_um(v); }, [](double v) { return um_from_mm(v); }};
inline constexpr FileUnit kNewtonMetres{[](double v) { return v * 1000.0; }, [](double v) { return v / 1000.0; }};
inline constexpr FileUnit kAsPercent{[](double v) { return v / 100.0; }, [](double v) { return v * 100.0; }};
inline constexpr FileUnit kNewtonsPerMicrometre{[](double v) { return N_per_mm_from_N_per_um(v); },
                                                [](double v) { return v / 1000.0; }};

/// `key` of the file fills `field`; missing, the field keeps its default.
template <class Struct>
struct NumberKey {
  std::string_view key;
  double Struct::*field;
  NumberRange range;
  FileUnit unit = kAsIs;
};

template <class Struct>
void read_numbers(TomlTable& table, std::span<const NumberKey<Struct>> keys, Struct& into) {
  for (const auto& k : keys)
    if (const auto value = table.optional_number(k.key, k.range)) into.*k.field = k.unit.inside_from_file(*value);
}

/// The shortest text that `unit` converts back to exactly this value; 15 digits where there is none.
std::string toml_number(double inside, const FileUnit& unit);
/// `key = value` and a line end.
std::string toml_line(std::string_view key, double inside, const FileUnit& unit);
/// `key = "value"` and a line end; the text is escaped.
std::string toml_line(std::string_view key, std::string_view text);
/// Text in quotes.
std::string toml_text(std::string_view text);

template <class Struct>
std::string toml_lines(std::span<const NumberKey<Struct>> keys, const Struct& from) {
  std::string out;
  for (const auto& k : keys) out += toml_line(k.key, from.*k.field, k.unit);
  return out;
}

}  // namespace camber::machine
