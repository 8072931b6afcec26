#!/usr/bin/env python3
"""Writes part.stl: a block with a closed pocket, an L-shaped open pocket, four slots, a free-form face and a hole; and
divided.stl: a block with an L-shaped closed pocket, whose legs differ in width.

Every floor is at Z-10; the free-form face goes down to Z-4.5. The blank of plan.toml is 5 mm higher.
"""
import math
import os
import struct

LENGTH, WIDTH, HEIGHT, FLOOR = 200.0, 150.0, 40.0, -10.0
POCKETS = [  # x from, to, y from, to
    (20, 100, 60, 120),   # closed pocket, 60 mm wide
    (150, 200, 110, 150), (110, 150, 130, 150),  # open pocket, an L at the corner
    (30, 66, 0, 40), (74, 110, 0, 40),  # slots of 36 mm from the front
    (170, 200, 21, 41), (170, 200, 60, 80),  # slots of 20 mm from the right
]
FREE = (120, 160, 50, 100, 4.5)  # and depth
HOLE = (10, 12, 10.0, 48)  # x, y, diameter, facets
STEPS = 12
DIVIDED = [(20, 80, 20, 130), (80, 180, 20, 50)]


def free_form(x, y):
    x0, x1, y0, y1, depth = FREE
    if not (x0 <= x <= x1 and y0 <= y <= y1):
        return 0.0
    return -depth * math.sin(math.pi * (x - x0) / (x1 - x0)) ** 2 * math.sin(math.pi * (y - y0) / (y1 - y0)) ** 2


def lines(pockets, high, index):
    half = HOLE[2] / 2 + 2
    out = {0.0, float(high)}
    for p in pockets:
        out |= {float(p[2 * index]), float(p[2 * index + 1])}
    if pockets is not POCKETS:
        return sorted(out)
    out |= {HOLE[index] - half, HOLE[index] + half}
    a, b = FREE[2 * index], FREE[2 * index + 1]
    out |= {a + (b - a) * i / STEPS for i in range(STEPS + 1)}
    return sorted(out)


def in_any(pockets, x, y):
    return any(p[0] < x < p[1] and p[2] < y < p[3] for p in pockets)


def ring(x0, x1, y0, y1, z, up):
    """A square with the hole in it: each facet to the corner of its quarter."""
    hx, hy, d, n = HOLE
    rim = [(hx + d / 2 * math.cos(2 * math.pi * i / n), hy + d / 2 * math.sin(2 * math.pi * i / n), z) for i in range(n)]
    corner = [(x1, y1, z), (x0, y1, z), (x0, y0, z), (x1, y0, z)]
    out = []
    for i in range(n):
        quarter, after = 4 * i // n, 4 * ((i + 1) % n) // n
        out.append((rim[i], corner[quarter], rim[(i + 1) % n]))
        if after != quarter:
            out.append((rim[(i + 1) % n], corner[quarter], corner[after]))
    return out if up else [(a, c, b) for a, b, c in out]


def triangles(pockets):
    xs, ys = lines(pockets, LENGTH, 0), lines(pockets, WIDTH, 1)
    whole = pockets is POCKETS  # with the free-form face and the hole
    deep = [[in_any(pockets, (a + b) / 2, (c + d) / 2) for c, d in zip(ys, ys[1:])] for a, b in zip(xs, xs[1:])]
    out = []

    def quad(a, b, c, d):
        out.extend([(a, b, c), (a, c, d)])

    for i, (x0, x1) in enumerate(zip(xs, xs[1:])):
        for j, (y0, y1) in enumerate(zip(ys, ys[1:])):
            holed = whole and x0 < HOLE[0] < x1 and y0 < HOLE[1] < y1
            z = [FLOOR if deep[i][j] else free_form(x, y) if whole else 0.0 for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
            if holed:
                out += ring(x0, x1, y0, y1, 0.0, True) + ring(x0, x1, y0, y1, -HEIGHT, False)
            else:
                quad((x0, y0, z[0]), (x1, y0, z[1]), (x1, y1, z[2]), (x0, y1, z[3]))
                quad((x0, y0, -HEIGHT), (x0, y1, -HEIGHT), (x1, y1, -HEIGHT), (x1, y0, -HEIGHT))
            for di, dj, a, b in ((-1, 0, (x0, y1), (x0, y0)), (1, 0, (x1, y0), (x1, y1)), (0, -1, (x0, y0), (x1, y0)),
                                 (0, 1, (x1, y1), (x0, y1))):
                inside = 0 <= i + di < len(deep) and 0 <= j + dj < len(deep[0])
                levels = []
                if not inside:
                    levels.append((-HEIGHT, FLOOR))
                if not deep[i][j] and (not inside or deep[i + di][j + dj]):
                    levels.append((FLOOR, 0.0))
                for low, high in levels:
                    quad((*a, low), (*b, low), (*b, high), (*a, high))
    hx, hy, d, n = HOLE
    for i in range(n if whole else 0):
        p, q = ((hx + d / 2 * math.cos(2 * math.pi * k / n), hy + d / 2 * math.sin(2 * math.pi * k / n))
                for k in (i, (i + 1) % n))
        quad((*q, -HEIGHT), (*p, -HEIGHT), (*p, 0.0), (*q, 0.0))
    return out


def write(name, pockets):
    faces = triangles(pockets)
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), name)
    with open(path, "wb") as file:
        file.write(b"camber sample 15".ljust(80) + struct.pack("<I", len(faces)))
        for face in faces:
            file.write(struct.pack("<12fH", 0, 0, 0, *(v for p in face for v in p), 0))


def main():
    write("part.stl", POCKETS)
    write("divided.stl", DIVIDED)


if __name__ == "__main__":
    main()
