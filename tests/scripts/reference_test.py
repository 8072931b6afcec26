#!/usr/bin/env python3
"""The reference of keys is complete and current, and scripts/reference --check notices where it is not."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = SOURCE / "scripts/reference"


def check(root):
    done = subprocess.run([sys.executable, SCRIPT, "--check", root], capture_output=True, text=True)
    return done.returncode, done.stdout


class Reference(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for room in ("machine", "calib", "feedmodel", "inspect", "plan", "report", "api", "cli", "nc",
                     "docs/reference"):
            shutil.copytree(SOURCE / room, self.root / room, ignore=shutil.ignore_patterns("web"))

    def edit(self, path, before, after):
        file = self.root / path
        text = file.read_text()
        self.assertIn(before, text)
        file.write_text(text.replace(before, after, 1))

    def assert_stale(self, page):
        status, out = check(self.root)
        self.assertEqual(status, 1)
        self.assertIn("docs/reference/%s: is not what scripts/reference makes" % page, out)

    def assert_missing(self, key, path):
        status, out = check(self.root)
        self.assertEqual(status, 1)
        self.assertIn(f"{path}: {key} stands in no line", out)

    def test_the_repository_is_complete(self):
        self.assertEqual(check(SOURCE), (0, "reference: 7 pages, every key in one\n"))
        self.assertEqual(check(self.root)[0], 0)

    def test_a_new_number_of_the_machine(self):
        self.edit("machine/machine_reader.cpp", 'table.text("axes", "xyz")', 'table.text("new_key", "xyz")')
        self.assert_missing("new_key", "machine/machine_reader.cpp")

    def test_a_new_key_of_the_job(self):
        self.edit("machine/job_file.cpp", '"allowance_mm"', '"thickness_mm"')
        self.assert_missing("thickness_mm", "machine/job_file.cpp")

    def test_a_new_name_of_a_material(self):
        self.edit("machine/material_presets.cpp", "S45C S48C", "S45C S45CM S48C")
        self.assert_stale("materials.md")

    def test_a_word_of_sinumerik_that_is_refused(self):
        self.edit("nc/siemens/siemens_words.cpp", '"CHF CHR", kAddress, Does::extra, ', '"CHF CHR", kAddress, Does::refused, ')
        self.assert_stale("siemens-words.md")

    def test_a_code_without_words(self):
        self.edit("nc/modal_codes.cpp", "    Entry{30, {GGroup::motion}},", "    Entry{30, {GGroup::motion}},\n    Entry{35, {GGroup::motion}},")
        self.assertEqual(check(self.root)[0], 1)

    def test_a_renamed_number(self):
        self.edit("machine/machine_keys.h", '{"orient_s"', '{"turn_s"')
        self.assert_stale("machine.md")

    def test_a_number_without_words(self):
        self.edit("machine/machine_keys.h", '{"orient_s", &Spindle::orient_s', '{"turn_s", &Spindle::turn_s')
        status, out = check(self.root)
        self.assertEqual(status, 1)
        self.assertIn("turn_s (kSpindleKeys): neither Spindle::turn_s has a comment", out)

    def test_a_new_json_key(self):
        self.edit("report/figures_json.cpp", 'j["stamps"]', 'j["new_figure"]')
        self.assert_missing("new_figure", "report/figures_json.cpp")

    def test_a_new_column(self):
        self.edit("feedmodel/feed_csv.cpp", "t_s,block,", "t_s,new_column,")
        self.assert_missing("new_column", "feedmodel/feed_csv.cpp")

    def test_a_page_that_was_edited(self):
        self.edit("docs/reference/job.md", "`diameter_mm`", "`diameter`")
        status, out = check(self.root)
        self.assertEqual(status, 1)
        self.assertIn("docs/reference/job.md: is not what scripts/reference makes", out)


if __name__ == "__main__":
    unittest.main()
