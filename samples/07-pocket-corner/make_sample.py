#!/usr/bin/env python3
"""Makes finish.nc of this sample: the walls of a pocket's corner, finished in one pass of 1.5 mm depth.

The tool comes along the first wall, stops for the corner and leaves along the second one. In the corner the feed drops and
the cutter is engaged over more than a quarter turn. Needs nothing but Python 3.
"""
import os

RADIUS, LENGTH, PASSES, DEPTH = 3.0, 12.0, 1, 1.5


def main():
    lines = ["%", "O0701 (CAMBER SAMPLE 07 - CORNER OF A POCKET)", "G21 G17 G40 G49 G80 G90",
             "T1 M6 (6. FLAT, 3 FLUTES)", "G54 S5000 M3", "G0 Z10.", "G0 X%.1f Y%.1f" % (LENGTH + 2, RADIUS + 2)]
    for i in range(PASSES):
        lines += ["(PASS %d)" % (i + 1), "G0 X%.1f Y%.1f" % (LENGTH + 2, RADIUS + 2), "Z1.",
                  "G1 Z%.1f F300" % (-DEPTH * (i + 1)), "G1 Y%.1f F900" % RADIUS,
                  "G1 X%.1f" % RADIUS, "G1 Y%.1f" % LENGTH, "G1 X%.1f" % (RADIUS + 2), "G0 Z10."]
    lines += ["M5", "M30", "%"]
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "finish.nc"), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
