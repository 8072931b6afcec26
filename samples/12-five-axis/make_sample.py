#!/usr/bin/env python3
"""Makes the programs of this sample, for the table-table machine beside it (A about X, C about Z on it).

dome.nc: ball finishing of a dome of 25 mm radius under tool-centre-point control (G43.4): a spiral from the top down,
the tool 10 degrees ahead of the surface normal. X Y Z is the tip of a ball of 3 mm radius on the part.
faces.nc: two faces of a block, tilted by 30 and 60 degrees: a face is milled and four holes are drilled in each, in
tilted frames (G68.2, G53.1). Needs nothing but Python 3.
"""
import math
import os

HERE = os.path.dirname(os.path.abspath(__file__))
DOME, BALL, LEAD = 25.0, 3.0, math.radians(10)
TOP, BOTTOM, TURNS, BLOCK = math.radians(15), math.radians(48), 5, 1.2
START = ["G21 G17 G40 G49 G80 G90 G94", "G10 L2 P1 X0. Y0. Z-320.", "G10 L10 P1 R120.", "T1 M6"]


def write(name, lines):
    with open(os.path.join(HERE, name), "w", newline="\n") as f:
        f.write("\n".join(lines) + "\n")


def angles(axis, near):
    """A and C that put the tool along the axis; C the winding next to `near`. The tool's axis is
    (sin A sin C, -sin A cos C, cos A)."""
    a = math.degrees(math.acos(max(-1.0, min(1.0, axis[2]))))
    c = math.degrees(math.atan2(axis[0], -axis[1]))
    return a, c + 360 * round((near - c) / 360)


def dome_point(polar, turn):
    """Tip and tool axis at a contact of the dome; its top is the origin."""
    sp, cp, st, ct = math.sin(polar), math.cos(polar), math.sin(turn), math.cos(turn)
    normal = (sp * ct, sp * st, cp)
    ahead = (-st, ct, 0.0)
    axis = [math.cos(LEAD) * n + math.sin(LEAD) * t for n, t in zip(normal, ahead)]
    centre = [(DOME + BALL) * n for n in normal]
    tip = [c - BALL * k for c, k in zip(centre, axis)]
    tip[2] -= DOME
    return tip, axis


def dome():
    lines = ["%", "O1101 (CAMBER SAMPLE 11 - DOME, TOOL CENTRE POINT CONTROL)"] + START
    lines += ["G54 G0 X0. Y0. Z150. S9000 M3", "M11", "M13"]
    turn, near = 0.0, 0.0
    first = True
    while turn <= 2 * math.pi * TURNS:
        polar = TOP + (BOTTOM - TOP) * turn / (2 * math.pi * TURNS)
        tip, axis = dome_point(polar, turn)
        a, c = angles(axis, near)
        near = c
        words = "X%.3f Y%.3f Z%.3f A%.3f C%.3f" % (*tip, a, c)
        if first:
            above = [t + 20 * k for t, k in zip(tip, axis)]
            lines += ["A%.3f C%.3f" % (a, c), "G43.4 H1 X%.3f Y%.3f Z%.3f" % tuple(above), "G1 %s F800" % words]
        else:
            lines.append(words + (" F1500" if len(lines) > 0 and "F800" in lines[-1] else ""))
        first = False
        turn += BLOCK / ((DOME + BALL) * math.sin(polar))
    up = [t + 20 * k for t, k in zip(tip, axis)]
    lines += ["G0 X%.3f Y%.3f Z%.3f" % tuple(up), "G49", "G53 Z0", "G28 A0. C0.", "M5", "M30", "%"]
    write("dome.nc", lines)


def face(tilt, turn, number):
    """A face whose Z leans by `tilt` towards the direction `turn`, degrees: Euler angles I = turn + 90, J = tilt."""
    reach = 30 * math.sin(math.radians(tilt))
    x, y = reach * math.cos(math.radians(turn)), reach * math.sin(math.radians(turn))
    z = -10 - 30 * (1 - math.cos(math.radians(tilt)))
    lines = ["(FACE %d)" % number, "M11", "M13",
             "G68.2 X%.3f Y%.3f Z%.3f I%.3f J%.3f K-90." % (x, y, z, turn + 90, tilt), "G53.1", "M10", "M12",
             "G43 H1", "G0 X-18. Y-18.", "Z20.", "G0 Z1.", "G1 Z0. F400"]
    for row in range(5):
        rows = -16 + 8 * row
        ends = (-18, 18) if row % 2 == 0 else (18, -18)
        lines += ["Y%.3f" % rows, "X%d. F1200" % ends[1]]
    lines += ["G0 Z20.", "G98 G81 X-10. Y-10. Z-8. R2. F200", "X10.", "Y10.", "X-10.", "G80", "G69", "G49", "G53 Z0"]
    return lines


def faces():
    lines = ["%", "O1102 (CAMBER SAMPLE 11 - TILTED FACES)"] + START + ["G54 G0 X0. Y0. S9000 M3", "G53 Z0"]
    lines += face(30, 20, 1) + face(60, 140, 2)
    lines += ["M11", "M13", "G28 A0. C0.", "M5", "M30", "%"]
    write("faces.nc", lines)


dome()
faces()
