#!/usr/bin/env python3
"""scripts/check-markdown on small files: long lines, tables, code, and rewrapping."""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/check-markdown")
LONG = "word " * 30


class CheckMarkdown(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        os.mkdir(os.path.join(self.folder.name, "scripts"))
        shutil.copy(SCRIPT, os.path.join(self.folder.name, "scripts"))
        self.write("scripts/wide-tables", "# none\n")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, path, text):
        with open(os.path.join(self.folder.name, path), "w", encoding="utf8") as out:
            out.write(text)

    def read(self, path):
        with open(os.path.join(self.folder.name, path), encoding="utf8") as file:
            return file.read()

    def check(self, *arguments):
        run = subprocess.run([sys.executable, "scripts/check-markdown", *arguments, "a.md"], cwd=self.folder.name,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return run.returncode, run.stdout

    def test_counts_characters_not_bytes(self):
        self.write("a.md", "µ" * 60 + " " + "µ" * 39 + "\n")
        self.assertEqual(self.check(), (0, "check-markdown: 1 files, at most 100 characters a line\n"))

    def test_names_a_line_of_101_characters(self):
        self.write("a.md", "# Title\n\n" + "a" * 50 + " " + "b" * 50 + "\n")
        status, printed = self.check()
        self.assertEqual(status, 1)
        self.assertTrue(printed.startswith("a.md:3: 101 characters"), printed)

    def test_wraps_paragraphs_and_items_and_leaves_the_rest(self):
        code = "```\n" + LONG + "x\n```\n"
        self.write("a.md", LONG + "end\n\n- " + LONG + "end\n  goes on\n\n" + code)
        self.assertEqual(self.check("--wrap")[0], 1)  # the line of code
        text = self.read("a.md")
        self.assertTrue(text.endswith(code))
        paragraph, item = text.split("\n\n")[:2]
        self.assertEqual(paragraph.split(), (LONG + "end").split())
        self.assertEqual(item.split(), ("- " + LONG + "end goes on").split())
        for line in (paragraph + "\n" + item).split("\n"):
            self.assertLessEqual(len(line), 100)
        self.assertTrue(all(line.startswith("  ") for line in item.split("\n")[1:]))

    def test_a_wrapped_line_does_not_begin_with_a_marker(self):
        self.write("a.md", "a" * 95 + " x 1 - 2 # 3 + 4\n")
        self.assertEqual(self.check("--wrap")[0], 0)
        for line in self.read("a.md").split("\n"):
            self.assertFalse(line[:2] in ("- ", "# ", "+ "), line)

    def test_accepts_no_more_wide_table_rows_than_listed(self):
        self.write("a.md", "| " + LONG + " |\n|---|\n| " + LONG + " |\n")
        self.assertEqual(self.check()[0], 1)
        self.write("scripts/wide-tables", "2 a.md\n")
        self.assertEqual(self.check()[0], 0)
        self.write("scripts/wide-tables", "1 a.md\n")
        self.assertIn("a.md: 2 rows of tables", self.check()[1])


if __name__ == "__main__":
    unittest.main()
