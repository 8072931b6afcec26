#!/usr/bin/env python3
"""What leaning a ball does: bench/tilted/lead_and_tilt.py [CAMBER] [--leads=-30,...] [--tilts=0,...]

A level plane is finished by a long ball of 6 mm on the machine of samples/13-dome, under tool-centre-point control.
Lead leans the tool in the direction of the feed (its tip trails the contact), tilt across it. Prints for every pair the
cutting speed at the contact (a ball that stands upright cuts with its tip, which has none), the chip that the feed gives
the tip where that is in the material, the thickest and the mean chip, force across and along the tool, and the form error
before and after camber compensate (95th percentile of its magnitude).
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../real"))
import raster_job  # noqa: E402

MACHINE = os.path.join(HERE, "../../samples/13-dome/machine.toml")
RADIUS, RPM, FEED, LENGTH, WIDTH, ROW, DEPTH = 3.0, 9000, 1800, 3.0, 1.6, 0.4, 0.2
AROUND = 2.0  # mm of the way off the plane at both ends of a row
JOB = """program = "p.nc"
machine = "%s"
""" + raster_job.tool_text(2 * RADIUS, 1860, 15, 700) + """[stock]
box_mm = [[0, 0, -1.5], [%g, %g, %g]]
[simulation]
voxel_mm = 0.1
[compensation]
tolerance_um = 0.5
max_shift_mm = 0.1
"""


def program(lead, tilt):
    """Rows along X on the plane Z = 0; the tool's axis is (sin A sin C, -sin A cos C, cos A)."""
    axis = [math.tan(math.radians(lead)), math.tan(math.radians(tilt)), 1.0]
    size = math.hypot(*axis)
    axis = [a / size for a in axis]
    a = math.degrees(math.acos(axis[2]))
    c = math.degrees(math.atan2(axis[0], -axis[1])) if a > 1e-9 else 0.0
    lines = ["G21 G90 G94", "G10 L2 P1 X0 Y0 Z-300", "G10 L1 P1 R120", "T1 M6", "S%d M3" % RPM, "G54",
             "G0 X0 Y0 Z150", "A%.4f C%.4f" % (a, c)]
    y, first = -1.5 * ROW, True
    while y < WIDTH + ROW:
        tip = [0, y, RADIUS]
        tip = [t - RADIUS * k for t, k in zip(tip, axis)]
        ends = tip[0] - AROUND, tip[0] + LENGTH + AROUND
        lines += ["%sG0 X%.4f Y%.4f Z%.4f" % ("G43.4 H1 " if first else "", ends[0], tip[1], tip[2] + 6),
                  "G1 Z%.4f F500" % tip[2], "X%.4f F%d" % (ends[1], FEED), "G0 Z%.4f" % (tip[2] + 6)]
        y, first = y + ROW, False
    return "\n".join(lines + ["G49", "M5", "M30"]) + "\n", axis


def run(camber, lead, tilt):
    text, axis = program(lead, tilt)
    with tempfile.TemporaryDirectory() as folder:
        def path(name):
            return os.path.join(folder, name)
        with open(path("p.nc"), "w") as f:
            f.write(text)
        with open(path("job.toml"), "w") as f:
            f.write(JOB % (os.path.relpath(MACHINE, folder), LENGTH, WIDTH, DEPTH))
        for command in (["predict", "job.toml", "-o", "out", "--json", "p.json"],
                        ["compensate", "job.toml", "-o", "c.nc", "--json", "c.json"]):
            result = subprocess.run([camber] + command + ["-q"], cwd=folder, capture_output=True, text=True)
            if result.returncode not in (0, 3):
                raise SystemExit("lead %g tilt %g: %s" % (lead, tilt, result.stderr))
        rows = list(csv.DictReader(open(path("out/forces.csv"))))
        cut = [r for r in rows if float(r["removed_mm3"]) > 0]
        plain = json.load(open(path("c.json")))

    def largest(key):
        return max((abs(float(r[key])) for r in cut if key in r), default=math.nan)
    mean = sum(float(r["h_mean_mm"]) for r in cut) / len(cut)
    speed = math.pi * 2 * RADIUS * math.sqrt(max(0, 1 - axis[2] ** 2)) * RPM / 1000
    at_tip = 1000 * FEED / RPM / 2 * max(0.0, -axis[0]) if RADIUS * (1 - axis[2]) < DEPTH else 0.0
    before, after = plain["before_um"]["p95"], plain["after_um"]["p95"]
    axial = largest("f_axial_max_N") if "f_axial_max_N" in rows[0] else largest("fz_max_N")
    print("| %4g | %4g | %6.0f | %6.1f | %7.1f | %7.1f | %6.0f | %6.0f | %7.2f | %7.2f | %3.0f %% |" %
          (lead, tilt, speed, at_tip, 1000 * largest("h_max_mm"), 1000 * mean, largest("f_max_N"), axial, before, after,
           100 * after / before), flush=True)


def main():
    def numbers(text):
        return [float(n) for n in text.split(",")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("camber", nargs="?", default=os.path.join(HERE, "../../build/release/camber"))
    parser.add_argument("--leads", type=numbers, default=[-30, -10, 0, 10, 30])
    parser.add_argument("--tilts", type=numbers, default=[0, 15, 30])
    arguments = parser.parse_args()
    print("| lead | tilt | v_c at the contact, m/min | h at the tip, um | h max, um | h mean, um | F across, N | F along, N "
          "| p95 before, um | after, um | remains |\n|---|---|---|---|---|---|---|---|---|---|---|")
    for lead in arguments.leads:
        for tilt in arguments.tilts:
            run(os.path.abspath(arguments.camber), lead, tilt)


main()
