"""scripts/test-summary names every skipped test with its reason and counts the others."""
import pathlib
import subprocess
import sys
import tempfile
from xml.sax.saxutils import escape

SCRIPT = pathlib.Path(__file__).parents[2] / "scripts" / "test-summary"
SKIP = '<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>'
TESTS = (
    ("Good.One", "run", "", "[       OK ] Good.One (0 ms)\n"),
    ("Kernels.Wide", "notrun", SKIP, """[ RUN      ] Kernels.Wide
/src/tests/removal/kernels_test.cpp:89: Skipped
no AVX2 here,
a <second> line

[  SKIPPED ] Kernels.Wide (0 ms)
[  PASSED  ] 0 tests.
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Kernels.Wide
"""),
    ("Bad.One", "fail", '<failure message=""/>', "1 failure\n"),
    ("Quiet.One", "notrun", SKIP, """/src/tests/base/quiet_test.cpp:7: Skipped

[  SKIPPED ] Quiet.One (0 ms)
"""),
    ("Gone.One", "notrun", '<skipped message="Unable to find executable"/>', "Unable to find executable: /build/gone"),
    ("Off.One", "disabled", "", "Disabled"),
    ("Python.module", "run", "", """test_a (__main__.Plot.test_a)
What a has to do. ... skipped 'no matplotlib'
test_b (__main__.Plot.test_b) ... ok
test_c (__main__.Plot.test_c) ... skipped "it's not here"

OK (skipped=2)
"""),
)
EXPECTED = """Skipped:
  Kernels.Wide: no AVX2 here, a <second> line
  Quiet.One: no reason given
  Off.One: disabled
Skipped parts of tests that passed:
  Python.module, test_a: no matplotlib
  Python.module, test_c: it's not here
2 passed, 2 failed, 3 skipped
"""


def printed(tests):
    cases = "".join(f'<testcase name="{name}" classname="{name}" time="0" status="{status}">{mark}'
                    f"<system-out>{escape(output)}</system-out></testcase>" for name, status, mark, output in tests)
    with tempfile.NamedTemporaryFile("w", suffix=".xml") as file:
        file.write(f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="(empty)">{cases}</testsuite>\n')
        file.flush()
        return subprocess.run([sys.executable, SCRIPT, file.name], capture_output=True, text=True, check=True).stdout


assert printed(TESTS) == EXPECTED, printed(TESTS)
assert printed(()) == "0 passed, 0 failed, 0 skipped\n", printed(())
