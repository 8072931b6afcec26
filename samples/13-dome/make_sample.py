#!/usr/bin/env python3
"""Makes the programs of this sample, for the table-table machine beside it (A about X, C about Z on it).

A dome of 8 mm radius on the end of a bar of 8 mm is finished by a long ball of 3 mm radius in a spiral from near the
top down. The tool leans 10 degrees ahead of the surface normal, so that its tip, which has no cutting speed, stays off
the surface, and 30 degrees aside, down the dome. The top of the dome is the program's zero.

dome.nc: under tool-centre-point control (G43.4): X Y Z is the tip on the part.
dome_axes.nc: the same path without it, as a post-processor writes it that knows the machine: X Y Z are the linear axes,
and G93 gives the time of each block. Needs nothing but Python 3.
"""
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
DOME, BALL, LEAD, TILT = 8.0, 3.0, math.radians(10), math.radians(30)
TOP, BOTTOM, ROW = math.radians(12), math.radians(36), 0.25
CHORD = 0.001  # of the contact, off the dome
LIFT = 0.3  # of the tool where it comes in; in the first sixth of a turn it sinks onto the dome
FEED = 1200.0
ZERO = (0.0, 0.0, -300.0)  # G54
PIVOT = (0.0, -360.0)      # Y, Z of the axis of A
START = ["G21 G17 G40 G49 G80 G90 G94", "G10 L2 P1 X0. Y0. Z-300.", "G10 L10 P1 R120.", "T1 M6"]


def write(name, lines):
    with open(os.path.join(HERE, name), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


def angles(axis, near):
    """A and C that put the tool along the axis; C the winding next to `near`. The tool's axis is
    (sin A sin C, -sin A cos C, cos A)."""
    a = math.degrees(math.acos(max(-1.0, min(1.0, axis[2]))))
    c = math.degrees(math.atan2(axis[0], -axis[1]))
    return a, c + 360 * round((near - c) / 360)


def linear_axes(tip, a, c):
    """X Y Z without tool-centre-point control that put the tip there: where the table takes this place of the part."""
    x, y, z = (t + o for t, o in zip(tip, ZERO))
    c, a = math.radians(-c), math.radians(-a)
    x, y = x * math.cos(c) - y * math.sin(c), x * math.sin(c) + y * math.cos(c)
    y, z = y - PIVOT[0], z - PIVOT[1]
    y, z = y * math.cos(a) - z * math.sin(a), y * math.sin(a) + z * math.cos(a)
    return x - ZERO[0], y + PIVOT[0] - ZERO[1], z + PIVOT[1] - ZERO[2]


def dome_point(polar, turn):
    """Tip and tool axis at a contact of the dome."""
    lift = LIFT * max(0.0, 1 + 3 * turn / math.pi)
    sp, cp, st, ct = math.sin(polar), math.cos(polar), math.sin(turn), math.cos(turn)
    normal = (sp * ct, sp * st, cp)
    ahead, down = (st, -ct, 0.0), (cp * ct, cp * st, -sp)
    axis = [n + math.tan(LEAD) * t + math.tan(TILT) * d for n, t, d in zip(normal, ahead, down)]
    axis = [a / math.hypot(*axis) for a in axis]
    tip = [(DOME + BALL + lift) * n - BALL * k for n, k in zip(normal, axis)]
    tip[2] -= DOME
    return tip, axis


def spiral():
    """(tip, axis, A, C) of every block's end: a constant distance between the rows."""
    out, polar, turn, near = [], TOP, 0.0, 0.0
    while polar < BOTTOM:
        tip, axis = dome_point(polar, turn)
        a, near = angles(axis, near)
        out.append((tip, axis, round(a, 3), round(near, 3)))
        step = math.sqrt(8 * CHORD / (DOME * math.sin(polar)))
        turn -= step
        polar += ROW / DOME * step / (2 * math.pi)
    return out


def away(point, height):
    return [t + height * k for t, k in zip(point[0], point[1])]


def dome(points):
    lines = ["%", "O1301 (CAMBER SAMPLE 13 - DOME, TOOL CENTRE POINT CONTROL)"] + START
    lines += ["G54 G0 X0. Y0. Z150. S9000 M3", "A%.3f C%.3f" % points[0][2:],
              "G43.4 H1 X%.4f Y%.4f Z%.4f" % tuple(away(points[0], 10))]
    for i, (tip, axis, a, c) in enumerate(points):
        code, feed = ("G1 ", " F500") if i == 0 else ("", " F%g" % FEED if i == 1 else "")
        lines.append(code + "X%.4f Y%.4f Z%.4f A%.3f C%.3f" % (*tip, a, c) + feed)
    lines += ["G0 X%.4f Y%.4f Z%.4f" % tuple(away(points[-1], 10)), "G49", "G53 Z0", "G28 A0. C0.", "M5", "M30", "%"]
    write("dome.nc", lines)


def dome_axes(points):
    lines = ["%", "O1302 (CAMBER SAMPLE 13 - DOME, POSITIONS OF THE AXES)"] + START
    a, c = points[0][2:]
    lines += ["G54 G0 X0. Y0. Z150. S9000 M3", "A%.3f C%.3f" % (a, c),
              "G43 H1 X%.4f Y%.4f Z%.4f" % linear_axes(away(points[0], 10), a, c), "G93"]
    last = away(points[0], 10)
    for i, (tip, axis, a, c) in enumerate(points):
        feed = 500.0 if i == 0 else FEED
        lines.append(("G1 " if i == 0 else "") + "X%.4f Y%.4f Z%.4f A%.3f C%.3f" % (*linear_axes(tip, a, c), a, c) +
                     " F%.3f" % (feed / math.dist(tip, last)))
        last = tip
    up = linear_axes(away(points[-1], 10), *points[-1][2:])
    lines += ["G94", "G0 X%.4f Y%.4f Z%.4f" % up, "G49", "G53 Z0", "G28 A0. C0.", "M5", "M30", "%"]
    write("dome_axes.nc", lines)


POINTS = spiral()
dome(POINTS)
dome_axes(POINTS)
