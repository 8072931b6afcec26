#pragma once
// The languages of NC programs. A language turns a text into a Program (blocks, editable words, a tree of its own), the
// Program into neutral moves (nc/move.h), and says how edited words are written (nc/emit/text_rules.h). Everything else
// goes through read_program, interpret and emit and does not know which language it was. A new language is a folder of
// its own, a row of the table in language.cpp, and a dialect in nc/dialects.h.
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/diagnostics.h"
#include "nc/interpreter.h"
#include "nc/language_id.h"
#include "nc/program_text.h"

namespace camber::nc {

class TextRules;
class ProgramWriter;
class FiveAxisText;
struct WriterFormat;

/// Evidence in a text that only this language has.
struct LanguageEvidence {
  std::size_t lines = 0;   ///< number of lines that show it, among the first ones of the text; 0: none
  std::size_t offset = 0;  ///< position of the first word that shows it
  std::string word{};      ///< that word, for messages: "BEGIN PGM", "CYCLE800"
};

struct Language {
  LanguageId id = LanguageId::iso;
  std::string_view name;   ///< name in JSON; for all but ISO also the name of its dialect
  std::string_view title;  ///< "Heidenhain Klartext"
  std::span<const std::string_view>
      extensions{};  ///< endings of files, lower case: they count where no word shows anything

  LanguageEvidence (*evidence)(std::string_view text) = nullptr;  ///< null: what is nothing else
  Program (*read)(SourceText source, Diagnostics& diagnostics) = nullptr;
  Interpretation (*interpret)(const Program& program, const InterpreterOptions& options,
                              Diagnostics& diagnostics) = nullptr;
  std::unique_ptr<TextRules> (*text_rules)(const Program& program) = nullptr;
  std::unique_ptr<ProgramWriter> (*writer)(const Dialect& dialect, WriterFormat format) = nullptr;
  std::unique_ptr<FiveAxisText> (*five_axis_text)(const Program& program, const Dialect& dialect) = nullptr;
  bool lines_have_numbers = false;  ///< in programs that are written anew
};

/// Returns all languages; the first is ISO.
std::span<const Language> languages();
const Language& language_of(LanguageId id);
inline const Language& language_of(const Program& program) { return language_of(program.language); }

/// The language of a text, and why it is taken to be that.
struct RecognizedLanguage {
  const Language* language = nullptr;
  std::string reason;  ///< "BEGIN PGM in line 1", "the name ends in .h"; of ISO: that no word shows another
};
RecognizedLanguage recognize_language(const SourceText& source);

/// Does what read_program(source, diagnostics) does, in a language that is known (--dialect); not given: the one that
/// the text shows.
Program read_program(SourceText source, std::optional<LanguageId> language, Diagnostics& diagnostics);

/// Returns the language of the dialect in the options.
std::optional<LanguageId> language_asked_for(const InterpreterOptions& options);

}  // namespace camber::nc
