"""freecad_test.py addon|picture: the FreeCAD add-on, without a screen, and with one that nobody sees.

Skipped by name where FreeCAD or Xvfb is absent (scripts/install-packages --freecad).
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77  # ctest's SKIP_RETURN_CODE


def skip(name, why):
    print(f"{__file__}:1: Skipped\n{why}\n\n[  SKIPPED ] {name}")
    sys.exit(SKIPPED)


def environment(home):
    return dict(os.environ, CAMBER_ROOT=str(HERE.parents[1]), HOME=home, FREECAD_USER_HOME=home, QT_QPA_PLATFORM="")


def addon():
    program = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
    if not program:
        skip("FreeCad.AddOn", "no freecadcmd")
    with tempfile.TemporaryDirectory() as home:
        done = subprocess.run([program, str(HERE / "addon_checks.py")], env=environment(home), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
    print("\n".join(line for line in done.stdout.splitlines() if "%)" not in line))
    return done.returncode


def picture():
    program, screen = shutil.which("freecad") or shutil.which("FreeCAD"), shutil.which("xvfb-run")
    if not program or not screen:
        skip("FreeCad.Picture", "no freecad" if not program else "no xvfb-run")
    target = os.environ.get("CAMBER_PICTURE")
    with tempfile.TemporaryDirectory() as home:
        path = target or os.path.join(home, "map.png")
        # FreeCAD's start page is a browser, which refuses to run as root in its sandbox.
        env = dict(environment(home), CAMBER_PICTURE=path, QTWEBENGINE_DISABLE_SANDBOX="1")
        env.pop("QT_QPA_PLATFORM")
        done = subprocess.run([screen, "-a", "-s", "-screen 0 1280x900x24", program, str(HERE / "picture_checks.py")],
                              env=env, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors="replace", timeout=300)
    print("\n".join(line for line in done.stdout.splitlines() if "%)" not in line))
    return 0 if "picture: good" in done.stdout else 1


sys.exit({"addon": addon, "picture": picture}[sys.argv[1]]())
