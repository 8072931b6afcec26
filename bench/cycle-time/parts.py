"""Programs of the kind of Takata's three parts (figures 2.7, 2.9, 2.11), from the printed cutting conditions.

What is printed: tools, cutting speeds and feeds, plain and fast; how many positionings there are and how many of them are too
short for full rapid. The sites of each tool are chosen so that both counts come out. What a tool cuts at a site is not printed:
the shapes below are those of a part of that size, with these rules for all: end mills take half their diameter in depth and
three quarters of it in width, faces 0.7 diameters, holes the usual depths. One factor on all shapes of a part makes the cutting
time of case 1, one distance ("far", how far the head goes for a tool change) its positioning time.
"""
import math
from dataclasses import dataclass, field

NEAR_XY, NEAR_Z = 40.0, 20.0   # short positionings, mm
LONG_XY = 120.0                # long ones between sites


@dataclass
class Op:
    """Plain and fast: (cutting speed m/min, feed mm/min). Taps turn with a pitch, so their F is the printed one."""
    name: str
    diameter: float
    plain: tuple
    fast: tuple
    sites: int
    shape: callable
    fast_diameter: float = 0


@dataclass
class Part:
    name: str
    figure: str
    tools: list            # of lists of operations
    long_hops: int         # of those between sites
    spindle_apart: bool    # M3 and M5 in blocks of their own
    index_deg: float = 0   # the table turns so far before each tool
    positionings: tuple = ()
    extra: list = field(default_factory=list)


def zigzag(width, height, passes):
    """Rows along X and back to the start."""
    step = height / max(1, passes - 1)
    out = []
    for i in range(passes):
        out.append((width if i % 2 == 0 else 0.0, i * step))
        if i + 1 < passes:
            out.append((out[-1][0], (i + 1) * step))
    return out + [(0.0, 0.0)]


def pocket(width, height, depth, diameter):
    """Levels of half a diameter, rows three quarters apart."""
    levels = math.ceil(depth / (0.5 * diameter))
    rows = max(2, math.ceil(height / (0.75 * diameter)))
    return ('levels', levels, zigzag(width, height, rows))


def walls(width, height, depth, diameter):
    """A contour a level, and the floor once."""
    levels = math.ceil(depth / (0.5 * diameter))
    rows = max(2, math.ceil(height / (0.75 * diameter)))
    contour = [(width, 0.0), (width, height), (0.0, height), (0.0, 0.0)]
    return ('walls', levels, contour, zigzag(width, height, rows))


def face(width, height, diameter):
    return ('levels', 1, zigzag(width + 1.2 * diameter, height, max(1, math.ceil(height / (0.7 * diameter)))))


def contour(width, height, levels):
    return ('levels', levels, [(width, 0.0), (width, height), (0.0, height), (0.0, 0.0)])


def slot(length, levels):
    return ('levels', levels, [(length, 0.0), (0.0, 0.0)])


def ring(radius, turns):
    return ('ring', radius, turns)


def hole(depth):
    return ('hole', depth)


def tap(depth):
    return ('tap', depth)


AEROSPACE = Part('aerospace', '2.7', [
    [Op('face mill, rough', 80, (2000, 7200), (3770, 25000), 1, face(400, 275, 80))],
    [Op('face mill, finish', 100, (2000, 3200), (5000, 12000), 1, face(400, 275, 100))],
    [Op('drill', 8.5, (200, 2250), (534, 15000), 12, hole(33))],
    [Op('drill', 5, (190, 3600), (314, 10000), 12, hole(20))],
    [Op('tap M6', 6, (30, 1590), (75, 4000), 12, tap(15))],
    [Op('end mill, rough', 20, (500, 2800), (1571, 30000), 6, pocket(110, 115, 25, 20))],
    [Op('end mill, finish', 20, (500, 3000), (1571, 10000), 6, walls(110, 115, 25, 20))],
    [Op('end mill, groove', 10, (300, 1500), (471, 2250), 4, slot(200, 2))],
], long_hops=22, spindle_apart=True, positionings=(162, 116))

CAR = Part('car', '2.9', [
    [Op('face mill, rough', 80, (2010, 3200), (2512, 10000), 1, face(280, 110, 80)),
     Op('face mill, finish', 80, (2010, 1600), (3014, 5000), 0, face(280, 110, 80))],
    [Op('end mill, spot face', 20, (300, 240), (942, 3000), 4, hole(5)),
     Op('end mill, bore rough', 20, (300, 717), (942, 6000), 3, ring(16, 2)),
     Op('end mill, bore finish', 20, (300, 717), (942, 3000), 3, ring(16, 1))],
    [Op('boring bar', 52, (250, 153), (360, 150), 1, hole(40))],
    [Op('boring bar', 40, (250, 199), (314, 175), 1, hole(40))],
    [Op('boring bar', 60, (250, 133), (301, 112), 1, hole(40))],
    [Op('spot face', 15, (300, 64), (330, 750), 6, hole(3))],
    [Op('spot face', 14, (300, 68), (308, 700), 4, hole(3))],
    [Op('burnishing reamer', 14, (50, 57), (75, 265), 2, hole(20))],
    [Op('burnishing drill', 11, (50, 145), (80, 350), 2, hole(20))],
    [Op('drill', 6.8, (320, 1200), (288, 4500), 10, hole(22))],
    [Op('drill', 5, (190, 1200), (212, 3500), 8, hole(18))],
    [Op('chamfer, spot', 32, (300, 300), (854, 2400), 4, hole(3)),
     Op('chamfer, bore', 32, (300, 300), (854, 4000), 3, hole(3))],
    [Op('chamfer', 12, (200, 530), (38, 1200), 7, hole(3))],
    [Op('tap M8', 8, (60, 3000), (75, 3750), 10, tap(18))],
    [Op('tap M6', 6, (56, 3000), (56, 3000), 8, tap(15))],
], long_hops=8, spindle_apart=False, positionings=(234, 181))

