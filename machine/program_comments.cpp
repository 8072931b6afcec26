#include "machine/program_comments.h"

#include <algorithm>
#include <cctype>
#include <optional>

namespace camber::machine {
namespace {

constexpr std::size_t kLongest = 400;  // of a line; std::regex needs stack for each character

struct Split {
  std::string code, comment;
  bool has_comment = false;
};

/// Brackets within a comment belong to it as far as they are closed: "(End Mill (0.25 inch))".
std::size_t end_of_comment(std::string_view text, std::size_t from, char open, char close) {
  int depth = 0;
  for (std::size_t at = from; at < text.size(); ++at) {
    if (text[at] == open) ++depth;
    if (text[at] == close && --depth == 0) return at;
  }
  return std::min(text.find(close, from), text.size());
}

/// A structure line of Klartext, "32 * - TOOL: T5", is a comment: offset of its star.
std::optional<std::size_t> star_of(std::string_view text) {
  std::size_t at = text.find_first_not_of(" \t");
  if (at != std::string_view::npos && text[at] != '*') at = text.find_first_not_of("0123456789 \t", at);
  return at != std::string_view::npos && text[at] == '*' ? std::optional(at) : std::nullopt;
}

/// MSG("FACE MILL D100") of Sinumerik: the quotes are the language's, no sign for inches.
std::string_view without_quotes(std::string_view text) {
  const std::size_t from = text.find_first_not_of(' '), to = text.find_last_not_of(' ');
  if (from == std::string_view::npos || to == from || text[from] != '"' || text[to] != '"') return text;
  return text.substr(from + 1, to - from - 1);
}

Split split(std::string_view text) {
  text = text.substr(0, kLongest);
  Split out;
  if (const auto star = star_of(text)) return {{}, std::string(text.substr(*star + 1)), true};
  const std::size_t first = std::min(text.find_first_not_of(" \t"), text.size());
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    const bool bracket = c == '[' && at == first;
    if (c != '(' && c != ';' && !bracket) {
      out.code += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      ++at;
      continue;
    }
    const std::size_t end = c == ';' ? text.size() : end_of_comment(text, at, c, bracket ? ']' : ')');
    if (!out.has_comment) out.comment = std::string(without_quotes(text.substr(at + 1, end - at - 1)));
    out.has_comment = true;
    at = std::min(end, text.size() - 1) + 1;
  }
  return out;
}

}  // namespace

std::string code_of_line(const SourceText& program, std::size_t line) { return split(program.line(line)).code; }

std::vector<CommentedLine> commented_lines(const SourceText& program) {
  std::vector<CommentedLine> out;
  for (std::size_t line = 1; line <= program.line_count(); ++line) {
    if (program.line(line).find_first_of("(;[*") == std::string_view::npos) continue;
    Split parts = split(program.line(line));
    if (parts.has_comment) out.push_back({line, std::move(parts.code), std::move(parts.comment)});
  }
  return out;
}

}  // namespace camber::machine
