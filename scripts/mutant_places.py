"""Where scripts/mutants may put a fault into a C++ source, and the source with faults that are chosen at run time.

The places are found among the tokens of the text, formatted by clang-format: a binary operator has blanks on both sides, a
bracket of a template has not. Each becomes a call of tests/support/mutant.h with the number of the mutant.
"""
import dataclasses
import re

KINDS = ("sign", "constant", "off by one", "term", "axis", "condition")
TOKEN = re.compile(r"""(?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*|\s+)
    |(?P<string>(?:u8|[uUL])?R"(?P<mark>[^()\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
    |(?P<number>\.?\d(?:[eE][+-]|[\w.']|'\d)*)|(?P<name>[A-Za-z_]\w*)
    |(?P<mark_>::|->|\.\.\.|<=>|<<=|>>=|[-+*/%&|^=!<>]=|&&|\|\||<<|>>|\+\+|--|.)""", re.S | re.M | re.X)
PRECEDENCE = {"*": 10, "/": 10, "%": 10, "+": 9, "-": 9, "<<": 8, ">>": 8, "<": 7, "<=": 7, ">": 7, ">=": 7, "==": 6,
              "!=": 6, "&": 5, "^": 4, "|": 3, "&&": 2, "||": 1, "?": 0, ":": 0,
              **{sign: -1 for sign in ("=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=")}}
COMPARISONS = {"<": ("less", "<="), "<=": ("less_equal", "<"), ">": ("greater", ">="), ">=": ("greater_equal", ">")}
BRACKETS = {")": "(", "]": "[", "}": "{"}
AXES = {"x": "y", "y": "x", "z": "x"}
LEFT_OUT = {"assert", "static_assert", "case", "using", "template", "operator", "enum"}  # statements that have one of these


@dataclasses.dataclass(frozen=True)
class Place:
    """A fault: in which line, what is there and what is there instead; edits are (from, to, text), N is the number."""
    path: str
    line: int
    column: int
    kind: str
    old: str
    new: str
    statement: tuple  # from, to
    edits: tuple

    def __str__(self):
        return f"{self.path}:{self.line}:{self.column} {self.kind}: {self.old} -> {self.new}"


class Source:
    """The tokens of a text, and for each bracket the one that belongs to it."""

    def __init__(self, path, text):
        self.path, self.text = path, text
        found = [m for m in TOKEN.finditer(text) if m.lastgroup != "skip"]
        self.tokens, self.types = [m[0] for m in found], [m.lastgroup for m in found]
        self.begins, self.ends = [m.start() for m in found], [m.end() for m in found]
        self.match, self.outer, stack = {}, [], []
        for k, token in enumerate(self.tokens):
            if token in BRACKETS and stack:
                self.match[k] = stack[-1]
                self.match[stack.pop()] = k
            self.outer.append(stack[-1] if stack else None)
            if token in BRACKETS.values():
                stack.append(k)

    def token(self, k):
        return self.tokens[k] if 0 <= k < len(self.tokens) else ""

    def is_binary(self, k):
        blank = lambda at: self.text[at:at + 1].isspace()
        return self.tokens[k] in PRECEDENCE and blank(self.begins[k] - 1) and blank(self.ends[k])

    def operand_after(self, k, level):
        """The last token of the operand that begins behind token k, up to an operator that binds no closer than level."""
        k += 1
        while k < len(self.tokens):
            token = self.tokens[k]
            if token in BRACKETS or token in ";," or self.is_binary(k) and PRECEDENCE[token] <= level:
                break
            k = (self.end_of_template(k) if self.is_template(k) else self.match.get(k, k)) + 1
        return k - 1

    def is_template(self, k):
        return self.tokens[k] == "<" and self.ends[k - 1] == self.begins[k]

    def end_of_template(self, k):
        depth = 0
        while True:
            depth += {"<": 1, ">": -1, ">>": -2}.get(self.tokens[k], 0)
            if depth <= 0 or k + 1 == len(self.tokens):
                return k
            k += 1

    def operand_before(self, k, level):
        """The first token of the operand that ends before token k."""
        k -= 1
        while k >= 0:
            token = self.tokens[k]
            if token in BRACKETS.values() or token in (";", ",", "}", "return", "else", "case", "throw"):
                break
            if self.is_binary(k) and PRECEDENCE[token] < level:
                break
            k = self.match.get(k, k) - 1
        return k + 1

    def statement(self, k):
        """The tokens around k without a brace or a semicolon."""
        first = last = k
        while first > 0 and self.tokens[first - 1] not in ";{}":
            first -= 1
        while last + 1 < len(self.tokens) and self.tokens[last] not in ";{}":
            last += 1
        return first, last

    def head(self, k):
        """The first token of the statement or definition at whose depth token k stands."""
        while k > 0:
            before = k - 1
            if self.tokens[before] in "({[;":
                return k
            if self.tokens[before] == "}" and self.token(k) not in (",", ".", ";", ")", "(") and not self.is_binary(k):
                return k
            k = self.match.get(before, before)
        return k

    def scopes(self, k):
        """The heads of what encloses token k, from the inside to the outside: (first token, the bracket or k)."""
        while k is not None:
            yield self.head(k), k
            k = self.outer[k]

    def scope_of(self, k):
        """What the innermost braces with declarations around token k belong to: namespace, class or block."""
        while k is not None and self.tokens[k] != "{":
            k = self.outer[k]
        if k is None:
            return "namespace"
        head = self.tokens[self.head(k):k]
        if "namespace" in head:
            return "namespace"
        return "class" if {"struct", "class", "union"} & set(head) and "(" not in head else "block"

    def without_constexpr(self, k):
        """The edits after which what encloses token k is no longer computed by the compiler."""
        edits = []
        for first, last in self.scopes(k):
            for at in range(first, last):
                if self.tokens[at] != "constexpr" or self.token(at - 1) == "if" or self.outer[at] != self.outer[last]:
                    continue
                is_function = self.tokens[last] == "{" and self.tokens[last - 1] in (")", "const", "noexcept")
                word = "inline" if is_function else self.constant(at)
                edits.append((self.begins[at], self.ends[at], word))
        return tuple(edits)

    def constant(self, at):
        is_static = "static" in (self.token(at - 1), self.token(at + 1))
        outer = self.outer[at]
        scope = "namespace" if outer is None else self.scope_of(outer)
        return {"namespace": "const", "class": "inline const", "block": "const" if is_static else "static const"}[scope]


