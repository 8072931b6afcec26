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


class DropBall:
    """The ball lowered onto the triangles that write_block makes of z, exactly: on their faces, edges and corners."""

    def __init__(self, z, coarse=2):
        self.z, self.step, self.coarse = z, coarse * GRID, coarse

    def corner(self, i, j):
        return (-HALF[0] + i * self.step, -HALF[1] + j * self.step, self.z[i * self.coarse][j * self.coarse])

    def tip(self, x, y):
        """Height of the ball's lowest point, above (x, y)."""
        def cells(at, half, count):
            return range(max(0, int((at - R + half) // self.step)),
                         min(count, int((at + R + half) // self.step) + 1))

        centre = -1e9
        for i in cells(x, HALF[0], (len(self.z) - 1) // self.coarse):
            for j in cells(y, HALF[1], (len(self.z[0]) - 1) // self.coarse):
                a, b, c, d = self.corner(i, j), self.corner(i + 1, j), self.corner(i + 1, j + 1), self.corner(i, j + 1)
                if max(a[2], b[2], c[2], d[2]) + R <= centre:
                    continue
                for triangle in ((a, b, c), (a, c, d)):
                    centre = max(centre, on_face(triangle, x, y))
                for p, q in ((a, b), (a, c), (a, d), (b, c), (c, d)):
                    centre = max(centre, on_edge(p, q, x, y))
        return centre - R


def on_face(triangle, x, y):
    """Height of the middle of a ball above (x, y) that touches the face of a triangle; -1e9: it does not."""
    a, b, c = triangle
    u, v = [b[k] - a[k] for k in range(3)], [c[k] - a[k] for k in range(3)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    size = math.sqrt(n[0] ** 2 + n[1] ** 2 + n[2] ** 2)
    n = [k / size for k in n]
    px, py = x - R * n[0] - a[0], y - R * n[1] - a[1]  # where it would touch, from a
    area = u[0] * v[1] - u[1] * v[0]
    s, t = (px * v[1] - py * v[0]) / area, (u[0] * py - u[1] * px) / area
    if s < 0 or t < 0 or s + t > 1:
        return -1e9
    return a[2] + (R - n[0] * (x - a[0]) - n[1] * (y - a[1])) / n[2]


def on_edge(p, q, x, y):
    """The same for an edge and its ends."""
    best = -1e9
    for e in (p, q):
        left = R * R - (x - e[0]) ** 2 - (y - e[1]) ** 2
        if left >= 0:
            best = max(best, e[2] + math.sqrt(left))
    length = math.dist(p, q)
    u = [(q[k] - p[k]) / length for k in range(3)]
    w = (x - p[0], y - p[1])
    k, flat = u[0] * w[0] + u[1] * w[1], 1 - u[2] ** 2
    inside = (k * u[2]) ** 2 - flat * (w[0] ** 2 + w[1] ** 2 - k * k - R * R)
    if inside < 0:
        return best
    rise = (k * u[2] + math.sqrt(inside)) / flat
    return max(best, p[2] + rise) if 0 <= k + u[2] * rise <= length else best


def without_gouges(drop, xs, y, parts=20):
    """Tips at xs such that the lines between them stay above the part: both ends of a line that would not are lifted."""
    tips = [drop.tip(x, y) for x in xs]
    lifts = [0.0] * len(xs)
    for k in range(len(xs) - 1):
        low = max(drop.tip(xs[k] + f * (xs[k + 1] - xs[k]), y) - tips[k] - f * (tips[k + 1] - tips[k])
                  for f in (i / parts for i in range(1, parts)))
        lifts[k], lifts[k + 1] = max(lifts[k], low), max(lifts[k + 1], low)
    # Coordinates have tenths of a micrometre.
    return [(x, y, math.ceil(1e4 * (tip + lift)) / 1e4) for x, tip, lift in zip(xs, tips, lifts)]


def finishing_rows(z, pitch, ys=(-36.0, 36.0), xs=(-46.0, 46.0)):
    """Tips of the ball in rows along X, to and fro, where it is below the face of the block."""
    drop = DropBall(z)
    rows = []
    y = ys[0]
    while y <= ys[1] + 1e-9:
        row = without_gouges(drop, [xs[0] + k for k in range(round(xs[1] - xs[0]) + 1)], y)  # blocks of 1 mm
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
