#!/usr/bin/env python3
"""Three programs of the character of Sakai & Kondo's: scan lines over a gentle surface, mixed (scan lines and contour
lines), contour lines of a round part; and one with pockets of straight sides. Points as CAM lays them: on the curve, so
far apart that chords stay within 0.005 mm, three decimals.

    make_sample.py DIR        writes scan.nc, mixed.nc, contour.nc, pockets.nc
"""
import math
import sys

CHORD_MM = 0.005


def chords(curve, begin, end):
    """Parameters such that chords stay within CHORD_MM of the curve (curve: u -> (a, b)): measured at three points, as at
    an inflection the middle alone says nothing."""
    us, u, step = [begin], begin, (end - begin) / 50
    while u < end - 1e-12:
        step = min(step * 2, end - u)
        while True:
            (a, b), (e, f) = curve(u), curve(u + step)
            length = math.hypot(e - a, f - b)
            between = [curve(u + step * i / 4) for i in (1, 2, 3)]
            if length < 1e-9 or all(abs((e - a) * (d - b) - (f - b) * (c - a)) <= CHORD_MM * length for c, d in between):
                break
            step *= 0.8
        u += step
        us.append(u)
    return us


class Program:
    def __init__(self, plane):
        self.lines = ["%", "O1", f"G21 G90 {plane} G40 G49 G80 G94", "S8000 M3", "G0 X0. Y0. Z20."]

    def add(self, **axes):
        self.lines.append(" ".join(f"{a}{v + 0:.3f}".replace("-0.000", "0.000") for a, v in axes.items()))

    def rapid(self, x, y, z):
        self.lines += [f"G0 X{x:.3f} Y{y:.3f}", f"Z{z + 2:.3f}", f"G1 Z{z:.3f} F270."]

    def up(self):
        self.lines.append("G0 Z20.")

    def write(self, path):
        with open(path, "w", newline="\n") as out:
            out.write("\n".join(self.lines + ["M30", "%"]) + "\n")


def surface(x, y):
    """A gentle cover, 0 to 6 mm high, with a ridge that the scan lines cross."""
    return 4 * math.sin(x / 19) * math.cos(y / 23) + 0.8 * math.sin(x / 7 + y / 15) - (0.35 * abs(x - 52 - y / 9)) / 3


def scan_rows(p, rows, begin, end, pitch, y0=0.0):
    for row in range(rows):
        y = y0 + row * pitch
        us = chords(lambda x: (x, surface(x, y)), begin, end)
        ridge = 52 + y / 9
        us = sorted(set(us) | ({ridge} if begin < ridge < end else set()))
        if row % 2:
            us.reverse()
        p.rapid(us[0], y, surface(us[0], y))
        for x in us[1:]:
            p.add(X=x, Z=surface(x, y))
        p.up()


def contour(p, at, us, z):
    """The closed line through at(u), u ascending from where it begins and ends."""
    p.rapid(*at(us[0]), z)
    for u in us[1:] + us[:1]:
        x, y = at(u)
        p.add(X=x, Y=y)
    p.up()


def ring(p, cx, cy, radius, z, wave=0.0, lobes=5):
    """A contour line: a circle, or a wavy one."""
    def at(a):
        r = radius + wave * math.cos(lobes * a)
        return cx + r * math.cos(a), cy + r * math.sin(a)
    contour(p, at, chords(at, 0.0, 2 * math.pi)[:-1], z)


def cushion(p, cx, cy, half, z):
    """A contour line of a cushion: its sides bow all along, x^4 + y^4 = half^4."""
    def at(a):
        c, s = math.cos(a), math.sin(a)
        r = half / (c ** 4 + s ** 4) ** 0.25
        return cx + r * c, cy + r * s
    contour(p, at, chords(at, 0.0, 2 * math.pi)[:-1], z)


def pocket(p, cx, cy, half, corner, z):
    """A rounded rectangle: long straight sides, four corners."""
    def at(u):
        side, v = int(u) % 4, u - int(u)
        straight, quarter = 2 * (half - corner), corner * math.pi / 2
        s = v * (straight + quarter)
        if s < straight:
            a, b = half, -half + corner + s
        else:
            w = (s - straight) / corner
            a, b = half - corner + corner * math.cos(w), half - corner + corner * math.sin(w)
        for _ in range(side):
            a, b = -b, a
        return cx + a, cy + b
    us = sorted({side + v for side in range(4) for v in chords(lambda w: at(side + w * 0.999999), 0.0, 1.0)[:-1]})
    contour(p, at, us, z)


def main(folder):
    p = Program("G18")
    scan_rows(p, 40, 0.0, 90.0, 0.8)
    p.write(f"{folder}/scan.nc")

    for name in ("mixed", "pockets"):
        p = Program("G18")
        scan_rows(p, 15, 0.0, 90.0, 2.0)
        p.lines.append("G17")
        for level in range(15):
            ring(p, 45, 70, 22 - 0.7 * level, -0.8 * level)
            if name == "mixed":
                cushion(p, 45, 130, 20 - 0.5 * level, -0.8 * level)
            else:
                pocket(p, 45, 130, 20 - 0.5 * level, 6 - 0.2 * level, -0.8 * level)
        p.write(f"{folder}/{name}.nc")

    p = Program("G17")
    for level in range(40):
        t = level / 39
        ring(p, 0, 0, 6 + 24 * math.sqrt(1 - (1 - t) ** 2), -30 * t * 0.5, wave=1.2 * t if level % 2 else 0.0)
    p.write(f"{folder}/contour.nc")


if __name__ == "__main__":
    main(sys.argv[1])
