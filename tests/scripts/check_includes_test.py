#!/usr/bin/env python3
"""scripts/check-includes on small trees: one without a fault, and one for each rule."""
import os
import subprocess
import sys
import tempfile
import unittest

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../scripts/check-includes")
SOUND = {
    "base/units.h": "#include <vector>\n",
    "removal/stock.h": '#include "base/units.h"\n',
    "removal/field/tiles.h": '#include "removal/stock.h"\n',
    "removal/stock.cpp": '#include "removal/stock.h"\n#include "removal/field/tiles.h"\n#include <openvdb/openvdb.h>\n',
    "tests/removal/tiles_test.cpp": '#include "removal/field/tiles.h"\n',
    "calib/fit.cpp": '#include <ceres/ceres.h>\n#include "base/units.h"\n',
}


def check(changes):
    with tempfile.TemporaryDirectory() as folder:
        for path, text in {**SOUND, **changes}.items():
            os.makedirs(os.path.dirname(os.path.join(folder, path)), exist_ok=True)
            with open(os.path.join(folder, path), "w", encoding="utf8") as out:
                out.write(text)
        run = subprocess.run([sys.executable, SCRIPT, folder], stdout=subprocess.PIPE, text=True)
        return run.returncode, run.stdout


class CheckIncludes(unittest.TestCase):
    def refuses(self, path, text, message):
        status, printed = check({path: text})
        self.assertEqual(status, 1, printed)
        self.assertEqual(printed.count("error:"), 1, printed)
        self.assertIn(message, printed)

    def test_accepts_a_tree_in_order(self):
        self.assertEqual(check({}), (0, "check-includes: 9 includes, all in order\n"))

    def test_refuses_an_include_to_the_right(self):
        self.refuses("base/numbers.h", '\n#include "removal/stock.h"\n', "base/numbers.h:2: error: base/ includes removal/stock.h")

    def test_refuses_openvdb_in_a_header(self):
        self.refuses("removal/field/leaf.h", "#include <openvdb/openvdb.h>\n", "removal/field/leaf.h:1: error: OpenVDB")

    def test_refuses_openvdb_outside_removal(self):
        self.refuses("report/vdb.cpp", "#include <openvdb/openvdb.h>\n", "report/vdb.cpp:1: error: OpenVDB")

    def test_refuses_ceres_outside_calib(self):
        self.refuses("nc/fit.cpp", "#include <ceres/ceres.h>\n", "nc/fit.cpp:1: error: Ceres")

    def test_refuses_a_private_header_elsewhere(self):
        self.refuses("deflection/cut.cpp", '#include "removal/field/tiles.h"\n', "removal/field/tiles.h is private")
        self.refuses("tests/deflection/cut_test.cpp", '#include "removal/field/tiles.h"\n', "removal/field/tiles.h is private")

    def test_refuses_more_beside_the_folders_of_removal(self):
        self.refuses("removal/tiles.h", "#include <vector>\n", "removal/tiles.h:1: error: beside the folders of removal/")

    def test_refuses_headers_in_a_circle(self):
        status, printed = check({"nc/a.h": '#include "nc/b.h"\n', "nc/b.h": '#include "b2.h"\n', "nc/b2.h": '#include "nc/a.h"\n'})
        self.assertEqual(status, 1)
        self.assertIn("nc/a.h -> nc/b.h -> nc/b2.h -> nc/a.h", printed)

    def test_refuses_a_file_that_is_not_there(self):
        self.refuses("nc/a.h", '#include "nc/b.h"\n', '"nc/b.h" is not there')

    def test_refuses_a_folder_without_a_place(self):
        self.refuses("misc/a.h", "\n", "misc/ has no place")


if __name__ == "__main__":
    unittest.main()
