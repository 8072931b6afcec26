#!/usr/bin/env python3
"""make_parts.py [FOLDER]: the parts of this sample as STL files.

Each part is a plan of rectangles with a height over every one, a level or a surface; where heights of neighbours
differ there is an upright wall. A rectangle may have a round hole in its middle.
"""
import math
import os
import struct
import sys


def merged(values):
    out = []
    for v in sorted(values):
        if not out or v - out[-1] > 1e-9:
            out.append(v)
    return out


class Part:
    """x, y: grid lines. height(i, j) -> function of x and y over the cell; hole(i, j) -> diameter or None."""

    def __init__(self, x, y, bottom, height, hole=lambda i, j: None):
        self.x, self.y, self.bottom, self.hole = merged(x), merged(y), bottom, hole
        self.height = {(i, j): height(0.5 * (self.x[i] + self.x[i + 1]), 0.5 * (self.y[j] + self.y[j + 1]))
                       for i in range(len(self.x) - 1) for j in range(len(self.y) - 1)}
        self.triangles = []

    def top(self, cell, at):
        """Height of a cell's surface at a point; the bottom outside the plan."""
        f = self.height.get(cell)
        return self.bottom if f is None else f(*at)

    def levels(self, a, b):
        """All heights at grid point (a, b)."""
        at = (self.x[a], self.y[b])
        return [self.top((i, j), at) for i in (a - 1, a) for j in (b - 1, b)] + [self.bottom]

    def wall(self, p, q, low, high):
        """Between two upright edges: low and high are the pairs of heights at p and q; the outside is on the right."""
        def edge(point, lo, hi):
            between = [z for z in merged(self.levels(*point)) if lo + 1e-9 < z < hi - 1e-9]
            at = (self.x[point[0]], self.y[point[1]])
            return [(*at, z) for z in merged([lo, *between, hi])]
        left, right = edge(p, low[0], high[0]), edge(q, low[1], high[1])
        a, b = 0, 0
        while a + 1 < len(left) or b + 1 < len(right):
            if b + 1 == len(right) or (a + 1 < len(left) and left[a + 1][2] <= right[b + 1][2]):
                self.triangles.append((left[a], right[b], left[a + 1]))
                a += 1
            else:
                self.triangles.append((left[a], right[b], right[b + 1]))
                b += 1

    def step(self, p, q, left_cell, right_cell):
        """The wall over the grid edge from p to q."""
        ends = [(self.x[e[0]], self.y[e[1]]) for e in (p, q)]
        left = [self.top(left_cell, e) for e in ends]
        right = [self.top(right_cell, e) for e in ends]
        if max(abs(a - b) for a, b in zip(left, right)) < 1e-9:
            return
        if all(a >= b for a, b in zip(left, right)):
            self.wall(p, q, right, left)
        elif all(a <= b for a, b in zip(left, right)):
            self.wall(q, p, left[::-1], right[::-1])
        else:
            raise ValueError(f"surfaces cross over {ends}")

    def face(self, corners, cell):
        top = [(*c, self.top(cell, c)) for c in corners]
        low = [(*c, self.bottom) for c in corners]
        for k in range(1, len(corners) - 1):
            self.triangles.append((top[0], top[k], top[k + 1]))
            self.triangles.append((low[0], low[k + 1], low[k]))

    def bored(self, corners, cell, diameter, parts=64):
        cx, cy = (sum(c[k] for c in corners) / 4 for k in (0, 1))
        circle = [(cx + diameter / 2 * math.cos(a), cy + diameter / 2 * math.sin(a))
                  for a in (2 * math.pi * (k / parts - 3 / 8) for k in range(parts))]
        quarter = parts // 4
        for side in range(4):
            corner, following = corners[side], corners[(side + 1) % 4]
            points = [circle[(side * quarter + k) % parts] for k in range(-quarter // 2, quarter // 2 + 1)]
            for a, b in zip(points, points[1:]):
                self.face([corner, b, a], cell)
            self.face([corner, following, points[-1]], cell)
        for a, b in zip(circle, circle[1:] + circle[:1]):
            z = self.top(cell, a)
            self.triangles.append(((*a, z), (*b, self.bottom), (*a, self.bottom)))
            self.triangles.append(((*a, z), (*b, z), (*b, self.bottom)))

    def write(self, path):
        nx, ny = len(self.x) - 1, len(self.y) - 1
        for (i, j) in self.height:
            x, y = self.x, self.y
            corners = [(x[i], y[j]), (x[i + 1], y[j]), (x[i + 1], y[j + 1]), (x[i], y[j + 1])]
            diameter = self.hole(0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1]))
            if diameter:
                self.bored(corners, (i, j), diameter)
            else:
                self.face(corners, (i, j))
        for i in range(nx + 1):
            for j in range(ny):
                self.step((i, j), (i, j + 1), (i - 1, j), (i, j))
        for j in range(ny + 1):
            for i in range(nx):
                self.step((i, j), (i + 1, j), (i, j), (i, j - 1))
        data = struct.pack("<80sI", b"camber sample", len(self.triangles))
        for t in self.triangles:
            data += struct.pack("<12fH", 0, 0, 0, *(c for p in t for c in p), 0)
        with open(path, "wb") as file:
            file.write(data)


