#!/usr/bin/env python3
"""Cuts trace.csv and trace_program.nc out of a servo trace and its program.

    cut_trace.py arcs_g64.ngc arcs_g64_a.csv FIRST-LAST [FIRST-LAST ...]

The files here were made with

    cut_trace.py arcs_g64.ngc arcs_g64_a.csv 49-51 52-54 151-153 169-171 208-210 244-246 262-264 302-304 320-322 341-407

Each FIRST-LAST is a range of lines of the program that begins where the range before it ended (here: at rest at
X0 Y0 Z0, after a dwell). The three header lines and the first positioning are kept. The ranges' blocks become
trace_program.nc; the samples in which they were commanded, with the rest that follows each range, become trace.csv:
the time is closed up, and `line` counts the lines of trace_program.nc. The plane that
holds at the start of a range is restored where its first block does not name one. Nothing else is changed.
"""
import re
import sys

PERIOD_S = 0.001
TAIL = 205  # samples of rest that follow a range (its dwell)

program = open(sys.argv[1]).read().splitlines()
header, *rows = open(sys.argv[2]).read().splitlines()
ranges = [tuple(map(int, a.split("-"))) for a in sys.argv[3:]]
lines = [int(r.rsplit(",", 1)[1]) for r in rows]

new_program = program[:3] + ["G0 X0 Y0 Z0", "G4 P0.2"]
new_rows = rows[:200]
out_rows = [r.split(",", 1)[1] for r in new_rows]
for first, last in ranges:
    if not re.match(r"G1[789]", program[first - 1]):  # the plane that holds there, in a block of its own
        new_program.append(re.findall(r"\bG1[789]\b", "\n".join(program[:first - 1]))[-1])
    shift = len(new_program) + 1 - first
    new_program += program[first - 1:last]
    begin = next(i for i, l in enumerate(lines) if first <= l <= last)
    end = max(i for i, l in enumerate(lines) if first <= l <= last) + 1
    for i in range(begin, min(end + TAIL, len(rows))):
        if i >= end and lines[i] != 0:
            break
        body, line = rows[i].split(",", 1)[1].rsplit(",", 1)
        out_rows.append(f"{body},{int(line) + shift if int(line) else 0}")
    if not program[last - 1].startswith("G4"):
        new_program.append("G4 P0.2")
new_program.append("M2")
open("trace_program.nc", "w").write("\n".join(new_program) + "\n")
with open("trace.csv", "w") as f:
    f.write(header + "\n")
    for k, row in enumerate(out_rows):
        f.write(f"{k * PERIOD_S:.3f},{row}\n")
print(len(out_rows), "samples,", len(new_program), "lines")
