"""A contouring control of another law than those of controls.py, built apart from the library, its programs in
Klartext, and the position logs that it leaves.

Between the places that limit it the speed changes in an S, with limits of acceleration and jerk; a corner is passed at
the speed at which the filter of the set values (a triangle of the time `filter`) cuts off the tolerance:
v = tolerance / (|u2 - u1| filter / 12), a curve at sqrt(a r). Set values are positions after that filter.
"""
import math
import random

STEP_MM = 0.05
SHAPE = 12  # knots of a change of speed


class Machine:
    def __init__(self, seed):
        r = random.Random(seed)
        self.acceleration = r.uniform(800, 4000)
        self.normal = self.acceleration * r.uniform(0.4, 1.0)
        self.jerk = self.acceleration / r.uniform(0.015, 0.06)
        self.filter = r.uniform(0.012, 0.040)
        self.tolerance = r.uniform(0.005, 0.03)
        self.block_time = r.choice([0.0005, 0.0036])
        self.period = 0.003
        self.random = r


class Program:
    """Lines and arcs in XY, one a block: (line number, from, to, F in mm/s, centre or None, sense)."""

    def __init__(self, name):
        self.text = [f'BEGIN PGM {name} MM', 'L X+0. Y+0. Z+50. R0 FMAX', 'L Z+0. R0 FMAX']
        self.name, self.moves, self.at = name, [], (0.0, 0.0, 0.0)

    def line(self, x, y, z, feed):
        end = (round(x, 3), round(y, 3), round(z, 3))
        if end == self.at:
            return
        self.text.append('L X%+.3f Y%+.3f Z%+.3f F%d' % (*end, feed))
        self.moves.append((len(self.text), self.at, end, feed / 60, None, 0))
        self.at = end

    def arc(self, centre, x, y, feed, sense):
        """sense 1: counter-clockwise, DR+."""
        end = (round(x, 3), round(y, 3), self.at[2])
        self.text.append('CC X%+.3f Y%+.3f' % centre)
        self.text.append('C X%+.3f Y%+.3f DR%s F%d' % (*end[:2], '+' if sense > 0 else '-', feed))
        self.moves.append((len(self.text), self.at, end, feed / 60, (*centre, end[2]), sense))
        self.at = end

    def finish(self):
        numbered = self.text + [f'END PGM {self.name} MM']
        return '\n'.join(f'{i} {block}' for i, block in enumerate(numbered)) + '\n'


def freeform(program, seed, rows, feed, chord):
    """Rows over a wavy surface, linked by lines: no rapids inside."""
    r = random.Random(seed)
    waves = [(r.uniform(0.05, 0.25), r.uniform(0.5, 3), r.uniform(0, 6)) for _ in range(3)]
    x0, y0, z0 = program.at
    for row in range(rows):
        points = range(1, round(40 / chord))
        for i in points if row % 2 == 0 else reversed(points):
            x = i * chord
            z = sum(a * math.sin(k * x + p + 0.2 * row) for k, a, p in waves)
            program.line(x0 + x, y0 + 1.5 * row, z0 + z, feed * (0.4 if i < 3 else 1))
    program.line(x0, program.at[1], z0, feed)


def contour(program, seed, levels, feed):
    """Pockets of lines and arcs, level by level, with corners of many angles."""
    r = random.Random(seed)
    x0, y0, z0 = program.at
    for level in range(levels):
        z = z0 - 0.5 * level
        w, h, radius = r.uniform(8, 30), r.uniform(8, 30), r.uniform(1, 6)
        program.line(x0, y0, z, feed / 3)
        program.line(x0 + w, y0, z, feed)
        program.arc((x0 + w, y0 + radius), x0 + w + radius, y0 + radius, feed, 1)
        program.line(x0 + w + radius, y0 + h, z, feed)
        program.line(x0 + w, y0 + h + r.uniform(1, 9), z, feed)
        program.arc((x0 + w - radius, program.at[1]), x0 + w - 2 * radius, program.at[1], feed, r.choice([1, -1]))
        for i in range(8):
            program.line(x0 + r.uniform(0, w), y0 + r.uniform(0, h), z, feed)
    program.line(x0, y0, z0, feed)


