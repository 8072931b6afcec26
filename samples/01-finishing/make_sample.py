#!/usr/bin/env python3
"""Makes finish.nc, to_and_fro.nc and part.stl of this sample. Same files every time; needs nothing but Python 3.

The part is a block of 10 x 7 mm. Its top is made of two curved faces that meet in a sharp ridge, a "character
line" as car bodies have it. With d = y - ridge_y(x), mm:

    lower face, d < 0 (convex):   z = crown(x) + 0.95 d - 0.02 d^2     slope 44 to 48 degrees, rising with y
    upper face, d > 0 (concave):  z = crown(x) - 0.70 d + 0.03 d^2     slope 35 to 28 degrees, falling with y

The cutter's path is the exact offset of that surface: rows along X at a constant y of the ball's centre. The
centre lies R along the normal from a point of either face, or on a sphere of radius R about a point of the ridge.
"""
import math
import os
import struct

RADIUS = 3.0
SIZE_X, SIZE_Y, BOTTOM_Z = 10.0, 7.0, -8.0
ROW_STEP = 0.18                 # of the centre; 0.21 to 0.27 along the faces
FIRST_ROW_Y, LAST_ROW_Y = -2.5, 8.3
ROW_FROM_X, ROW_TO_X = 11.5, -1.5
CHORD_TOLERANCE = 0.002
SHORTEST, LONGEST = 0.2, 1.0    # block lengths in X
CLEARANCE_Z, RETRACT_Z = 20.0, 3.0
FEED, PLUNGE_FEED, SPINDLE = 900, 300, 3000


# ---- the surface -------------------------------------------------------------------------------------------------

def crown(x):
    return -0.003 * (x - 5) ** 2


def crown_slope(x):
    return -0.006 * (x - 5)


def ridge_y(x):
    return 3.2 + 0.2 * x - 0.004 * x * x


def ridge_y_slope(x):
    return 0.2 - 0.008 * x


LOWER = (0.95, -0.02)
UPPER = (-0.70, 0.03)


def height(face, x, y):
    d = y - ridge_y(x)
    return crown(x) + face[0] * d + face[1] * d * d


def gradient(face, x, y):
    along_d = face[0] + 2 * face[1] * (y - ridge_y(x))
    return crown_slope(x) - along_d * ridge_y_slope(x), along_d


def surface(x, y):
    return height(LOWER if y < ridge_y(x) else UPPER, x, y)


# ---- the ball's centre -------------------------------------------------------------------------------------------

def solve(residual, guess):
    """Newton with a difference quotient, for one or two unknowns."""
    p = list(guess)
    n = len(p)
    for _ in range(60):
        r = residual(p)
        if max(abs(v) for v in r) < 1e-13:
            return p
        columns = []
        for i in range(n):
            q = list(p)
            q[i] += 1e-7
            columns.append([(a - b) / 1e-7 for a, b in zip(residual(q), r)])
        if n == 1:
            step = [r[0] / columns[0][0]]
        else:
            (a, c), (b, d) = columns
            det = a * d - b * c
            step = [(d * r[0] - b * r[1]) / det, (a * r[1] - c * r[0]) / det]
        p = [v - s for v, s in zip(p, step)]
    if max(abs(v) for v in residual(p)) > 1e-9:
        raise ArithmeticError("no contact point found")
    return p


def contact_on(face, cx, cy):
    """Point (u, v) of the face whose normal leads to a centre above (cx, cy), and the centre's height."""
    def residual(p):
        gx, gy = gradient(face, *p)
        length = math.sqrt(1 + gx * gx + gy * gy)
        return [p[0] - RADIUS * gx / length - cx, p[1] - RADIUS * gy / length - cy]

    u, v = solve(residual, (cx, cy))
    gx, gy = gradient(face, u, v)
    return u, v, height(face, u, v) + RADIUS / math.sqrt(1 + gx * gx + gy * gy)


def contact_on_ridge(cx, cy):
    """Centre's height when the ball rests on the ridge: the highest over the ridge's points."""
    def up(u):
        return math.sqrt(RADIUS ** 2 - (cx - u) ** 2 - (cy - ridge_y(u)) ** 2)

    def residual(p):
        u = p[0]
        return [crown_slope(u) * up(u) + (cx - u) + (cy - ridge_y(u)) * ridge_y_slope(u)]

    u = solve(residual, (cx,))[0]
    return crown(u) + up(u)


def centre_height(cx, cy):
    u, v, z = contact_on(LOWER, cx, cy)
    if v <= ridge_y(u):
        return z
    u, v, z = contact_on(UPPER, cx, cy)
    if v >= ridge_y(u):
        return z
    return contact_on_ridge(cx, cy)


def tip_height(cx, cy):
    return centre_height(cx, cy) - RADIUS


# ---- the program -------------------------------------------------------------------------------------------------

def chord_error(y, x0, x1):
    """Largest height between the path and its chord, at some points between."""
    z0, z1 = tip_height(x0, y), tip_height(x1, y)
    worst = 0.0
    for i in range(1, 8):
        u = i / 8
        worst = max(worst, abs(tip_height(x0 + u * (x1 - x0), y) - (z0 + u * (z1 - z0))))
    return worst


def row_points(y):
    """From ROW_FROM_X towards -X, blocks as long as the tolerance allows, in steps of 0.05 mm."""
    points = [(ROW_FROM_X, tip_height(ROW_FROM_X, y))]
    x = ROW_FROM_X
    while x > ROW_TO_X + 1e-9:
        length = LONGEST
        while length > SHORTEST + 1e-9 and chord_error(y, x, x - length) > CHORD_TOLERANCE:
            length -= 0.05
        left = x - ROW_TO_X
        if left < length + SHORTEST:  # no crumb at the end of the row
            length = left if left <= length else left / 2
        x = round(x - length, 3)
        points.append((x, tip_height(x, y)))
    return points