def places_of(path, text):
    source = Source(path, text)
    found = []
    for k, token in enumerate(source.tokens):
        for kind, at, old, new, edits in faults(source, k, token):
            first, last = source.statement(k)
            words = source.tokens[first:last + 1]
            if LEFT_OUT & set(words) or "string" in source.types[first:last + 1]:
                continue
            if kind == "constant" and source.scope_of(k) == "class" and "constexpr" not in words:
                continue  # the default of a setting
            begin = source.begins[at]
            found.append(Place(path, text.count("\n", 0, begin) + 1, begin - text.rfind("\n", 0, begin), kind, old, new,
                               (source.begins[first], source.ends[last]), edits + source.without_constexpr(k)))
    return found


def faults(source, k, token):
    """(kind, token, old, new, edits) of the faults that token k may take."""
    put = lambda at, text: (at, at, text)
    wrap = lambda first, last, call: (put(source.begins[first], f"camber_mutant::{call}"), put(source.ends[last], ")"))
    shown = lambda first, last: " ".join(source.text[source.begins[first]:source.ends[last]].split())
    kind, before, behind = source.types[k], source.token(k - 1), source.token(k + 1)
    binary = kind == "mark_" and source.is_binary(k)
    if binary and token in ("+", "-", "+=", "-="):
        last = source.operand_after(k, PRECEDENCE[token])
        operand, at = shown(k + 1, last), source.begins[k + 1]
        end = ()
        if "=" in token:
            end, operand = (put(source.ends[last], ")"),), f"({operand})"
        turned = token.translate(str.maketrans("+-", "-+"))
        open_ = "(" if end else ""
        yield "sign", k, token, turned, (put(at, "camber_mutant::sign(N) * " + open_),) + end
        yield "term", k, f"{token} {operand}", "nothing", (put(at, "camber_mutant::term(N) * " + open_),) + end
    if binary and token in "*/":
        last = source.operand_after(k, PRECEDENCE[token])
        yield "term", k, f"{token} {shown(k + 1, last)}", "nothing", wrap(k + 1, last, "factor(N, ")
    if binary and token in COMPARISONS:
        name, other = COMPARISONS[token]
        first, last = source.operand_before(k, 7), source.operand_after(k, 7)
        edits = wrap(first, last, f"{name}(N, ") + ((source.ends[k - 1], source.begins[k + 1], ", "),)
        yield "off by one", k, token, other, edits
    if kind == "number" and re.fullmatch(r"\d+\.\d+f?", token) and float(token.rstrip("f")) != 0:
        yield "constant", k, token, f"1.02 * {token}", wrap(k, k, "scaled(N, ")
    if kind == "number" and re.fullmatch(r"\d+[uUlLzZ]*", token):
        if beside(source, k - 1, ("+", "-", *COMPARISONS)) or beside(source, k + 1, ("+", "-")):
            yield "off by one", k, token, f"({token} + 1)", wrap(k, k, "off_by_one(N, ")
        if before == "[" and behind == "]" and token in "012":
            other = "1" if token == "0" else "0"
            yield "axis", k, f"[{token}]", f"[{other}]", wrap(k, k, "axis(N, ")
    if token in AXES and before == "." and behind == "(" and source.token(k + 2) == ")":
        edits = ((source.begins[k - 1], source.ends[k + 2], f"(camber_mutant::axis(N, {'xyz'.index(token)}))"),)
        yield "axis", k, f".{token}()", f".{AXES[token]}()", edits
    if token == "if" and behind == "(" or binary and token == "?":
        first, last = (k + 2, source.match.get(k + 1, k + 1) - 1) if token == "if" else (source.operand_before(k, 1), k - 1)
        condition = source.tokens[first:last + 1]
        if set(condition) & set(COMPARISONS) and not {"=", ";"} & set(condition):
            text = shown(first, last)
            yield "condition", first, text, f"!({text})", wrap(first, last, "inverted(N, ")


def beside(source, k, signs):
    return 0 <= k < len(source.tokens) and source.tokens[k] in signs and source.is_binary(k)


def with_faults(text, numbered):
    """The text of a file with its mutants, as (number, place)."""
    edits = [(first, last, new.replace("N", str(number))) for number, place in numbered for first, last, new in place.edits]
    for first, last, new in sorted(edits, reverse=True):
        text = text[:first] + new + text[last:]
    return f'#include "tests/support/mutant.h"\n{text}'
