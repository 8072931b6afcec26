"""cmake/unity_groups.py LINES FILE...: which files a build may compile together.

Prints a line for each group: its files, separated by semicolons. No group has more than LINES lines (a longer file is
alone), and no name that a file defines for itself stands twice in a group: such names are looked for at the start of
a line, where the code's style puts them.
"""
import re
import sys

DEFINED = re.compile(r"^(?:template\s*<[^>]*>\s*)?[A-Za-z_][\w:<>,&*\s\[\]]*?[\s&*>](?P<name>[A-Za-z_]\w*)\s*[(={;\[]")
NOT_DEFINITIONS = re.compile(r"^(?:TEST|INSTANTIATE|RC_GTEST|namespace\b|extern\b|return\b|using (?!\w+ =))")


def local_names(text):
    found = set()
    for line in text.splitlines():
        if not line[:1].isalpha() or NOT_DEFINITIONS.match(line):
            continue
        if m := DEFINED.match(line):
            found.add(m["name"])
        found.update(re.findall(r"\b(k[A-Z]\w*)\s*[={\[]", line))
        found.update(re.findall(r"^(?:struct|class|enum class|enum|using) (\w+)", line))
    found.update(re.findall(r"^#define (\w+)", text, re.M))
    return found


def main():
    limit, groups = int(sys.argv[1]), []
    for path in sys.argv[2:]:
        with open(path, encoding="utf8") as file:
            text = file.read()
        lines, names = text.count("\n"), local_names(text)
        for group in groups:
            if group["lines"] + lines <= limit and not group["names"] & names:
                break
        else:
            group = {"files": [], "names": set(), "lines": 0}
            groups.append(group)
        group["files"].append(path)
        group["names"] |= names
        group["lines"] += lines
    for group in groups:
        print(";".join(group["files"]))


main()
