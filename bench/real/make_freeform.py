#!/usr/bin/env python3
"""make_freeform.py OUT.nc [SIZE_MM]: ball finishing D8 of z = sqrt(160^2 - x^2 - y^2) - 160 + 2 sin(0.09 x) cos(0.07 y) over a
square of SIZE_MM (100), rows 0.4 mm apart along y, to and fro, blocks of 0.5 mm, S12000 F2400. Needs Python 3 alone."""
import math
import sys

RADIUS, DOME, STEP, BLOCK, FEED, SPINDLE = 4.0, 160.0, 0.4, 0.5, 2400, 12000


def height_and_slopes(x, y):
    root = math.sqrt(DOME ** 2 - x * x - y * y)
    return (root - DOME + 2 * math.sin(0.09 * x) * math.cos(0.07 * y),
            -x / root + 0.18 * math.cos(0.09 * x) * math.cos(0.07 * y),
            -y / root - 0.14 * math.sin(0.09 * x) * math.sin(0.07 * y))


def tip(x, y):
    z, gx, gy = height_and_slopes(x, y)
    n = math.sqrt(1 + gx * gx + gy * gy)
    return x - RADIUS * gx / n, y - RADIUS * gy / n, z + RADIUS / n - RADIUS


def main():
    size = float(sys.argv[2]) if len(sys.argv) > 2 else 100.0
    lines = ["%", "O0502 (FREE-FORM FACE)", "G21 G17 G40 G49 G80 G90", "T1 M6", "G54 S%d M3" % SPINDLE, "G0 Z20."]
    rows, blocks = round(size / STEP), round(size / BLOCK)
    for row in range(rows + 1):
        xs = [size * i / blocks for i in range(blocks + 1)]
        if row % 2:
            xs.reverse()
        for i, x in enumerate(xs):
            px, py, pz = tip(x, size * row / rows)
            if row == 0 and i == 0:
                lines += ["G0 X%.3f Y%.3f" % (px, py), "G1 Z%.3f F600" % pz]
            else:
                lines.append("%sX%.3f Y%.3f Z%.3f%s" % ("G1 " if i == 0 else "", px, py, pz, " F%d" % FEED if i < 2 else ""))
    with open(sys.argv[1], "w", newline="\n") as file:
        file.write("\n".join(lines + ["G0 Z20.", "M5", "M30", "%"]) + "\n")


if __name__ == "__main__":
    main()
