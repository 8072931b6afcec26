#!/usr/bin/env python3
"""A finishing program as a CAM system writes it, of a surface with a character line, to be laid out again.

    samples/08-resegment/make_sample.py > character_line.nc

Surface 60 x 30 mm: two gentle bows that meet in a sharp edge (the character line) which runs aslant over the part.
Rows along X, 0.3 mm apart, zigzag. Points as a CAM system with a chord tolerance of 0.005 mm lays them: where the next
chord would leave the surface by more, on a grid of its triangles, which makes the lengths of the blocks uneven.
"""
import math


def height(x, y):
    line = 28 + 0.25 * y  # where the two bows meet
    if x < line:
        return 6 - 0.004 * (x - 12) ** 2 - 0.002 * y * y
    at = 6 - 0.004 * (line - 12) ** 2 - 0.002 * y * y
    return at - 0.32 * (x - line) + 0.0045 * (x - line) ** 2


def breaks(y):
    """Where the row passes triangles: a grid whose lines lie at 0.07 to 0.6 mm, and the character line."""
    out, x, k = [0.0], 0.0, 0
    while x < 60:
        step = (0.11, 0.23, 0.07, 0.41, 0.19, 0.6, 0.13)[k % 7] * (1 + 0.3 * math.sin(0.37 * k + 0.8 * y))
        x = min(60.0, x + step)
        out.append(x)
        k += 1
    out.append(28 + 0.25 * y)
    return sorted(set(round(v, 3) for v in out))


print("%\nO0005 (CHARACTER LINE)\nG21 G17 G90 G40 G49 G80\nT1 M6 (BALL D6)\nS12000 M3\nG0 X0. Y0. Z20.\nF8000")
first = True
for row in range(101):
    y = 0.3 * row
    xs = breaks(y)
    for x in xs if row % 2 == 0 else reversed(xs):
        print(f"{'G1 ' if first else ''}X{x:.3f} Y{y:.3f} Z{height(x, y):.3f}")
        first = False
print("G0 Z20.\nM5\nM30\n%")
