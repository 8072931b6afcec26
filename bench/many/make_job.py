#!/usr/bin/env python3
"""bench/many/make_job.py FOLDER [ROWS [VOXEL_MM [COUPLING]]]: a raster of a ball over a block, some thousand tooth passings:
job.toml, machine.toml, raster.nc."""
import pathlib
import sys

import raster_job

folder = pathlib.Path(sys.argv[1])
rows = int(sys.argv[2]) if len(sys.argv) > 2 else 12
voxel_mm = float(sys.argv[3]) if len(sys.argv) > 3 else 0.4
coupling = sys.argv[4] if len(sys.argv) > 4 else "rigid"
folder.mkdir(parents=True, exist_ok=True)
step, length = 0.7, 20.0
lines = ["G21 G90 G17 G40 G49 G80 G54", "T1 M6", "S6000 M3", "G0 X-4 Y0 Z5"]
for row in range(rows):
    lines += ["G0 X-4 Y%.2f" % (step * row), "G0 Z-1", "G1 X%.1f F300" % (length + 4), "G0 Z5"]
(folder / "raster.nc").write_text("\n".join(lines + ["M30", ""]))
raster_job.write(folder, 4.0, "[[0, -2, -3], [%.1f, %.1f, 0]]" % (length, step * rows + 2), voxel_mm, coupling)
