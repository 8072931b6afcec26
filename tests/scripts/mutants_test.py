#!/usr/bin/env python3
"""scripts/mutants: the places that it finds in small sources, and what it makes of them."""
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
sys.path.insert(0, os.path.join(ROOT, "scripts"))
import mutant_places  # noqa: E402

SOURCE = """
constexpr double kHalf = 0.5;
struct Point {
  double weight = 1.5;
  double at[3]{};
};
double f(const Point& p, const std::vector<double>& v, int n) {
  double sum = static_cast<double>(n) - kHalf * v[0];
  sum += p.at[1] / 2.5;
  for (int i = 1; i < n; ++i) sum = sum - v.at(i - 1) * std::pow<double, int>(sum, 2);
  if (sum > 0.25 && n >= 2) return std::min(sum, 0.75 * n);
  static_assert(sizeof(Point) > 2 - 1);
  throw n > 3 ? std::runtime_error("n < 3 + 1") : std::runtime_error("");
}
"""
PROGRAM = "#include <algorithm>\n#include <cmath>\n#include <cstdio>\n#include <stdexcept>\n#include <vector>\n" + SOURCE + """
int main() { std::printf("%.6f", f({1, {3, 4, 5}}, {1e-1, 2e-1, 3e-1}, 3)); }
"""


def with_fault(text, place):
    """As somebody would write it."""
    lines = text.split("\n")
    line = lines[place.line - 1]
    head, tail = line[:place.column - 1], line[place.column - 1:]
    lines[place.line - 1] = head + tail.replace(place.old, "" if place.new == "nothing" else place.new, 1)
    return "\n".join(lines)


def compiled(folder, name, text, number=""):
    source, program = os.path.join(folder, name + ".cpp"), os.path.join(folder, name)
    with open(source, "w", encoding="utf8") as out:
        out.write(text)
    subprocess.run(["g++", "-std=c++20", "-w", "-I", ROOT, source, "-o", program], check=True)
    return program


class Mutants(unittest.TestCase):
    def test_are_of_arithmetic_and_not_of_settings_assertions_and_messages(self):
        found = [(p.kind, p.old, p.new) for p in mutant_places.places_of("f.cpp", SOURCE)]
        self.assertEqual(found, [
            ("constant", "0.5", "1.02 * 0.5"),
            ("sign", "-", "+"),
            ("term", "- kHalf * v[0]", "nothing"),
            ("term", "* v[0]", "nothing"),
            ("axis", "[0]", "[1]"),
            ("sign", "+=", "-="),
            ("term", "+= (p.at[1] / 2.5)", "nothing"),
            ("axis", "[1]", "[0]"),
            ("term", "/ 2.5", "nothing"),
            ("constant", "2.5", "1.02 * 2.5"),
            ("off by one", "<", "<="),
            ("sign", "-", "+"),
            ("term", "- v.at(i - 1) * std::pow<double, int>(sum, 2)", "nothing"),
            ("sign", "-", "+"),
            ("term", "- 1", "nothing"),
            ("off by one", "1", "(1 + 1)"),
            ("term", "* std::pow<double, int>(sum, 2)", "nothing"),
            ("condition", "sum > 0.25 && n >= 2", "!(sum > 0.25 && n >= 2)"),
            ("off by one", ">", ">="),
            ("constant", "0.25", "1.02 * 0.25"),
            ("off by one", ">=", ">"),
            ("off by one", "2", "(2 + 1)"),
            ("constant", "0.75", "1.02 * 0.75"),
            ("term", "* n", "nothing"),
        ])

    def test_are_at_run_time_what_they_would_be_if_written(self):
        alone = []
        for place in mutant_places.places_of("f.cpp", PROGRAM):  # as the script does: one of a statement
            if all(place.statement[0] >= p.statement[1] or p.statement[0] >= place.statement[1] for p in alone):
                alone.append(place)
        self.assertEqual(len(alone), 6)
        with tempfile.TemporaryDirectory() as folder:
            program = compiled(folder, "all", mutant_places.with_faults(PROGRAM, list(enumerate(alone, 1))))
            run = lambda path, n: subprocess.run([path], capture_output=True, text=True,
                                                 env={**os.environ, "CAMBER_MUTANT": str(n)}).stdout
            self.assertEqual(run(program, 0), run(compiled(folder, "none", PROGRAM), 0))
            for number, place in enumerate(alone, 1):
                written = run(compiled(folder, "one", with_fault(PROGRAM, place)), 0)
                self.assertEqual(run(program, number), written, place)
                self.assertNotEqual(written, run(program, 0), place)


if __name__ == "__main__":
    unittest.main()