MACHINE_TOOL = Part('machine tool', '2.11', [
    [Op('face mill, rough', 100, (195, 1303), (350, 2674), 1, face(200, 150, 100))],
    [Op('face mill, finish', 100, (253, 644), (400, 1019), 1, face(200, 150, 100))],
    [Op('insert drill', 38, (182, 241), (220, 332), 1, hole(75))],
    [Op('roughing end mill', 20, (28, 134), (28, 134), 2, slot(50, 1))],
    [Op('end mill', 20, (65, 362), (500, 7985), 2, contour(200, 150, 2))],
    [Op('chamfer', 32, (400, 1592), (400, 1592), 2, contour(200, 150, 1))],
    [Op('spot drill', 20, (25, 36), (300, 955), 7, hole(4))],
    [Op('drill', 8.7, (36, 302), (300, 716), 7, hole(30))],
    [Op('tap M10', 10, (13, 621), (40, 2195), 7, tap(20))],
], long_hops=0, spindle_apart=False, index_deg=90, positionings=(92, 64),
    extra=[f'G0 X{NEAR_XY:.3f} Y0.', 'G0 X400. Y300.'])

PARTS = {part.name.replace(' ', '-'): part for part in (AEROSPACE, CAR, MACHINE_TOOL)}


def speed_rpm(op, fast, most):
    cutting_speed = (op.fast if fast else op.plain)[0]
    return min(most, round(1000 * cutting_speed / (math.pi * op.diameter)))


def cut(shape, at, feed, scale):
    """Blocks of one site, from and back to `at` at the level R (0 of the part's face is 2 mm below)."""
    x, y = at

    def path(points):
        return [f'G1 X{x + scale * px:.3f} Y{y + scale * py:.3f}' for px, py in points]

    kind, *rest = shape
    if kind == 'hole':
        return [f'G1 Z{2 - scale * rest[0]:.3f} F{feed:g}']
    if kind == 'tap':
        return [f'G99 G84.2 X{x:.3f} Y{y:.3f} Z{2 - scale * rest[0]:.3f} R2. F{feed:g}', 'G80']
    if kind == 'ring':
        radius, turns = scale * rest[0], rest[1]
        return [f'G1 Z-2. F{feed:g}', f'G1 X{x + radius:.3f}'] + [f'G2 I{-radius:.3f} J0.'] * turns + [f'G1 X{x:.3f}']
    out = []
    for level in range(rest[0]):
        out += [f'G1 Z{-2.0 - 4 * level:g} F{feed:g}'] + path(rest[1])
    if kind == 'walls':
        out += path(rest[2])
    return out


def program(part, fast, scale, far, most_rpm):
    lines = ['%', f'O0001 ({part.name} part, {"fast" if fast else "plain"})', 'G21 G17 G40 G80 G90 G94']
    long_left = part.long_hops
    hops = sum(op.sites for tool in part.tools for op in tool) - len(part.tools)
    every = hops / long_left if long_left else 0
    hop = 0
    for number, ops in enumerate(part.tools, 1):
        lines.append(f'T{number} M6')
        if part.index_deg:
            lines.append(f'B{part.index_deg * (number % 4):g}')
        start = f'S{speed_rpm(ops[0], fast, most_rpm)} M3'
        # Tools begin by turns at two places that are `far` from each other.
        away = 0.0 if number % 2 else far
        x, y = 20.0 + 0.8 * away, 20.0 + 0.6 * away
        if part.spindle_apart:
            lines.append(start)
        lines += [f'G0 X{x:.3f} Y{y:.3f}' + ('' if part.spindle_apart else ' ' + start), 'G0 Z2.']
        first = True
        for op in ops:
            feed = (op.fast if fast else op.plain)[1]
            if op is not ops[0]:
                lines.append(f'S{speed_rpm(op, fast, most_rpm)}')
            if op.sites == 0:
                lines += cut(op.shape, (x, y), feed, scale)
            for _ in range(op.sites):
                if not first:
                    hop += 1
                    far_hop = every and int(hop / every) > int((hop - 1) / every)
                    step = LONG_XY if far_hop else NEAR_XY
                    x += step if hop % 2 else -step
                    lines += [f'G0 Z{2 + NEAR_Z:g}', f'G0 X{x:.3f} Y{y:.3f}', 'G0 Z2.']
                first = False
                lines += cut(op.shape, (x, y), feed, scale)
        up = f'G0 Z{2 + far:.3f}'
        lines += [up, 'M5'] if part.spindle_apart else [up + ' M5']
        lines.append('(change)')
    return '\n'.join(lines + part.extra + ['M30', '%']) + '\n'