def production(seed):
    p = Program('PART')
    for i, feed in enumerate((1500, 3000, 4500)):
        contour(p, 10 * seed + i, 6, feed)
        freeform(p, 10 * seed + i, 5, feed, (0.25, 0.5, 1.2)[i])
    return p


def held_out(seed):
    """Other shapes; parts: (first line, last line)."""
    p, parts = Program('OTHER'), []
    for i, feed in enumerate((1000, 2200, 3600)):
        for make in (lambda: contour(p, 500 + 10 * seed + i, 4, feed),
                     lambda: freeform(p, 500 + 10 * seed + i, 3, feed, (0.4, 0.8, 0.3)[i])):
            first = len(p.text) + 1
            make()
            parts.append((first, len(p.text)))
    return p, parts


# --- motion -----------------------------------------------------------------------------------------------------------

def unit(a, b):
    way = [y - x for x, y in zip(a, b)]
    length = math.sqrt(sum(w * w for w in way))
    return [w / length for w in way], length


class Piece:
    def __init__(self, machine, move):
        self.number, self.start, self.end, feed, self.centre, self.sense = move
        self.radius = math.inf
        if self.centre:
            x, y = self.start[0] - self.centre[0], self.start[1] - self.centre[1]
            u, v = self.end[0] - self.centre[0], self.end[1] - self.centre[1]
            self.radius, self.from_angle = math.hypot(x, y), math.atan2(y, x)
            self.sweep = (self.sense * (math.atan2(v, u) - self.from_angle)) % (2 * math.pi) or 2 * math.pi
            self.length = self.radius * self.sweep
        else:
            self.direction, self.length = unit(self.start, self.end)
        self.speed = min(feed, math.sqrt(machine.normal * self.radius), self.length / machine.block_time)

    def at(self, s):
        if not self.centre:
            return [p + s * d for p, d in zip(self.start, self.direction)]
        phi = self.from_angle + self.sense * s / self.radius
        return [self.centre[0] + self.radius * math.cos(phi), self.centre[1] + self.radius * math.sin(phi),
                self.start[2]]

    def tangent(self, s):
        if not self.centre:
            return self.direction
        phi = self.from_angle + self.sense * s / self.radius
        return [-self.sense * math.sin(phi), self.sense * math.cos(phi), 0.0]


def corner_speed(machine, a, b):
    u, v = a.tangent(a.length), b.tangent(0)
    change = math.dist(u, v)
    if change < 1e-4:
        return math.inf
    speed = machine.tolerance / (change * machine.filter / 12)
    # Short lines stand for a curve.
    return min(speed, math.sqrt(machine.normal * (a.length + b.length) / 2 / change)) if change < 0.5 else speed


def ramp_s(machine, change):
    """Time of a change of speed that begins and ends without acceleration."""
    a, j = machine.acceleration, machine.jerk
    return change / a + a / j if change > a * a / j else 2 * math.sqrt(change / j)


def reached(machine, low, way, guess):
    """The speed that such a change from `low` reaches after a way; `guess` below it."""
    v = max(guess, low + 1e-6)
    for _ in range(8):
        off = (low + v) / 2 * ramp_s(machine, v - low) - way
        slope = ramp_s(machine, v - low) / 2 + (low + v) / 2 * (
            (ramp_s(machine, v - low + 1e-6) - ramp_s(machine, v - low)) / 1e-6)
        v = max(low + 1e-9, v - off / slope)
        if abs(off) < 1e-5:
            break
    return v


def ramps_from(machine, at, limit):
    """(speed, place where the change of speed to it began) at each place, from limits passed in order."""
    out, low, begin, v = [], limit[0], 0, limit[0]
    for k in range(len(at)):
        if limit[k] > low and k > begin:
            v = reached(machine, low, abs(at[k] - at[begin]), v)
        if v >= limit[k] or limit[k] <= low:
            low = v = limit[k]
            begin = k
        out.append((v, begin))
    return out