def number(value):
    """As CAM systems write it: three decimals, no trailing zeros, a point always."""
    text = "%.3f" % value
    text = text.rstrip("0")
    return "0." if text in ("-0.", "0.") else text


def opening():
    return ["T1 M6", "G0 G90 G54 X%s Y%s S%d M3" % (number(ROW_FROM_X), number(FIRST_ROW_Y), SPINDLE),
            "G43 H1 Z%s" % number(CLEARANCE_Z), "M8"]


def rows():
    """Number and Y of each row."""
    count = int(round((LAST_ROW_Y - FIRST_ROW_Y) / ROW_STEP)) + 1
    return [(row, FIRST_ROW_Y + row * ROW_STEP) for row in range(count)]


def closing():
    return ["G0 Z%s" % number(CLEARANCE_Z), "M9", "M5", "G91 G28 Z0.", "G90", "M30", "%"]


def program():
    lines = [
        "%",
        "O0101 (CAMBER SAMPLE 01 - FINISHING)",
        "(MATERIAL - S55C)",
        "(OPERATION - RASTER FINISHING, ONE WAY, ROWS %s MM)" % number(ROW_STEP),
        "(T1 | 6. BALL END MILL HSS | 2 FLUTES | R3. | H1 | STOCK TO LEAVE - 0.)",
        "(CHORD TOLERANCE - %s)" % number(CHORD_TOLERANCE),
        "G21",
        "G0 G17 G40 G49 G80 G90",
    ] + opening()
    for row, y in rows():
        points = row_points(y)
        lines.append("(ROW %d)" % (row + 1))
        if row:
            lines.append("G0 X%s Y%s" % (number(ROW_FROM_X), number(y)))
        lines.append("G0 Z%s" % number(points[0][1] + 1))
        lines.append("G1 Z%s F%d" % (number(points[0][1]), PLUNGE_FEED))
        last = number(points[0][1])
        for i, (x, z) in enumerate(points[1:]):
            word = "X" + number(x)
            if number(z) != last:
                word += " Z" + number(z)
                last = number(z)
            lines.append(("G1 " if i == 0 else "") + word + (" F%d" % FEED if i == 0 else ""))
        lines.append("G0 Z%s" % number(RETRACT_Z))
    lines += closing()
    return "\n".join(lines) + "\n"


def raster_program():
    """The same rows to and fro, joined by lines, with corners that the control rounds by 0.01 mm."""
    lines = [
        "%",
        "O0102 (CAMBER SAMPLE 01 - FINISHING, TO AND FRO)",
        "G21",
        "G0 G17 G40 G49 G80 G90 G64 P0.01",
    ] + opening()
    for row, y in rows():
        points = row_points(y)[::-1 if row % 2 else 1]
        start = number(points[0][1])
        if row:
            lines.append("Y%s Z%s" % (number(y), start))
        else:
            lines += ["G0 Z%s" % number(points[0][1] + 1), "G1 Z%s F%d" % (start, PLUNGE_FEED)]
        for i, (x, z) in enumerate(points[1:]):
            first = row == 0 and i == 0
            lines.append("X%s Z%s%s" % (number(x), number(z), " F%d" % FEED if first else ""))
    lines += closing()
    return "\n".join(lines) + "\n"


# ---- the part ----------------------------------------------------------------------------------------------------

def part_triangles():
    """Closed: the top in columns of constant x with a row of vertices on the ridge, walls, bottom."""
    columns, rows = 80, 30  # rows to each side of the ridge
    def vertex(i, j):
        x = SIZE_X * i / columns
        r = ridge_y(x)
        y = r * j / rows if j <= rows else r + (SIZE_Y - r) * (j - rows) / rows
        return (x, y, crown(x) if j == rows else surface(x, y))

    def floor(p):
        return (p[0], p[1], BOTTOM_Z)

    top = [[vertex(i, j) for j in range(2 * rows + 1)] for i in range(columns + 1)]
    out = []

    def quad(a, b, c, d):
        out.append((a, b, c))
        out.append((a, c, d))

    for i in range(columns):
        for j in range(2 * rows):
            quad(top[i][j], top[i + 1][j], top[i + 1][j + 1], top[i][j + 1])
            quad(floor(top[i][j]), floor(top[i][j + 1]), floor(top[i + 1][j + 1]), floor(top[i + 1][j]))
        for j, flip in ((0, False), (2 * rows, True)):
            a, b = top[i][j], top[i + 1][j]
            quad(*((floor(a), floor(b), b, a) if not flip else (floor(b), floor(a), a, b)))
    for i, flip in ((0, True), (columns, False)):
        for j in range(2 * rows):
            a, b = top[i][j], top[i][j + 1]
            quad(*((floor(a), floor(b), b, a) if not flip else (floor(b), floor(a), a, b)))
    return out


def stl_bytes(triangles):
    out = [b"Camber sample 01: two curved faces that meet in a ridge, mm".ljust(80, b" "),
           struct.pack("<I", len(triangles))]
    for a, b, c in triangles:
        u = [b[i] - a[i] for i in range(3)]
        v = [c[i] - a[i] for i in range(3)]
        n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        length = math.sqrt(sum(w * w for w in n)) or 1.0
        out.append(struct.pack("<12fH", *[w / length for w in n], *a, *b, *c, 0))
    return b"".join(out)


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, "finish.nc"), "w", newline="\n") as f:
        f.write(program())
    with open(os.path.join(here, "to_and_fro.nc"), "w", newline="\n") as f:
        f.write(raster_program())
    with open(os.path.join(here, "part.stl"), "wb") as f:
        f.write(stl_bytes(part_triangles()))


if __name__ == "__main__":
    main()
