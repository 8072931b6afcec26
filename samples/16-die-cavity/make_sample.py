#!/usr/bin/env python3
"""Makes part.stl, finish.nc and stock.stl: a die cavity 40 mm deep with walls at 30 degrees to the vertical and a
character line across its floor, rows of a ball of 6 mm to and fro along X, and what the pass before has left; and rows.nc
with rows_stock.stl: rows of the finishing pass down one wall and over the character line, and the material around them.

    python3 make_sample.py [pitch in mm, default 4]
"""
import math
import os
import struct
import sys

DEPTH, WALL, BLEND = 40.0, math.tan(math.radians(30)), 5.0
HALF = (50.0, 40.0)       # of the block
FLOOR = (25.0, 15.0)      # half of the floor
CORNER = 8.0              # of the floor's outline
BOTTOM = -50.0            # of the block
GRID, R = 0.5, 3.0
ALLOWANCE = 0.15
LEFT = 0.5                # by the pass before, all over
HERE = os.path.dirname(os.path.abspath(__file__))


def smooth_max(a, b, width):
    h = max(width - abs(a - b), 0) / width
    return max(a, b) + h * h * width / 4


def outline(x, y):
    """Signed distance to the floor's outline, positive outside."""
    dx, dy = abs(x) - FLOOR[0] + CORNER, abs(y) - FLOOR[1] + CORNER
    return math.hypot(max(dx, 0), max(dy, 0)) + min(max(dx, dy), 0) - CORNER


def height(x, y):
    line = 1.2 * math.exp(-(((y - 5 * math.sin(x / 12)) / 3.5) ** 2))
    inside = smooth_max(outline(x, y) / WALL - DEPTH, -DEPTH + line, 2 * BLEND)
    return -smooth_max(-inside, 0, 2)


def grid():
    """Heights of the part, GRID apart: z[i][j] at (-HALF[0] + i * GRID, -HALF[1] + j * GRID)."""
    nx, ny = int(2 * HALF[0] / GRID) + 1, int(2 * HALF[1] / GRID) + 1
    return [[height(-HALF[0] + i * GRID, -HALF[1] + j * GRID) for j in range(ny)] for i in range(nx)]


def write_block(path, z, i_range, j_range, bottom, coarse=2):
    """A block with the surface z on top, as an STL file with triangles of `coarse` grid steps."""
    (i0, i1), (j0, j1) = i_range, j_range

    def point(i, j):
        return (-HALF[0] + i * GRID, -HALF[1] + j * GRID, z[i][j])

    triangles = []
    for i in range(i0, i1, coarse):
        for j in range(j0, j1, coarse):
            a, b, c, d = point(i, j), point(i + coarse, j), point(i + coarse, j + coarse), point(i, j + coarse)
            triangles += [(a, b, c), (a, c, d)]
    ring = [(i, j0) for i in range(i0, i1, coarse)] + [(i1, j) for j in range(j0, j1, coarse)] + \
           [(i, j1) for i in range(i1, i0, -coarse)] + [(i0, j) for j in range(j1, j0, -coarse)]
    foot = [(*point(i, j)[:2], bottom) for i, j in ring]
    middle = ((foot[0][0] + point(i1, j1)[0]) / 2, (foot[0][1] + point(i1, j1)[1]) / 2, bottom)
    for k in range(len(ring)):  # walls and bottom
        n = (k + 1) % len(ring)
        a, b = point(*ring[k]), point(*ring[n])
        triangles += [(foot[k], foot[n], b), (foot[k], b, a), (foot[n], foot[k], middle)]
    with open(path, "wb") as file:
        file.write(b"die cavity".ljust(80) + struct.pack("<I", len(triangles)))
        for t in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *t[0], *t[1], *t[2], 0))


def raised(z, by):
    """The surface that is `by` off z along its normal, to first order."""
    def slope(low, high, n):
        return (high - low) / (n * GRID)

    nx, ny = len(z), len(z[0])
    return [[z[i][j] + by * math.hypot(1, slope(z[max(i - 1, 0)][j], z[min(i + 1, nx - 1)][j],
                                                min(i + 1, nx - 1) - max(i - 1, 0)),
                                       slope(z[i][max(j - 1, 0)], z[i][min(j + 1, ny - 1)],
                                             min(j + 1, ny - 1) - max(j - 1, 0)))
             for j in range(ny)] for i in range(nx)]


def finishing_rows(z, pitch, ys=(-36.0, 36.0), xs=(-46.0, 46.0)):
    """Tips of the ball in rows along X, to and fro, where it is below the face of the block."""
    reach = int(R / GRID)
    ball = [(di, dj, math.sqrt(R * R - (di * GRID) ** 2 - (dj * GRID) ** 2) - R)
            for di in range(-reach, reach + 1) for dj in range(-reach, reach + 1)
            if (di * GRID) ** 2 + (dj * GRID) ** 2 <= R * R]
    first, last = round((xs[0] + HALF[0]) / GRID), round((xs[1] + HALF[0]) / GRID)
    rows = []
    y = ys[0]
    while y <= ys[1] + 1e-9:
        j = round((y + HALF[1]) / GRID)
        row = [(-HALF[0] + i * GRID, -HALF[1] + j * GRID, max(z[i + di][j + dj] + rise for di, dj, rise in ball))
               for i in range(first, last + 1, 2)]  # blocks of 1 mm
        rows.append([p for p in row if p[2] < -1.0])
        y += pitch
    return [r if k % 2 == 0 else r[::-1] for k, r in enumerate([r for r in rows if len(r) > 3])]


def write_program(path, rows):
    with open(path, "w") as file:
        file.write("(DIE CAVITY, BALL 6, ROWS ALONG X)\nG21 G17 G40 G49 G80 G90 G94\nG64 P0.01\n"
                   "G10 L2 P1 X25. Y-15. Z5.\nG10 L1 P1 Z140.\nT1 M6\nG54\nS12000 M3\nG43 H1\nG0 X0. Y0. Z30.\n")
        for row in rows:
            x, y, top = row[0]
            file.write(f"G0 X{x:.3f} Y{y:.3f}\nG0 Z{top + 2:.3f}\nG1 Z{top:.4f} F600.\n")
            for k, (x, y, depth) in enumerate(row[1:]):
                file.write(f"{'G1 ' if k == 0 else ''}X{x:.3f} Z{depth:.4f}{' F1500.' if k == 0 else ''}\n")
            file.write("G0 Z30.\n")
        file.write("M5\nM2\n")


def column(x, y):
    return round((x + HALF[0]) / GRID), round((y + HALF[1]) / GRID)


def main():
    z = grid()
    write_block(os.path.join(HERE, "part.stl"), z, (0, len(z) - 1), (0, len(z[0]) - 1), BOTTOM)
    write_block(os.path.join(HERE, "stock.stl"), raised(z, LEFT), (0, len(z) - 1), (0, len(z[0]) - 1), BOTTOM, 5)
    write_program(os.path.join(HERE, "finish.nc"), finishing_rows(z, float(sys.argv[1]) if len(sys.argv) > 1 else 4.0))
    write_program(os.path.join(HERE, "rows.nc"), finishing_rows(z, 0.5, (-4.5, -3.5), (-46.0, 0.0)))
    (i0, j0), (i1, j1) = column(-49, -8), column(3, 0)
    write_block(os.path.join(HERE, "rows_stock.stl"), raised(z, ALLOWANCE), (i0, i1), (j0, j1), BOTTOM)


if __name__ == "__main__":
    main()
