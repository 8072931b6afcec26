#!/usr/bin/env python3
"""Makes finish.nc of this sample: a helical flat end mill finishes the walls of an island of 16 x 10 mm, corners of 2 mm.

First along the front and the right hand wall with the work on its left (up milling), then along the left hand and the rear
wall with the work on its right (down milling). Lead-ins and lead-outs are quarter turns. Needs nothing but Python 3.
"""
import os

RADIUS, X, Y, CORNER, DEPTH = 4.0, 16.0, 10.0, 2.0, 6.0


def main():
    r, c = RADIUS, CORNER
    out = r + 3
    lines = ["%", "O0601 (CAMBER SAMPLE 06 - WALLS)", "G21 G17 G40 G49 G80 G90", "T1 M6 (8. FLAT, 4 FLUTES, 45 DEG)",
             "G54 S4000 M3", "G0 Z10.", "(UP MILLING)",
             "G0 X-2. Y%.1f" % -out, "G0 Z%.1f" % -DEPTH,
             "G1 X1. F640", "G2 X4. Y%.1f I3. J0." % -r,
             "G1 X%.1f" % (X - c), "G3 X%.1f Y%.1f I0. J%.1f" % (X + r, c, r + c), "G1 Y%.1f" % (Y - 1),
             "G2 X%.1f Y%.1f I3. J0." % (X + out, Y + 2),
             "G0 Z10.", "(DOWN MILLING)",
             "G0 X%.1f Y1." % -out, "G0 Z%.1f" % -DEPTH,
             "G3 X%.1f Y4. I0. J3. F640" % -r, "G1 Y%.1f" % (Y - c),
             "G2 X%.1f Y%.1f I%.1f J0." % (c, Y + r, r + c), "G1 X%.1f" % (X - 1), "G3 X%.1f Y%.1f I0. J3." % (X + 2, Y + out),
             "G0 Z10.", "M5", "M30", "%"]
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "finish.nc"), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