def level(z):
    return lambda x, y: z


def inside(x, y, box):
    return box[0] < x < box[2] and box[1] < y < box[3]


def island():
    """A pocket with an island, 8 mm deep."""
    pocket, boss = (5, 5, 55, 40), (24, 17, 36, 27)
    return Part([0, 60, *pocket[::2], *boss[::2]], [0, 45, *pocket[1::2], *boss[1::2]], -15,
                lambda x, y: level(0 if not inside(x, y, pocket) or inside(x, y, boss) else -8))


def slot():
    """A closed slot 1.2 diameters wide for a cutter of 10 mm, 6 mm deep."""
    box = (6, 9, 54, 21)
    return Part([0, 60, *box[::2]], [0, 30, *box[1::2]], -12, lambda x, y: level(-6 if inside(x, y, box) else 0))


def thin_wall():
    """Two pockets with a wall of 1 mm between them, 8 mm deep."""
    left, right = (4, 4, 29.5, 36), (30.5, 4, 56, 36)
    return Part([0, 60, *left[::2], *right[::2]], [0, 40, 4, 36], -14,
                lambda x, y: level(-8 if inside(x, y, left) or inside(x, y, right) else 0))


def die():
    """A die surface with a character line: a crease of 20 degrees that runs out."""
    def surface(x, y):
        crown = -2.5 * ((x - 30) / 30) ** 2 - 1.5 * ((y - 20) / 20) ** 2
        across = y - 20 - 3 * math.sin(math.pi * x / 60)
        fade = math.sin(math.pi * x / 60) ** 2
        return crown + fade * 0.18 * max(0.0, 6 - abs(across))
    return Part(list(range(61)), list(range(41)), -14, lambda x, y: surface)


def demonstration():
    """Face, closed pocket, open pocket at a corner, two slots of 32 mm and two of 20 mm open to a side, a free-form
    face, a hole: what the planner's published example has, with sizes that ask for the same cutters."""
    closed, corner = (20, 70, 90, 125), (120, 90, 180, 140)
    wide = [(20, 0, 52, 30), (62, 0, 94, 30)]
    narrow = [(104, 0, 124, 24), (130, 0, 150, 24)]
    free, bore = (104, 40, 150, 80), (158, 8, 172, 22)

    def wave(x, y):
        return -6 - 3 * math.sin(math.pi * (x - 104) / 46) * math.sin(math.pi * (y - 40) / 40)

    def height(x, y):
        if inside(x, y, free):
            return wave
        for box, z in [(closed, -7.6), (corner, -4.2), *[(b, -7.6) for b in wide], *[(b, -5.0) for b in narrow]]:
            if inside(x, y, box):
                return level(z)
        return level(0)

    boxes = [closed, corner, *wide, *narrow, free, bore]
    return Part([0, 180, *(v for b in boxes for v in b[::2]), *range(104, 151)],
                [0, 140, *(v for b in boxes for v in b[1::2]), *range(40, 81)], -20, height,
                lambda x, y: 10 if inside(x, y, bore) else None)


PARTS = {"island": island, "slot": slot, "thin_wall": thin_wall, "die": die, "demonstration": demonstration}


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__))
    for name, make in PARTS.items():
        make().write(os.path.join(folder, name + ".stl"))


if __name__ == "__main__":
    main()
