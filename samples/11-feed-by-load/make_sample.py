#!/usr/bin/env python3
"""Makes rough.nc of this sample: a pocket of 40 x 28 mm, 3 mm deep, roughed by an end mill of 8 mm.

A ramp into a slot, then rounds from the inside out, 3 mm apart, with sharp corners: the slot and the corners take the
greatest force, the straight sides a good deal less. One programmed feed has to suit the slot. Needs nothing but Python 3.
"""
import os

LENGTH, WIDTH, RADIUS, STEP, DEPTH, FEED = 40.0, 28.0, 4.0, 3.0, 3.0, 600


def main():
    half_x, half_y = LENGTH / 2 - RADIUS, WIDTH / 2 - RADIUS
    spine = half_x - half_y
    lines = ["%", "O1101 (CAMBER SAMPLE 11 - FEED BY LOAD)", "G21 G17 G40 G49 G80 G90", "T1 M6 (8. FLAT, 3 FLUTES)",
             "G54 S6000 M3", "G0 X%.1f Y0. Z10." % -spine, "Z1.", "G1 Z0. F300", "(RAMP INTO THE SLOT)",
             "G1 X%.1f Z%.1f F%d" % (spine, -DEPTH / 2, FEED), "X%.1f Z%.1f" % (-spine, -DEPTH), "(SLOT)",
             "X%.1f" % spine, "(ROUNDS)"]
    offset = 0.0
    while offset < half_y:
        offset = min(offset + STEP, half_y)
        x, y = spine + offset, offset
        lines += ["X%.1f Y0." % x, "Y%.1f" % y, "X%.1f" % -x, "Y%.1f" % -y, "X%.1f" % x, "Y0."]
    lines += ["G0 Z10.", "M5", "M30", "%"]
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "rough.nc"), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
