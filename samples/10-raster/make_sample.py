#!/usr/bin/env python3
"""Makes part.stl of this sample: a block under two gentle bows that meet in a sharp edge, the character line.

    samples/10-raster/make_sample.py                        part.stl, 8 x 5 mm, beside this script
    samples/10-raster/make_sample.py LARGE.stl 60 30        the same shape, larger: the surface of samples/08-resegment

The character line runs aslant; the mesh has it as a row of edges. Needs nothing but Python 3.
"""
import os
import struct
import sys

GRID_MM = 0.5


def line(y, width):
    return 28 / 60 * width + 0.25 * y


def height(x, y, width):
    """The two bows of samples/08-resegment; a smaller width takes out of the middle, around the line."""
    shift = 28 - 28 / 60 * width
    u, edge = x + shift, 28 + 0.25 * y
    if u <= edge:
        return 6 - 0.004 * (u - 12) ** 2 - 0.002 * y * y
    at = 6 - 0.004 * (edge - 12) ** 2 - 0.002 * y * y
    return at - 0.32 * (u - edge) + 0.0045 * (u - edge) ** 2


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "part.stl")
    width, depth = (float(v) for v in sys.argv[2:4]) if len(sys.argv) > 3 else (8.0, 5.0)
    rows, half = max(2, round(depth / GRID_MM)), max(2, round(width / GRID_MM / 2))
    grid = []
    for j in range(rows + 1):
        y, row = depth * j / rows, []
        edge = line(y, width)
        for i in range(2 * half + 1):
            x = edge * i / half if i <= half else edge + (width - edge) * (i - half) / half
            row.append((x, y, height(x, y, width)))
        grid.append(row)
    bottom = min(p[2] for row in grid for p in row) - 4
    triangles = []

    def quad(a, b, c, d):
        triangles.extend([(a, b, c), (a, c, d)])

    def low(p):
        return (p[0], p[1], bottom)

    for j in range(rows):
        for i in range(2 * half):
            quad(grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i])
            quad(low(grid[j][i]), low(grid[j + 1][i]), low(grid[j + 1][i + 1]), low(grid[j][i + 1]))
        quad(low(grid[j + 1][0]), low(grid[j][0]), grid[j][0], grid[j + 1][0])
        quad(low(grid[j][-1]), low(grid[j + 1][-1]), grid[j + 1][-1], grid[j][-1])
    for i in range(2 * half):
        quad(low(grid[0][i]), low(grid[0][i + 1]), grid[0][i + 1], grid[0][i])
        quad(low(grid[-1][i + 1]), low(grid[-1][i]), grid[-1][i], grid[-1][i + 1])
    with open(path, "wb") as out:
        out.write(b"character line".ljust(80) + struct.pack("<I", len(triangles)))
        for t in triangles:
            out.write(struct.pack("<12fH", 0, 0, 0, *(v for p in t for v in p), 0))


if __name__ == "__main__":
    main()
