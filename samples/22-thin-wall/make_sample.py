#!/usr/bin/env python3
"""Makes finish.nc of this sample: a wall of 2 x 30 x 60 mm is finished level by level, both sides in turn, down milling.

The wall stands between y = 0 and y = 2 with 0.2 mm on each side. What stands above a level is finished and thin, what
lies below it is as thick as the blank. Needs nothing but Python 3.
"""
import os

RADIUS, LENGTH, THICKNESS, HEIGHT, LEVEL, ASIDE = 5.0, 60.0, 2.0, 30.0, 6.0, 7.0


def main():
    front, back = THICKNESS + RADIUS, -RADIUS
    lines = ["%", "O0622 (CAMBER SAMPLE 22 - THIN WALL)", "G21 G17 G40 G49 G80 G90",
             "T1 M6 (10. FLAT, 2 FLUTES, 30 DEG, RELIEVED)", "G54 S6000 M3", "G0 Z10."]
    level = 0
    while level < HEIGHT:
        level += LEVEL
        lines += ["(LEVEL %.1f)" % -level,
                  "G0 X%.1f Y%.1f" % (-ASIDE, front), "G0 Z%.1f" % -level, "G1 X%.1f F1200" % (LENGTH + ASIDE), "G0 Z10.",
                  "G0 Y%.1f" % back, "G0 Z%.1f" % -level, "G1 X%.1f F1200" % -ASIDE, "G0 Z10."]
    lines += ["M5", "M30", "%"]
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "finish.nc"), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
