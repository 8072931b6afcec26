#pragma once
// Syntax tree of a Klartext program: statements, one for each block of the control (a line and those that continue
// it).
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostics.h"
#include "nc/program_text.h"

namespace camber::nc::heidenhain {

enum class Kind : std::uint8_t {
  nothing,  ///< comments, structure lines, empty lines
  begin_program,
  end_program,
  line,               ///< L, and a coordinate alone
  normal_line,        ///< LN
  polar_line,         ///< LP
  circle,             ///< C
  radius_arc,         ///< CR
  tangent_arc,        ///< CT
  polar_circle,       ///< CP
  polar_tangent_arc,  ///< CTP
  centre,             ///< CC
  rounding,           ///< RND
  chamfer,            ///< CHF
  approach,           ///< APPR
  departure,          ///< DEP
  functions,          ///< M functions, F, S alone
  tool_call,
  tool_def,
  blank_form,
  label,
  call_label,
  call_program,
  select_program,  ///< SEL PGM, CALL SELECTED PGM
  assignment,      ///< Q5 = ..., QS1 = ...
  function,        ///< FN n:
  cycle_def,
  cycle_call,
  plane,
  tcpm,       ///< FUNCTION TCPM, FUNCTION RESET TCPM
  transform,  ///< TRANS DATUM, MIRROR, ROTATION, SCALE
  pattern,    ///< PATTERN DEF
  stop,
  dwell,   ///< FUNCTION DWELL
  passed,  ///< read without effect on the moves
  noted,   ///< likewise, and said
  refused  ///< [not-supported] or unknown: said when it is run
};

/// True for kinds whose statement is a list of words (Program::words).
constexpr bool has_words(Kind kind) { return kind >= Kind::line && kind <= Kind::functions; }

/// Letters of Program::words that are no address of the text.
namespace letter {
inline constexpr char kCompensation = 'r';  ///< R0 RL RR R+ R-: value 0, 1, 2, 3, 4
inline constexpr char kSense = 'd';         ///< DR+ DR-: 1, -1
inline constexpr char kRapid = 'm';         ///< FMAX
inline constexpr char kAutoFeed = 'a';      ///< FAUTO
inline constexpr char kFeedPerTurn = 'u';   ///< FU
inline constexpr char kFeedPerTooth = 'z';  ///< FZ
inline constexpr char kPolarRadius = 'p';   ///< PR
inline constexpr char kPolarAngle = 'g';    ///< PA
inline constexpr char kLength = 'l';        ///< LEN
inline constexpr char kArcAngle = 'c';      ///< CCA
inline constexpr char kArgument = 'f';      ///< argument of the M function before it: F of M128, MB of M140, LA of M120
inline constexpr char kNormal[3] = {'n', 'o', 'q'};  ///< NX NY NZ
inline constexpr char kTool[3] = {'t', 'v', 'w'};    ///< TX TY TZ
}  // namespace letter

struct Statement {
  Kind kind = Kind::nothing;
  std::uint8_t skip = 0;    ///< begins with /
  bool numbered = false;    ///< has a block number
  std::uint32_t block = 0;  ///< its first line, an index into Program::blocks
  std::uint32_t lines = 1;
  std::uint32_t begin = 0;  ///< offset behind the number
  std::uint32_t at = 0;     ///< behind the keyword
  std::uint32_t end = 0;    ///< end of the last line
  std::uint32_t first_word = 0, word_count = 0;
};

struct Tree : LanguageTree {
  std::vector<Statement> statements;
  std::map<std::string, std::uint32_t, std::less<>> labels;  ///< statements of labels, by number or name
  bool inch = false;
  std::uint32_t begin_statement = 0;  ///< BEGIN PGM; 0 where there is none

  std::span<const Word> words_of(const Program& program, const Statement& statement) const {
    return {program.words.data() + statement.first_word, statement.word_count};
  }
};

inline const Tree& tree_of(const Program& program) { return static_cast<const Tree&>(*program.tree); }

/// IX, IPA: the word counts from where the tool stands.
inline bool is_incremental(const Program& program, const Word& word) {
  const char c = program.source.text()[word.offset];
  return c == 'I' || c == 'i';
}

/// Finds the statements of the text and reads the words of those that have some. What is wrong with words is said at
/// them; unknown statements are Kind::refused.
Program read_text(SourceText source, Diagnostics& diagnostics);

/// Returns what to say of a statement that is refused, and the name of the check.
struct Refusal {
  std::string message;
  std::string check;
  std::string alike{};  ///< what counts as the same
};
Refusal refusal_of(std::string_view statement);

}  // namespace camber::nc::heidenhain
