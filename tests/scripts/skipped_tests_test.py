"""scripts/skipped-tests names every skipped test with its reason."""
import pathlib
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(__file__).parents[2] / "scripts" / "skipped-tests"
LOG = """1/4 Test: Traces.Fit
Output:
[ RUN      ] Traces.Fit
/src/tests/calib/fit_test.cpp:82: Skipped
the servo traces (shared data) are not here

[  SKIPPED ] Traces.Fit (0 ms)
[  PASSED  ] 0 tests.
[  SKIPPED ] 1 test, listed below:
[  SKIPPED ] Traces.Fit
Test Passed.
2/4 Test: Kernels.Wide
[ RUN      ] Kernels.Wide
/src/tests/removal/kernels_test.cpp:89: Skipped
no AVX2 here

[  SKIPPED ] Kernels.Wide (0 ms)
3/4 Test: Quiet.One
[ RUN      ] Quiet.One
/src/tests/base/quiet_test.cpp:7: Skipped

[  SKIPPED ] Quiet.One (0 ms)
4/4 Test: Good.One
[ RUN      ] Good.One
[       OK ] Good.One (0 ms)
"""
EXPECTED = """1 test skipped for want of ../shared/data:
  Traces.Fit: the servo traces (shared data) are not here
2 tests skipped for other reasons:
  Kernels.Wide: no AVX2 here
  Quiet.One: no reason given
"""


def printed(log):
    with tempfile.NamedTemporaryFile("w", suffix=".log") as file:
        file.write(log)
        file.flush()
        return subprocess.run([sys.executable, SCRIPT, file.name], capture_output=True, text=True, check=True).stdout


assert printed(LOG) == EXPECTED, printed(LOG)
assert printed("") == "0 tests skipped for want of ../shared/data\n0 tests skipped for other reasons\n", printed("")
