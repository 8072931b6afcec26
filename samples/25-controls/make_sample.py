#!/usr/bin/env python3
"""Makes dome.H (Heidenhain) and dome.mpf (Sinumerik): one part for two controls, a flat dome roughed at a wide tolerance
of the path and finished at a narrow one, by a ball end mill. Run in this folder."""
import math

RADIUS, LENGTH, WIDTH, HEIGHT = 3.0, 24.0, 16.0, 2.0


def tip(x, y, allowance):
    """Tip of the ball that touches the dome, raised by the allowance: the surface and its slopes are known."""
    def height(u, v):
        return -HEIGHT * ((u / (LENGTH / 2)) ** 2 + (v / (WIDTH / 2)) ** 2) / 2
    slope_x, slope_y = -HEIGHT * x / (LENGTH / 2) ** 2, -HEIGHT * y / (WIDTH / 2) ** 2
    normal = math.sqrt(1 + slope_x**2 + slope_y**2)
    ball = RADIUS + allowance
    return (x - ball * slope_x / normal, y - ball * slope_y / normal, height(x, y) + ball / normal - RADIUS)


def rows(step, row, allowance):
    y, forward = -WIDTH / 2, True
    while y < WIDTH / 2 + 1e-9:
        count = round(LENGTH / step)
        line = [tip(-LENGTH / 2 + i * step, y, allowance) for i in range(count + 1)]
        yield line if forward else line[::-1]
        y, forward = y + row, not forward


class Klartext:
    def __init__(self):
        self.lines = ["BEGIN PGM DOME MM", "BLK FORM 0.1 Z X-12 Y-8 Z-8", "BLK FORM 0.2 X+12 Y+8 Z+1",
                      "TOOL CALL 1 Z S12000", "M3"]

    def tolerance(self, mm, rough):
        self.lines += ["CYCL DEF 32.0 TOLERANCE", f"CYCL DEF 32.1 T{mm}", f"CYCL DEF 32.2 HSC-MODE:{int(rough)} TA0.5"]

    def go(self, point, feed):
        self.lines.append("L " + " ".join(f"{a}{v + 0.0:+.3f}" for a, v in zip("XYZ", point)) + feed)

    def rapid(self, point):
        self.go(point, " R0 FMAX")

    def feed(self, point, feed=None):
        self.go(point, f" F{feed}" if feed else "")

    def retract(self):
        self.lines.append("L Z+20 R0 FMAX")

    def text(self):
        lines = self.lines + ["M30", "END PGM DOME MM"]
        return "".join(f"{i} {line}\n" for i, line in enumerate(lines))


class Siemens:
    def __init__(self):
        self.lines = ["; dome", 'WORKPIECE(,"",,"BOX",112,1,-8,-80,-12,-8,12,8)', "G17 G90 G94 G710 G40 G64", "T1", "M6",
                      "S12000 M3", "G54"]

    def tolerance(self, mm, rough):
        self.lines.append(f"CYCLE832({mm},{3 if rough else 1},1)")

    def go(self, code, point, feed):
        self.lines.append(f"{code} " + " ".join(f"{a}{v + 0.0:.3f}" for a, v in zip("XYZ", point)) + feed)

    def rapid(self, point):
        self.go("G0", point, "")

    def feed(self, point, feed=None):
        self.go("G1", point, f" F{feed}" if feed else "")

    def retract(self):
        self.lines.append("G0 Z20")

    def text(self):
        lines = self.lines + ["CYCLE832()", "M30"]
        return "".join(f"N{10 * (i + 1)} {line}\n" for i, line in enumerate(lines))


def write(program, name):
    for mm, rough, step, row, allowance, feed in ((0.1, True, 1.0, 2.0, 0.3, 4000), (0.01, False, 0.5, 0.5, 0, 4000)):
        program.tolerance(mm, rough)
        first = True
        for line in rows(step, row, allowance):
            if first:
                program.rapid((line[0][0], line[0][1], 5))
                program.feed(line[0], 1000)
                line, first = line[1:], False
                program.feed(line[0], feed)
                line = line[1:]
            for point in line:
                program.feed(point)
        program.retract()
    with open(name, "w", encoding="utf8") as file:
        file.write(program.text())


write(Klartext(), "dome.H")
write(Siemens(), "dome.mpf")
