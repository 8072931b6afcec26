#!/usr/bin/env python3
"""bench/many/make_big_job.py FOLDER [ROWS [BLOCKS]]: a raster of BLOCKS (1000) blocks in each of ROWS (1000) rows over a
stock of 500 x 500 x 100 mm at 0.2 mm: a tenth of a program of 10^7 blocks, which is 3162 3162. For the memory of a section
(docs/many-machines.md):

    /usr/bin/time -v camber predict FOLDER/job.toml -o FOLDER/out --sections 16 --section 1 --stage sweep
"""
import math
import pathlib
import sys

import raster_job


def number(mm):
    return ("%.3f" % mm).rstrip("0").rstrip(".")


folder = pathlib.Path(sys.argv[1])
rows = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
blocks = int(sys.argv[3]) if len(sys.argv) > 3 else 1000
folder.mkdir(parents=True, exist_ok=True)
with open(folder / "raster.nc", "w") as out:
    out.write("G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X0 Y0 Z5\n")
    for row in range(rows):
        y, ways = 500 / rows * row, range(blocks + 1) if row % 2 == 0 else range(blocks, -1, -1)
        for n, i in enumerate(ways):
            x = 500 / blocks * i
            z = -1 - 0.5 * math.sin(x / 20) * math.cos(y / 20)
            out.write("%sX%s Y%s Z%.3f%s\n" % ("" if n else "G1 ", number(x), number(y), z, "" if n else " F1200"))
    out.write("G0 Z5\nM30\n")
raster_job.write(folder, 6.0, "[[0, 0, -100], [500, 500, 0]]", 0.2, "rigid",
                 '[control]\ncorner = { law = "blend", tolerance_mm = 0.01 }\n')
