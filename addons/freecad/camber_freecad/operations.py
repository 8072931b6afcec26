"""Which operation a line of the posted program belongs to, and messages of Camber in its words."""
import re

from . import compat


class Span:
    """Lines first ... last (from 1) of one object: an operation, a tool change or a fixture."""

    def __init__(self, obj, first):
        self.obj, self.first, self.last = obj, first, None

    @property
    def label(self):
        return self.obj.Label


def _names(obj):
    return {name.lower() for name in (obj.Label, getattr(obj, "Name", None)) if name}


def spans_of(text, objects):
    """The spans of the posted objects, found by the comments that name them, in order."""
    comments = []  # (line, text of the comment)
    for number, line in enumerate(text.splitlines(), 1):
        for comment in re.findall(r"\(([^()]*(?:\([^()]*\)[^()]*)*)\)|;(.*)$", line):
            comments.append((number, "".join(comment).strip().lower()))
    out = []
    at = 0
    for obj in objects:
        names = _names(obj)
        for k in range(at, len(comments)):
            number, comment = comments[k]
            # "begin operation: Pocket", "Pocket"
            if any(comment == name or comment.endswith((": " + name, ":" + name)) for name in names):
                if "finish" in comment or "end operation" in comment:
                    continue
                out.append(Span(obj, number))
                at = k + 1
                break
    lines = text.count("\n") + 1
    for span, follower in zip(out, out[1:] + [None]):
        span.last = follower.first - 1 if follower else lines
    return out


def operation_at(spans, line):
    """The operation of a line; None in what the post-processor writes around operations."""
    for span in spans:
        if span.first <= line <= span.last:
            return span.obj if is_operation(span.obj) else None
    return None


def is_operation(obj):
    return hasattr(obj, "Path") and hasattr(obj, "Proxy") and not hasattr(obj, "ToolNumber")


class Message:
    """One message of Camber: the operation that it is about, where there is one."""

    def __init__(self, severity, text, operation=None, line=0, check=""):
        self.severity, self.text, self.operation, self.line, self.check = severity, text, operation, line, check

    def __str__(self):
        where = "Operation '%s': " % self.operation.Label if self.operation else ""
        at = " (line %d of the program)" % self.line if self.line else ""
        return "%s%s%s" % (where, self.text, at)


_DIAGNOSTIC = re.compile(r"^(?P<file>.*?)(?::(?P<line>\d+))?(?::(?P<column>\d+))?: (?P<severity>error|warning): "
                         r"(?P<text>.*?)(?: \[(?P<check>[a-z0-9-]+)\])?$")
# What the keys of the job are called in FreeCAD.
_WORDS = [(r"\boverhang_mm\b", "Overhang (property CamberOverhang of the tool controller)"),
          (r"\bflute_length_mm\b", "CuttingEdgeHeight of the tool bit"),
          (r"\bdiameter_mm\b", "Diameter of the tool bit"),
          (r"\bholder_mm\b", "CamberHolder of the tool controller"),
          (r"\bbox_mm\b", "the job's stock"),
          (r"\[tool\.(\d+)\]", r"T\1"),
          (r"\bvoxel_mm\b", "CamberVoxel of the job")]


def _in_freecad(text):
    for pattern, words in _WORDS:
        text = re.sub(pattern, words, text)
    return text


def messages_of(output, spans, program="program.nc"):
    """The diagnostics in what Camber printed, each with its operation; those about files that the add-on made are put in
    FreeCAD's words."""
    out = []
    for line in output.splitlines():
        m = _DIAGNOSTIC.match(line)
        if not m:
            continue
        number = int(m["line"] or 0)
        if m["file"].endswith(program):
            out.append(Message(m["severity"], m["text"], operation_at(spans, number), number, m["check"] or ""))
        else:
            out.append(Message(m["severity"], _in_freecad(m["text"]), None, 0, m["check"] or ""))
    return out
