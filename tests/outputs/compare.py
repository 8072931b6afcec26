"""What scripts/compare-outputs holds against each other, by the class of a file.

Hard classes must be the same: bytes, or for JSON and TOML the values of the keys that the old file has, but for
compute_s. Soft classes (pages, pictures, what is printed, words in the comments of a program's head) are only reported.
"""
import hashlib
import json
import os
import re
import tomllib

HARD = ("status", "CSV", "VTP", "PLY", "VDB", "NC", "JSON", "TOML", "other")
SOFT = ("NC head", "HTML", "SVG", "printed")
BY_SUFFIX = {".csv": "CSV", ".vtp": "VTP", ".ply": "PLY", ".vdb": "VDB", ".html": "HTML", ".svg": "SVG", ".txt": "printed"}
IGNORED_KEYS = {"compute_s"}


def parts(path):
    """Class and content of what a file holds: bytes, or the object of JSON and TOML."""
    with open(path, "rb") as file:
        content = file.read()
    name, suffix = os.path.split(path)[1], os.path.splitext(path)[1]
    if name == "status":
        return {"status": content}
    if suffix in (".nc", ".ngc"):
        return program_parts(content)
    if suffix in (".json", ".toml"):
        read = read_json if suffix == ".json" else read_toml
        try:
            return {suffix[1:].upper(): read(content.decode("utf8"))}
        except ValueError:  # a run that failed
            return {suffix[1:].upper(): content}
    kind = BY_SUFFIX.get(suffix, "other")
    if kind in ("HTML", "printed"):
        content = re.sub(rb"computed in [\d.]+ s", b"computed", content)
    return {kind: content}


def read_json(text):
    """Numbers as they are written: 1.0 is not 1."""
    return json.loads(text, parse_float=Written, parse_int=Written, parse_constant=Written)


def read_toml(text):
    return tomllib.loads(text, parse_float=Written)


class Written(str):
    """The digits of a number."""

    def __repr__(self):
        return str(self)

    def __eq__(self, other):
        return isinstance(other, Written) and str.__eq__(self, other)

    def __ne__(self, other):
        return not self == other

    __hash__ = str.__hash__


COMMENT = re.compile(rb"\([^)\n]*\)|;[^\n]*")
HEAD_LINE = re.compile(rb"\s*(%|[O:]\s*\d+\s*|N\d+\s*)?\s*$")
HASH_OR_VERSION = re.compile(rb"\b[0-9A-F]{16}\b|CAMBER \d[\d.]*")


def program_parts(content):
    """The program, with the figures alone of the comments in its head; and those comments."""
    lines = content.splitlines(keepends=True)
    end = 0
    while end < len(lines) and HEAD_LINE.match(COMMENT.sub(b"", lines[end]).rstrip()):
        end += 1
    comments = COMMENT.findall(b"".join(lines[:end]))
    figures = [f for c in comments for f in re.findall(rb"-?\d+(?:\.\d+)?", HASH_OR_VERSION.sub(b"", c))]
    head = COMMENT.sub(b"()", b"".join(lines[:end]))
    return {"NC": head + b" ".join(figures) + b"\n" + b"".join(lines[end:]), "NC head": b"\n".join(comments)}


# Two runs

def differences(name, old, new):
    """Sentences on how two contents of one class differ; none: they do not."""
    if isinstance(old, bytes) or isinstance(new, bytes):
        return [] if old == new else [first_difference(name, old, new)]
    return [f"{at}: {was!r} -> {now!r}" if at else f"{was!r} -> {now!r}" for at, was, now in changed(old, new)]


