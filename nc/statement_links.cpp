// Which END belongs to which DO, which endif to which if.
#include <fmt/format.h>

#include "nc/statement.h"

namespace camber::nc {
namespace {

using Kind = StatementKind;

/// Statements that are open at a place of the file, the innermost last.
class Linker {
 public:
  explicit Linker(MacroTables& macro) : macro_(macro) {}

  std::vector<MacroError> run() {
    for (std::uint32_t i = 0; i < macro_.statements.size(); ++i) link(i);
    for (const std::uint32_t i : open_) fail(i, fmt::format("{} is not closed; {} was expected", name(i), closer(i)));
    return std::move(errors_);
  }

 private:
  Statement& at(std::uint32_t i) { return macro_.statements[i]; }

  void link(std::uint32_t i) {
    Statement& s = at(i);
    switch (s.kind) {
      case Kind::loop:
        if (closes_do(s)) {
          s.kind = Kind::loop_until;
          close(i, Kind::loop);
          return;
        }
        [[fallthrough]];
      case Kind::branch_if:
      case Kind::sub:
        open_.push_back(i);
        return;
      case Kind::loop_end:
        return close(i, Kind::loop);
      case Kind::sub_end:
        return close(i, Kind::sub);
      case Kind::branch_elseif:
      case Kind::branch_else:
      case Kind::branch_end:
        return next_branch(i);
      case Kind::leave_loop:
      case Kind::next_turn:
        s.partner = find(s, Kind::loop);
        if (s.partner == Statement::kNone) fail(i, fmt::format("{} is in no loop of this number", name(i)));
        return;
      default:
        return;
    }
  }

  /// o while behind an o do of the same number.
  bool closes_do(const Statement& s) {
    if (!s.o_word || s.repeats || s.value_count == 0) return false;
    const std::uint32_t open = find(s, Kind::loop);
    return open != Statement::kNone && at(open).value_count == 0;
  }

  std::uint32_t find(const Statement& s, Kind kind) const {
    for (std::size_t k = open_.size(); k-- > 0;) {
      const Statement& o = macro_.statements[open_[k]];
      if (o.kind == kind && o.label == s.label && o.o_word == s.o_word) return open_[k];
    }
    return Statement::kNone;
  }

  /// Leaves what is still open inside: nothing closes it any more.
  void leave_inner(std::uint32_t opener) {
    while (!open_.empty() && open_.back() != opener) {
      const std::uint32_t inner = open_.back();
      fail(inner, fmt::format("{} is not closed before the end of the enclosing structure; {} was expected",
                              name(inner), closer(inner)));
      open_.pop_back();
    }
  }

  void close(std::uint32_t i, Kind kind) {
    const std::uint32_t opener = find(at(i), kind);
    if (opener == Statement::kNone) {
      fail(i, fmt::format("{} closes nothing; {} was expected before it", name(i), opener_of(i)));
      return;
    }
    leave_inner(opener);
    open_.pop_back();
    at(i).partner = opener;
    at(opener).partner = i;
  }

  void next_branch(std::uint32_t i) {
    const std::uint32_t opener = find(at(i), Kind::branch_if);
    if (opener == Statement::kNone) {
      fail(i, fmt::format("{} without an IF of its own before it", name(i)));
      return;
    }
    leave_inner(opener);
    std::uint32_t last = opener;
    while (at(last).next_branch != Statement::kNone) last = at(last).next_branch;
    if (at(last).kind == Kind::branch_else && at(i).kind != Kind::branch_end) {
      fail(i, fmt::format("{} behind ELSE; ENDIF was expected", name(i)));
      return;
    }
    at(last).next_branch = i;
    if (at(i).kind != Kind::branch_end) return;
    open_.pop_back();
    for (std::uint32_t b = opener; b != i; b = at(b).next_branch) at(b).partner = i;
  }

  void fail(std::uint32_t i, const std::string& message) { errors_.emplace_back(at(i).offset, "statement", message); }

  std::string number(const Statement& s) const {
    return s.label == Statement::kNoLabel ? std::string() : macro_.labels[s.label];
  }

  std::string with_number(const Statement& s, const char* word) const {
    return s.o_word ? fmt::format("O{} {}", number(s), word) : word;
  }

  std::string name(std::uint32_t i) const {
    const Statement& s = macro_.statements[i];
    switch (s.kind) {
      case Kind::loop:
        return s.o_word ? with_number(s, s.repeats ? "REPEAT" : s.value_count > 0 ? "WHILE" : "DO") : number(s);
      case Kind::loop_end:
        return s.o_word ? with_number(s, "ENDWHILE") : "END" + number(s).substr(2);
      case Kind::branch_if:
        return with_number(s, "IF");
      case Kind::branch_elseif:
        return with_number(s, "ELSEIF");
      case Kind::branch_else:
        return with_number(s, "ELSE");
      case Kind::branch_end:
        return with_number(s, "ENDIF");
      case Kind::sub:
        return with_number(s, "SUB");
      case Kind::sub_end:
        return with_number(s, "ENDSUB");
      case Kind::leave_loop:
        return with_number(s, "BREAK");
      case Kind::next_turn:
        return with_number(s, "CONTINUE");
      default:
        return with_number(s, "statement");
    }
  }

  std::string closer(std::uint32_t i) const {
    const Statement& s = macro_.statements[i];
    if (s.kind == Kind::branch_if) return with_number(s, "ENDIF");
    if (s.kind == Kind::sub) return with_number(s, "ENDSUB");
    if (!s.o_word) return "END" + number(s).substr(2);
    return with_number(s, s.repeats ? "ENDREPEAT" : s.value_count > 0 ? "ENDWHILE" : "WHILE");
  }

  std::string opener_of(std::uint32_t i) const {
    const Statement& s = macro_.statements[i];
    if (s.kind == Kind::sub_end) return with_number(s, "SUB");
    return s.o_word ? with_number(s, "WHILE or REPEAT") : number(s);
  }

  MacroTables& macro_;
  std::vector<std::uint32_t> open_;
  std::vector<MacroError> errors_;
};

}  // namespace

std::vector<MacroError> link_statements(MacroTables& macro) { return Linker(macro).run(); }

}  // namespace camber::nc