def times(machine, pieces):
    """(place, time) along the path: changes of speed between the places that limit it, S-shaped."""
    at, limit, s = [0.0], [1.0], 0.0
    for i, piece in enumerate(pieces):
        steps = max(1, round(piece.length / STEP_MM))
        for k in range(1, steps + 1):
            at.append(s + piece.length * k / steps)
            limit.append(piece.speed)
        s += piece.length
        following = pieces[i + 1] if i + 1 < len(pieces) else None
        limit[-1] = min(piece.speed, following.speed, corner_speed(machine, piece, following)) if following else 1.0
    up = ramps_from(machine, at, limit)
    last = len(at) - 1
    down = [(v, last - k) for v, k in reversed(ramps_from(machine, at[::-1], limit[::-1]))]
    # Places where one change of speed ends and the next begins.
    ends = [0]
    for k in range(1, last + 1):
        rises, rose = up[k][0] <= down[k][0], up[k - 1][0] <= down[k - 1][0]
        if k == last or rises != rose or (rises and up[k][1] == k) or (not rises and down[k][1] != down[k - 1][1]):
            ends.append(k)
    speed = [min(a[0], b[0]) for a, b in zip(up, down)]
    out, t = [(0.0, 0.0)], 0.0
    for a, b in zip(ends, ends[1:]):
        way, v0, v1 = at[b] - at[a], speed[a], speed[b]
        whole = 2 * way / (v0 + v1)
        # s = v0 t + (v1 - v0) T (x^3 - x^4 / 2), x = t / T: the acceleration is zero at both ends.
        knots = SHAPE if v0 != v1 else 1
        for i in range(1, knots + 1):
            x = i / knots
            out.append((at[a] + whole * (v0 * x + (v1 - v0) * (x ** 3 - x ** 4 / 2)), t + whole * x))
        t += whole
    return out


def averaged(values, window):
    total, out, window = sum([values[0]] * window), [], max(1, window)
    for k, v in enumerate(values):
        total += v - (values[k - window] if k >= window else values[0])
        out.append(total / window)
    return out


def run(machine, program):
    """(t, line, set position), each period."""
    pieces = [Piece(machine, move) for move in program.moves]
    rows, due, begin, i = [], 0.0, 0.0, 0
    knots = times(machine, pieces)
    for (s0, t0), (s1, t1) in zip(knots, knots[1:]):
        while due < t1:
            s = s0 + (s1 - s0) * (due - t0) / (t1 - t0)
            while i + 1 < len(pieces) and s > begin + pieces[i].length:
                begin += pieces[i].length
                i += 1
            rows.append((due, pieces[i].number, pieces[i].at(min(s - begin, pieces[i].length))))
            due += machine.period
    half = round(machine.filter / 2 / machine.period)
    rows += [(due + k * machine.period, 0, pieces[-1].end) for k in range(2 * half + 100)]
    axes = [averaged(averaged([r[2][i] for r in rows], half), half) for i in range(3)]
    return [(r[0], r[1], [axis[k] for axis in axes]) for k, r in enumerate(rows)]


def write_log(machine, rows, hz, path, piece=(0.2, 0.85), quantum_mm=0.001):
    """Set positions of a piece of the run, their distances 20 % off at random."""
    due, end = piece[0] * rows[-1][0], piece[1] * rows[-1][0]
    with open(path, 'w') as f:
        f.write('t_s,x_cmd_mm,y_cmd_mm,z_cmd_mm\n')
        for t, _, at in rows:
            if due <= t < end:
                f.write('%.3f,' % t + ','.join('%.4f' % (round(p / quantum_mm) * quantum_mm) for p in at) + '\n')
                due = t + machine.random.uniform(0.8, 1.2) / hz


def time_of(rows, first, last):
    inside = [t for t, line, _ in rows if first <= line <= last]
    return inside[-1] - inside[0]
