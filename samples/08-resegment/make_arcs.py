#!/usr/bin/env python3
"""Rows over a wave as a CAM system with an arc filter writes them: tangent arcs in G18, most of them shorter than the
control likes.

    samples/08-resegment/make_arcs.py > arcs.nc

41 rows of 60 mm, 0.3 mm apart; arcs of 0.07 to 0.4 mm through three points of the curve, lines where it is straight.
"""
import math


def height(x, y):
    return 3 * math.sin(x / 5 + 0.2 * y)


def places(y):
    out, k = [0.0], 0
    while out[-1] < 60:
        step = (0.11, 0.23, 0.07, 0.31, 0.19, 0.26, 0.13)[k % 7] * (1 + 0.3 * math.sin(0.37 * k + 0.8 * y))
        out.append(min(60.0, out[-1] + step))
        k += 1
    return out


def centre(a, b, c):
    """Of the circle through three points; None where they lie in a line."""
    u, v = (b[0] - a[0], b[1] - a[1]), (c[0] - a[0], c[1] - a[1])
    twice = 2 * (u[0] * v[1] - u[1] * v[0])
    if abs(twice) < 1e-5:
        return None
    uu, vv = u[0] ** 2 + u[1] ** 2, v[0] ** 2 + v[1] ** 2
    return (v[1] * uu - u[1] * vv) / twice, (u[0] * vv - v[0] * uu) / twice, twice


print("%\nO0008 (SHORT ARCS)\nG21 G18 G90 G40 G49 G80\nT1 M6 (BALL D6)\nS12000 M3\nG0 X0. Y0. Z20.\nF8000")
for row in range(41):
    y = 0.3 * row
    xs = places(y)
    points = [(round(x, 4), round(height(x, y), 4)) for x in (xs if row % 2 == 0 else reversed(xs))]
    print(f"G1 X{points[0][0]:.4f} Y{y:.3f} Z{points[0][1]:.4f}")
    for a, c in zip(points, points[1:]):
        x = 0.5 * (a[0] + c[0])
        found = centre(a, (x, height(x, y)), c)
        if found is None or math.hypot(found[0], found[1]) > 300:
            print(f"G1 X{c[0]:.4f} Z{c[1]:.4f}")
        else:  # G18 is seen from +Y, where X comes behind Z: what turns left in X Z is G2
            print(f"{'G2' if found[2] > 0 else 'G3'} X{c[0]:.4f} Z{c[1]:.4f} I{found[0]:.4f} K{found[1]:.4f}")
print("G17\nG0 Z20.\nM5\nM30\n%")
