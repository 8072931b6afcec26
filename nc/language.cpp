#include "nc/language.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>

#include <fmt/format.h>

#include "nc/emit/text_rules.h"
#include "nc/heidenhain/heidenhain_language.h"
#include "nc/iso_language.h"
#include "nc/siemens/siemens_language.h"
#include "nc/write/five_axis_text.h"
#include "nc/write/program_writer.h"

namespace camber::nc {
namespace {

constexpr std::array<std::string_view, 1> kHeidenhainExtensions{"h"};
constexpr std::array<std::string_view, 3> kSiemensExtensions{"mpf", "spf", "arc"};

constexpr std::array kLanguages{Language{.id = LanguageId::iso,
                                         .name = "iso",
                                         .title = "ISO G code",
                                         .read = read_iso_program,
                                         .interpret = interpret_iso,
                                         .text_rules = iso_text_rules,
                                         .writer = iso_writer,
                                         .five_axis_text = iso_five_axis_text},
                                Language{.id = LanguageId::heidenhain,
                                         .name = "heidenhain",
                                         .title = "Heidenhain Klartext",
                                         .extensions = kHeidenhainExtensions,
                                         .evidence = heidenhain::evidence,
                                         .read = heidenhain::read,
                                         .interpret = heidenhain::interpret,
                                         .text_rules = heidenhain::text_rules,
                                         .writer = heidenhain::writer,
                                         .five_axis_text = heidenhain::five_axis_text,
                                         .lines_have_numbers = true},
                                Language{.id = LanguageId::siemens,
                                         .name = "siemens",
                                         .title = "Siemens Sinumerik",
                                         .extensions = kSiemensExtensions,
                                         .evidence = siemens::evidence,
                                         .read = siemens::read,
                                         .interpret = siemens::interpret,
                                         .text_rules = siemens::text_rules,
                                         .writer = siemens::writer,
                                         .five_axis_text = siemens::five_axis_text}};

std::string extension_of(const std::string& name) {
  const std::size_t point = name.find_last_of("./\\");
  if (point == std::string::npos || name[point] != '.') return {};
  std::string out = name.substr(point + 1);
  std::ranges::transform(out, out.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

}  // namespace

std::span<const Language> languages() { return kLanguages; }

const Language& language_of(LanguageId id) {
  const auto found = std::ranges::find(kLanguages, id, &Language::id);
  assert(found != kLanguages.end());
  return *found;
}

/// Words that a single line shows may be of any language: against the name of the file they need a second line.
bool contradicts_name(const Language& shown, const LanguageEvidence& evidence, const Language* by_name) {
  return by_name && by_name != &shown && evidence.lines < 2;
}

RecognizedLanguage recognize_language(const SourceText& source) {
  const std::string extension = extension_of(source.name());
  const Language* by_name = nullptr;
  for (const Language& language : kLanguages)
    if (std::ranges::find(language.extensions, extension) != language.extensions.end()) by_name = &language;
  const Language* best = nullptr;
  LanguageEvidence of_best;
  for (const Language& language : kLanguages) {
    if (!language.evidence) continue;
    LanguageEvidence found = language.evidence(source.text());
    if (found.lines <= of_best.lines || contradicts_name(language, found, by_name)) continue;
    best = &language;
    of_best = std::move(found);
  }
  if (best) return {best, fmt::format("{} in line {}", of_best.word, source.location(of_best.offset).line)};
  if (by_name) return {by_name, fmt::format("the name ends in .{}", extension)};
  return {&kLanguages.front(), "no word of another language"};
}

namespace {

Program read_in(const Language& language, std::string reason, SourceText source, Diagnostics& diagnostics) {
  if (source.text().size() >= std::numeric_limits<std::uint32_t>::max())
    fail_on_file(source.name(), "the program is larger than 4 GB; at most 4 GB are read", "program-too-large");
  Program program = language.read(std::move(source), diagnostics);
  program.language = language.id;
  program.language_reason = std::move(reason);
  return program;
}

}  // namespace

Program read_program(SourceText source, std::optional<LanguageId> language, Diagnostics& diagnostics) {
  if (language) return read_in(language_of(*language), "--dialect", std::move(source), diagnostics);
  RecognizedLanguage found = recognize_language(source);
  return read_in(*found.language, std::move(found.reason), std::move(source), diagnostics);
}

Program read_program(SourceText source, Diagnostics& diagnostics) {
  return read_program(std::move(source), std::nullopt, diagnostics);
}

std::optional<LanguageId> language_asked_for(const InterpreterOptions& options) {
  return options.dialect ? std::optional(options.dialect->language) : std::nullopt;
}

/// A dialect of another language says nothing about the program: the machine's control may be given for others.
Interpretation interpret(const Program& program, const InterpreterOptions& options, Diagnostics& diagnostics) {
  const Language& language = language_of(program);
  InterpreterOptions own = options;
  if (own.dialect && own.dialect->language != language.id) own.dialect.reset();
  return language.interpret(program, own, diagnostics);
}

}  // namespace camber::nc
