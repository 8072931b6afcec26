#!/usr/bin/env python3
"""Makes tap_x.csv, tap_y.csv and shoulder.nc: synthetic tap tests at the tip of the tool of job.toml, with noise, and a shoulder
in three passes. Run in this folder."""
import cmath
import random

# (frequency, Hz; damping ratio; stiffness, N/um)
MODES = {"x": [(1180.0, 0.028, 9.5), (2450.0, 0.021, 31.0)], "y": [(1235.0, 0.031, 9.1), (2510.0, 0.022, 33.0)]}


def receptance(modes, hz):
    """m/N."""
    return sum(1 / (k * 1e6 * (1 - (hz / f) ** 2 + 2j * zeta * hz / f)) for f, zeta, k in modes)


def write_tap(axis, modes):
    noise = random.Random(axis)
    peak = max(abs(receptance(modes, hz)) for hz in range(200, 4001, 4))
    with open(f"tap_{axis}.csv", "w", encoding="utf8") as file:
        file.write("frequency_Hz,re_m_per_N,im_m_per_N\n")
        for hz in range(200, 4001, 4):
            h = receptance(modes, hz)
            h += complex(noise.gauss(0, 1), noise.gauss(0, 1)) * (0.01 * abs(h) + 0.003 * peak)
            file.write(f"{hz},{h.real:.5e},{h.imag:.5e}\n")


def write_program():
    rows = ["(shoulder 4 mm wide, three passes)", "G21 G90 G54", "T1 M6", "S9000 M3", "G0 X-8. Y-2. Z5."]
    for depth in (2, 3, 4):
        rows += ["G0 X-8. Y-2.", f"G0 Z-{depth}.", "G1 X32. F2160", "G0 Z5."]
    with open("shoulder.nc", "w", encoding="utf8") as file:
        file.write("\n".join(rows + ["M30"]) + "\n")


for name, its in MODES.items():
    write_tap(name, its)
write_program()