def changed(old, new, at=""):
    """(path, old, new) of the values that differ. Keys that only the new object has are none."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key, value in old.items():
            if key not in IGNORED_KEYS:
                below = f"{at}.{key}" if at else key
                yield from changed(value, new[key], below) if key in new else [(below, shown(value), "missing")]
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            yield at + "[]", f"{len(old)} entries", f"{len(new)} entries"
        for n, (was, now) in enumerate(zip(old, new)):
            yield from changed(was, now, f"{at}[{n}]")
    elif type(old) is not type(new) or old != new:
        yield at, shown(old), shown(new)


def shown(value):
    return value if not isinstance(value, (dict, list)) else "..."


def first_difference(name, old, new):
    if not isinstance(old, bytes) or not isinstance(new, bytes):
        return "only one of the two can be read"
    if b"\0" in old[:4096] or name.endswith((".ply", ".vdb", ".vtp")):
        at = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
        return f"{len(old)} -> {len(new)} bytes, the first difference at byte {at}"
    was, now = old.splitlines(), new.splitlines()
    lines = [n for n, (a, b) in enumerate(zip(was, now)) if a != b]
    n = lines[0] if lines else min(len(was), len(now))
    line = [text[n].decode("utf8", "replace")[:160] if n < len(text) else "(end)" for text in (was, now)]
    count = f"{len(lines)} of {len(was)} lines" if len(was) == len(now) else f"{len(was)} -> {len(now)} lines"
    if name.endswith(".csv") and lines:
        column = next((c for c, (a, b) in enumerate(zip(line[0].split(","), line[1].split(","))) if a != b), 0)
        line = [text.split(",")[column] for text in line]
        count += ", column " + was[0].decode().split(",")[column]
    return f"{count}; line {n + 1}: {line[0]} -> {line[1]}"


# A run and a table of hashes

def key_paths(value, at=""):
    """Of an object: a.b[].c"""
    if isinstance(value, dict):
        for key, below in value.items():
            path = f"{at}.{key}" if at else key
            yield path
            yield from key_paths(below, path)
    elif isinstance(value, list):
        for below in value:
            yield from key_paths(below, at + "[]")


def pruned(value, keys, at=""):
    """Only the keys that were known when the table was written."""
    if isinstance(value, dict):
        below = {k: f"{at}.{k}" if at else k for k in value if k not in IGNORED_KEYS}
        return {k: pruned(value[k], keys, path) for k, path in below.items() if path in keys}
    if isinstance(value, list):
        return [pruned(v, keys, at + "[]") for v in value]
    return value


def canonical(value):
    """Text of an object, its keys sorted."""
    if isinstance(value, dict):
        return "{" + ",".join(f"{k!r}:{canonical(value[k])}" for k in sorted(value)) + "}"
    if isinstance(value, list):
        return "[" + ",".join(canonical(v) for v in value) + "]"
    return repr(value)


def sha256(content, keys):
    if not isinstance(content, bytes):
        content = canonical(pruned(content, keys)).encode("utf8")
    return hashlib.sha256(content).hexdigest()


def group(name):
    """Files whose objects have their keys in common: those that one command writes."""
    return name.split("/")[0] + os.path.splitext(name)[1]


class Table:
    """hash lines: class, SHA-256, file; key lines: group, path of a key."""

    def __init__(self):
        self.hashes, self.keys, self.remarks = {}, {}, []

    @staticmethod
    def of(files):
        """files: name and parts."""
        table = Table()
        for name, content in files.items():
            for part in content.values():
                if not isinstance(part, bytes):
                    table.keys.setdefault(group(name), set()).update(key_paths(part))
        table.hashes = table.hashes_of(files)
        return table

    def hashes_of(self, files):
        return {(kind, name): sha256(part, self.keys.get(group(name), set()))
                for name, content in files.items() for kind, part in content.items() if kind in HARD}

    @staticmethod
    def read(path):
        table = Table()
        with open(path, encoding="utf8") as file:
            for line in file.read().splitlines():
                word = line.split(" ", 3)
                if word[0] == "hash":
                    table.hashes[(word[1], word[3])] = word[2]
                elif word[0] == "key":
                    table.keys.setdefault(word[1], set()).add(line.split(" ", 2)[2])
        return table

    def write(self, path, remarks):
        lines = ["# " + r for r in remarks]
        lines += [f"hash {kind} {sha} {name}" for (kind, name), sha in sorted(self.hashes.items(), key=lambda h: h[0][::-1])]
        lines += [f"key {g} {k}" for g in sorted(self.keys) for k in sorted(self.keys[g])]
        with open(path, "w", encoding="utf8", newline="\n") as out:
            out.write("\n".join(lines) + "\n")
