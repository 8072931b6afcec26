"""cmake/unity_groups.py LINES FORMER FILE...: which files a build may compile together.

Prints a line for each group: its files, separated by semicolons ("-": a group that has lost its files, which keeps its
number). No group has more than LINES lines (a longer file is
alone), and no name that a file defines for itself stands twice in a group: such names are looked for at the start of
a line, where the code's style puts them.

FORMER holds what was printed for this build folder before, or does not exist: files stay in their group, so that a new
file or name does not compile others again. What is printed is written there.
"""
import os
import re
import sys

DEFINED = re.compile(r"^(?:template\s*<[^>]*>\s*)?[A-Za-z_][\w:<>,&*\s\[\]]*?[\s&*>](?P<name>[A-Za-z_]\w*)\s*[(={;\[]")
NOT_DEFINITIONS = re.compile(r"^(?:TEST|INSTANTIATE|RC_GTEST|namespace\b|extern\b|return\b|using (?!\w+ =))")
# Headers that take the compiler seconds: what includes them is compiled together.
HEAVY = ("CLI/", "ceres/", "openvdb/", "nlohmann/", "toml++/", "tbb/")
GROWTH = 1.3  # a group that was full before may grow by so much


def local_names(text):
    found = set()
    for line in re.sub(r"^\[\[\w+\]\] ", "", text, flags=re.M).splitlines():
        if not line[:1].isalpha() or NOT_DEFINITIONS.match(line):
            continue
        if m := DEFINED.match(line):
            found.add(m["name"])
        found.update(re.findall(r"\b(k[A-Z]\w*)\s*[={\[]", line))
        found.update(re.findall(r"^(?:struct|class|enum class|enum|using) (\w+)", line))
    found.update(re.findall(r"^#define (\w+)", text, re.M))
    return found


def used_names(text):
    """Those that `using` brings from elsewhere: two files may use the same, but none may define it."""
    return set(re.findall(r"^using [\w:]*::(\w+);", text, re.M))


def hidden_names(text):
    """Those of unnamed namespaces: they would hide what another file calls by the same name."""
    return local_names("\n".join(re.findall(r"^namespace \{\n(.*?)^\}  // namespace$", text, re.M | re.S)))


def called_names(text):
    return set(re.findall(r"(?<![\w.>:])([a-z_]\w*)\(", text))


class Group:
    def __init__(self):
        self.files, self.lines = [], 0
        self.names, self.used, self.hidden, self.called = set(), set(), set(), set()

    def takes(self, file, limit):
        if self.lines + file.lines > limit:
            return False
        return not (self.names & file.names or self.names & file.used or self.used & file.names
                    or self.hidden & file.called or self.called & file.hidden)

    def add(self, file):
        self.files.append(file.path)
        self.names |= file.names
        self.used |= file.used
        self.hidden |= file.hidden
        self.called |= file.called
        self.lines += file.lines


class File:
    def __init__(self, path):
        with open(path, encoding="utf8") as file:
            text = file.read()
        self.path, self.lines, self.names = path, text.count("\n"), local_names(text)
        self.used, self.hidden = used_names(text), hidden_names(text)
        self.called = called_names(text) - self.names
        self.light = tuple(f"#include <{header}" not in text for header in HEAVY)


def former_groups(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf8") as file:
        return [line.split(";") for line in file.read().splitlines()]


def main():
    limit, record, paths = int(sys.argv[1]), sys.argv[2], sys.argv[3:]
    files, groups = {path: File(path) for path in paths}, []
    for former in former_groups(record):
        groups.append(Group())
        for path in former:
            if path in files and (not groups[-1].files or groups[-1].takes(files[path], GROWTH * limit)):
                groups[-1].add(files.pop(path))
    for file in sorted(files.values(), key=lambda f: f.light):
        group = next((g for g in groups if g.takes(file, limit)), None)
        if group is None:
            group = Group()
            groups.append(group)
        group.add(file)
    text = "\n".join(";".join(group.files) or "-" for group in groups)
    os.makedirs(os.path.dirname(record), exist_ok=True)
    with open(record, "w", encoding="utf8") as out:
        out.write(text + "\n")
    print(text)


main()
