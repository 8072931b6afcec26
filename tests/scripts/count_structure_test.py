#!/usr/bin/env python3
"""scripts/count-structure on a small tree: each count, what it names, and the limit."""
import os
import subprocess
import sys
import tempfile
import unittest

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/count-structure")
LONG = "\n" * 30
FIELDS = "".join(f"  double f{k}_mm = 0;\n" for k in range(21))
MANY = ", ".join(f"std::pair<int, int> p{k}" for k in range(9))
TREE = {
    "base/units.h": "struct Vector {\n  double x, y;\n};\n" + LONG,
    "base/stage.cpp": '#include "base/units.h"\nthread_local const int* sink = nullptr;\nconst char* const kName = "a;b{";\n'
                      "int next() {\n  static int count = 0;\n  static const int kStep = 1;\n  return count += kStep;\n}\n" + LONG,
    "machine/job.h": '#include "base/units.h"\nstruct Tool {\n' + FIELDS + "};\nstruct JobResult {\n" + FIELDS + "};\n" + LONG,
    "nc/move.h": '#include "base/units.h"\nstruct Tool { int number; };\n' + LONG,
    "nc/move.cpp": '#include "nc/move.h"\n' + LONG,
    "removal/engage/upright/reader.h": f"void read({MANY});\n" + LONG,
    "removal/engage/tilted/reader.h": "void read(int a, std::map<int, int> b = {{1, 2}, {3, 4}});\n" + LONG,
    "removal/field/kernel.cpp": f"void kernel({MANY}) {{}}\n" + LONG,
    "deflection/move.cpp": '#include "nc/move.h"\n#include "removal/engage/upright/reader.h"\n' + LONG,
    "api/job.cpp": '#include "camber/job.h"\n#include "machine/job.h"\n' + LONG,
    "include/camber/job.h": "struct Job {};\n" + LONG,
    "tests/nc/move_test.cpp": '#include "nc/move.h"\n\n',
    "docs/architecture.md": "## One path point, from text to text\n\n| step | file |\n|---|---|\n"
                            "| a | `nc/move` |\n| b | `nc/gone`, `base/units` |\n\n## Counts\n\n"
                            "| count | at most |\n|---|---|\n| arrows upward | 1 |\n| steps without file | 0 |\n\n## Next\n\n| a | `nc/other` |\n",
}
COUNTS = {
    "files": 11,
    "headers with one includer": 3,  # machine/job.h, nc/move.h, removal/engage/upright/reader.h
    "headers without includer": 1,  # removal/engage/tilted/reader.h
    "files under 30 lines": 0,
    "file names in several places": 2,  # move, job; upright and tilted are twins
    "headers with their source elsewhere": 1,  # machine/job.h
    "arrows upward": 0,
    "functions of more than 8 parameters": 1,  # upright; field/ may have them
    "structs of more than 20 fields": 1,  # Tool; JobResult is a result
    "globals and thread-locals": 2,  # sink, count
    "struct names in two rooms": 1,  # Tool
    "steps of a point": 3,
    "steps without file": 1,
    "limits stated otherwise": 1,
    "test files": 1,
    "test lines": 2,
}


def run(changes, *options):
    with tempfile.TemporaryDirectory() as folder:
        for path, text in {**TREE, **changes}.items():
            os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
            with open(os.path.join(folder, path), "w", encoding="utf8") as out:
                out.write(text)
        done = subprocess.run([sys.executable, SCRIPT, *options, folder], stdout=subprocess.PIPE, text=True)
        return done.returncode, done.stdout


class CountStructure(unittest.TestCase):
    def lists(self, name, *expected, changes=None):
        self.assertEqual(run(changes or {}, "--list", name)[1].splitlines(), list(expected))

    def test_counts(self):
        status, printed = run({})
        self.assertEqual(status, 0)
        of = dict((line[:38].strip(), int(line[38:].split()[0])) for line in printed.splitlines())
        for name, count in COUNTS.items():
            self.assertEqual(of[name], count, name)

    def test_names_what_it_counted(self):
        self.lists("globals and thread-locals", "base/stage.cpp:2: sink", "base/stage.cpp:5: count")
        self.lists("structs of more than 20 fields", "machine/job.h:2: Tool has 21")
        self.lists("functions of more than 8 parameters", "removal/engage/upright/reader.h:1: read has 9")
        self.lists("struct names in two rooms", "Tool: machine/job.h:2, nc/move.h:2")
        self.lists("headers with one includer", "machine/job.h: api/job.cpp", "nc/move.h: deflection/move.cpp",
                   "removal/engage/upright/reader.h: deflection/move.cpp")
        self.lists("steps without file", "nc/gone")

    def test_a_constructor_counts_as_a_function_and_its_initializers_do_not(self):
        text = "struct A {\n  A(int a, int b) : a_{a}, b_(b, 1, 2, 3, 4, 5, 6, 7, 8) { go(); }\n  int a_, b_;\n};\n"
        self.lists("functions of more than 8 parameters", changes={"removal/engage/upright/reader.h": text})

    def test_fails_above_a_limit(self):
        status, printed = run({"base/units.h": '#include "nc/move.h"\n'}, "--check")
        self.assertEqual(status, 1, printed)
        self.assertIn("error: arrows upward: 1, at most 0", printed)

    def test_passes_within_the_limits(self):
        sound = TREE["docs/architecture.md"].replace("`nc/gone`, ", "").replace("upward | 1", "upward | 0")
        changes = {"docs/architecture.md": sound, "machine/job.cpp": '#include "machine/job.h"\n' + LONG}
        self.assertEqual(run(changes, "--check")[0], 0)


if __name__ == "__main__":
    unittest.main()
