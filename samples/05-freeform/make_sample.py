#!/usr/bin/env python3
"""Makes finish.nc of this sample: ball finishing of a free-form face that goes from shallow to steep, to and fro.

    z = sqrt(81 - x^2 - y^2) - 9 + 0.2 sin(0.9 x) cos(0.7 y),   0 <= x, y <= 6 mm

The slope grows from 10 degrees near the origin to 70 degrees in the far corner. Rows at a constant y of the contact,
0.25 mm apart along the surface at least, neighbouring rows in opposite directions: up milling and down milling in turns.
The ball's centre lies R along the normal from the contact. Needs nothing but Python 3.
"""
import math
import os

RADIUS, SIZE, DOME = 2.0, 6.0, 9.0
BEYOND = 0.6          # rows begin and end outside the part
STEP = 0.25           # between rows, along the surface at the row's middle
BLOCK = 0.4           # in x
FEED, SPINDLE = 1200, 6000


def height(x, y):
    return math.sqrt(DOME ** 2 - x * x - y * y) - DOME + 0.2 * math.sin(0.9 * x) * math.cos(0.7 * y)


def slopes(x, y):
    root = math.sqrt(DOME ** 2 - x * x - y * y)
    return (-x / root + 0.18 * math.cos(0.9 * x) * math.cos(0.7 * y),
            -y / root - 0.14 * math.sin(0.9 * x) * math.sin(0.7 * y))


def tip(x, y):
    """From the contact; outside the part the contact of its edge, moved on level."""
    u, v = min(max(x, 0), SIZE), min(max(y, 0), SIZE)
    gx, gy = slopes(u, v)
    n = math.sqrt(1 + gx * gx + gy * gy)
    z = height(u, v) + gx * (x - u) + gy * (y - v)
    return x - RADIUS * gx / n, y - RADIUS * gy / n, z + RADIUS / n - RADIUS


def main():
    lines = ["%", "O0501 (CAMBER SAMPLE 05 - FREE-FORM FINISHING)", "G21 G17 G40 G49 G80 G90", "T1 M6 (4. BALL, 2 FLUTES)",
             "G54 S%d M3" % SPINDLE, "G0 Z12."]
    y, row = -0.3, 0
    while y < SIZE + 0.3:
        count = int(round((SIZE + 2 * BEYOND) / BLOCK))
        xs = [-BEYOND + (SIZE + 2 * BEYOND) * i / count for i in range(count + 1)]
        if row % 2:
            xs.reverse()
        lines.append("(ROW %d)" % (row + 1))
        for i, x in enumerate(xs):
            px, py, pz = tip(x, y)
            if i == 0:
                lines += ["G0 X%.3f Y%.3f" % (px, py), "Z%.3f" % (pz + 1), "G1 Z%.3f F400" % pz]
            else:
                lines.append(("G1 " if i == 1 else "") + "X%.3f Y%.3f Z%.3f" % (px, py, pz) + (" F%d" % FEED if i == 1 else ""))
        lines.append("G0 Z12.")
        gy = slopes(SIZE / 2, min(max(y, 0), SIZE))[1]
        y += STEP / math.sqrt(1 + gy * gy)
        row += 1
    lines += ["M5", "M30", "%"]
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "finish.nc"), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
