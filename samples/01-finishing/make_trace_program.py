#!/usr/bin/env python3
"""Makes trace_program.nc: what a control is traced on so that the fitted machine covers finish.nc and its kind.

Rapids of each axis; rows of chords from 1 mm down to 0.1 mm over a wave, behind a plunge, as finish.nc has them; polygons
whose corners turn by 10 to 120 degrees and reversals, in three planes; circles, helices and rounded rectangles. Every
part starts from rest at X0 Y0 Z0. Same file every time; needs nothing but Python 3.

README.md has the command that recorded trace.csv.
"""
import math
import os

PLANES = {"G17": "XY", "G18": "ZX", "G19": "YZ"}
CENTRES = {"X": "I", "Y": "J", "Z": "K"}
out = ["(rapids, rows of chords, polygons, reversals, arcs)",
       "(what finish.nc asks of a control, and more)",
       "G17 G21 G90 G94 G40 G49 G80 G64 P0.01"]


def number(value):
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def word(**axes):
    return " ".join(f"{axis.upper()}{number(value)}" for axis, value in axes.items())


def rest(what):
    out.extend(["G0 Z0", "G0 X0 Y0", "G4 P0.2", f"({what})"])


def rapids():
    rest("rapids")
    for axis, way in (("X", 30.0), ("Y", 30.0), ("Z", 35.0)):
        out.extend([f"G0 {axis}{number(way)}", "G4 P0.1", f"G0 {axis}0", "G4 P0.1"])


def rows(axis, chord, feed, length=6.0):
    """There and back one step aside, each row behind a rapid and a plunge, over a wave of Z."""
    rest(f"rows along {axis}, chords of {number(chord)}, F{feed}")
    beside = "Y" if axis == "X" else "X"
    for row, sense in ((0, 1), (1, -1)):
        start = 0 if sense > 0 else length
        out.extend(["G0 Z3", f"G0 {axis}{number(start)} {beside}{number(0.18 * row)}", "G0 Z1", "G1 Z0 F300"])
        steps = round(length / chord)
        for i in range(1, steps + 1):
            along = start + sense * chord * i
            z = 0.6 * math.sin(2 * math.pi * along / 6) + 0.12 * along
            out.append(f"G1 {axis}{number(along)} Z{number(z)}" + (f" F{feed}" if i == 1 else ""))


def polygons(plane, feed, side):
    """Corners of 10, 20, 30, 60, 90 and 120 degrees, left and right, then there and back."""
    rest(f"corners in {plane}, sides of {number(side)}, F{feed}")
    first, second = PLANES[plane]
    u = v = heading = 0.0
    corners = [10, 20, 30, 60, 90, 120]
    turns = [0] + corners + [-c for c in corners] + [180, 180]
    for k, turn in enumerate(turns):
        heading += math.radians(turn)
        u, v = u + side * math.cos(heading), v + side * math.sin(heading)
        out.append(f"G1 {first}{number(u)} {second}{number(v)}" + (f" F{feed}" if k == 0 else ""))


def circles(plane, radius, turns, feed):
    rest(f"circle in {plane}, radius {number(radius)}, F{feed}")
    axis = PLANES[plane][0]
    out.append(f"{plane} G3 {axis}0 {CENTRES[axis]}{number(radius)} P{turns} F{feed}")
    out.append("G17")


def helix(radius, depth, turns, feed):
    rest(f"helix, radius {number(radius)}, F{feed}")
    out.append(f"G2 X0 Y0 Z{number(-depth)} I{number(radius)} P{turns} F{feed}")


def rounded_rectangle(r, feed, x=24.0, y=12.0):
    rest(f"rounded rectangle, radius {number(r)}, F{feed}")
    out.extend([f"G0 X{number(r)}", f"G1 X{number(x - r)} F{feed}", f"G3 X{number(x)} Y{number(r)} J{number(r)}",
                f"G1 Y{number(y - r)}", f"G3 X{number(x - r)} Y{number(y)} I{number(-r)}", f"G1 X{number(r)}",
                f"G3 X0 Y{number(y - r)} J{number(-r)}", f"G1 Y{number(r)}", f"G3 X{number(r)} Y0 I{number(r)}"])


rapids()
for chord, feed in ((1.0, 900), (0.5, 900), (0.2, 900), (0.1, 900), (0.2, 2400)):
    rows("X", chord, feed)
for chord, feed in ((0.2, 900), (1.0, 2400)):
    rows("Y", chord, feed)
for plane in PLANES:
    polygons(plane, 900, 1.0)
    polygons(plane, 3000, 3.0)
circles("G17", 2, 2, 2000)
circles("G17", 2, 2, 4000)
circles("G18", 2, 2, 6000)
circles("G19", 0.5, 2, 4000)
circles("G19", 5, 1, 4000)
helix(1, 1.5, 3, 6000)
helix(5, 1.5, 3, 6000)
for r in (0.5, 1.0):
    for feed in (3000, 6000):
        rounded_rectangle(r, feed)
out.extend(["G4 P0.2", "M2"])
path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "trace_program.nc")
with open(path, "w") as f:
    f.write("\n".join(out) + "\n")
print(path, len(out), "lines")
