#!/usr/bin/env python3
"""bench/many/make_big_job.py FOLDER [ROWS]: a raster of 1000 blocks of 0.5 mm in each of ROWS (1000) rows over a stock of
500 x 500 x 100 mm at 0.2 mm: a tenth of a program of 10^7 blocks. For the memory of a section (docs/many-machines.md):

    /usr/bin/time -v camber predict FOLDER/job.toml -o FOLDER/out --sections 16 --section 1 --stage sweep
"""
import math
import pathlib
import sys

folder = pathlib.Path(sys.argv[1])
rows = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
folder.mkdir(parents=True, exist_ok=True)
with open(folder / "raster.nc", "w") as out:
    out.write("G21 G90 G17 G40 G49 G80 G54\nT1 M6\nS6000 M3\nG0 X0 Y0 Z5\n")
    for row in range(rows):
        y, ways = 0.5 * row, range(1001) if row % 2 == 0 else range(1000, -1, -1)
        for n, i in enumerate(ways):
            z = -1 - 0.5 * math.sin(i / 40) * math.cos(y / 20)
            out.write("%sX%.1f Y%.1f Z%.3f%s\n" % ("" if n else "G1 ", 0.5 * i, y, z, "" if n else " F1200"))
    out.write("G0 Z5\nM30\n")
(folder / "machine.toml").write_text("".join("[axis.%s]\nacceleration_mm_per_s2 = 3000\n" % axis for axis in "xyz") +
                                     "[control]\ncorner = { law = \"blend\", tolerance_mm = 0.01 }\n"
                                     "[spindle]\nmax_rpm = 12000\n")
(folder / "job.toml").write_text("""program = "raster.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = 6.0
flutes = 2
overhang_mm = 25.0
[material]
ktc_MPa = 800.0
krc_MPa = 250.0
kte_N_per_mm = 5.0
kre_N_per_mm = 5.0
[stock]
box_mm = [[0, 0, -100], [500, 500, 0]]
[simulation]
voxel_mm = 0.2
coupling = "rigid"
""")
