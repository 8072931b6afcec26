#!/usr/bin/env python3
"""Writes the programs of this sample: python3 make_sample.py

A plate with 48 pockets in eight tools, with 162 positionings, of which 116 (72 %) are shorter than the 71.4 mm that an
axis needs to reach 30 m/min with 3.5 m/s2: the histogram of figure 3.2 of Takata 1999. conventional.nc has a machine
part's usual cutting conditions at 12000 rpm; highspeed.nc is the same path with 3.5 times the feed at 25000 rpm.
"""
import math

TOOLS, POCKETS = 8, 6           # pockets for each tool
CHANGE_Z, CLEAR_Z = 135.0, 47.0
SHORT_HOPS = {3, 4}             # of the five hops between a tool's pockets


def pocket(x, y, z, size, feed):
    """Square passes with rounded corners, outward: straight blocks of 20 to 40 mm."""
    out = []
    for i in range(4):
        h, r = size * (0.55 + 0.15 * i), 2.0
        out += [f'G1 X{x - h:.3f} Y{y - h + r:.3f} F{feed:g}',
                f'Y{y + h - r:.3f}', f'G2 X{x - h + r:.3f} Y{y + h:.3f} R{r:g}',
                f'G1 X{x + h - r:.3f}', f'G2 X{x + h:.3f} Y{y + h - r:.3f} R{r:g}',
                f'G1 Y{y - h + r:.3f}', f'G2 X{x + h - r:.3f} Y{y - h:.3f} R{r:g}',
                f'G1 X{x - h + r:.3f}', f'G2 X{x - h:.3f} Y{y - h + r:.3f} R{r:g}']
    return out


def program(name, feed, speed):
    lines = ['%', f'O0002 ({name})', 'G21 G17 G40 G80 G90 G94']
    x, y = 400.0, 300.0
    for tool in range(TOOLS):
        lines += [f'T{tool + 1} M6', f'S{speed:g} M3', 'M8']
        for p in range(POCKETS):
            short = p in SHORT_HOPS or (p == 2 and tool < 2)
            if p == 0:
                x, y = 60.0 + 25.0 * tool, 80.0
            elif short:
                x, y = x + 44.0, y + 6.0
            else:
                x, y = (x + 190.0 if x < 200 else x - 170.0), y + 12.0
            depth = 26.0 + 2.0 * ((p + tool) % 3)
            lines.append(f'G0 X{x:.3f} Y{y:.3f}')
            if p == 0:
                lines.append(f'G0 Z{CLEAR_Z:g}')
            lines += [f'G0 Z{depth:g}', f'G1 Z{depth - 4:g} F{feed / 2:g}']
            lines += pocket(x, y, 0, 17.0, feed)
            lines += [f'G0 Z{CLEAR_Z:g}']
            x, y = x - 17.0, y - 15.0       # where the last pass ended
        lines += ['M9', f'G0 Z{CHANGE_Z:g}']
    lines += ['G0 X400.', 'G0 Y300.', 'M30', '%']
    with open(f'{name}.nc', 'w') as f:
        f.write('\n'.join(lines) + '\n')


program('conventional', 1226, 12000)
program('highspeed', 4291, 25000)
