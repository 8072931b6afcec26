"""Controls of several laws, built apart from the library: programs, and the servo traces that machines leave of them.

A control plans one path of lines and arcs: speeds at corners by its law, speeds between them by the accelerations of
its axes, forward and backward over the blocks. Positions at its period go through a moving average (bell) and the
drives, which are integrated in steps of a tenth of a millisecond.
"""
import math
import random

AXES = 'xyz'
LAWS = ('speed_difference', 'speed_difference_by_axis', 'angle', 'radius', 'exact_stop')


class Machine:
    """Limits and drives, drawn at random from what machine tools have."""

    def __init__(self, seed):
        r = random.Random(seed)
        self.law = LAWS[seed % len(LAWS)]
        self.velocity = [r.uniform(120, 500) for _ in AXES]
        self.acceleration = [r.uniform(400, 3000) for _ in AXES]
        step = r.uniform(1.5, 12)
        self.speed_step = [step * (r.uniform(0.6, 1.6) if self.law.endswith('axis') else 1) for _ in AXES]
        self.corner_time = r.uniform(0.002, 0.012)
        self.corner_acceleration = r.uniform(80, 800)
        self.arc_fraction = r.choice([1.0, r.uniform(0.4, 1.0)])
        self.block_time = r.choice([0.0, r.uniform(0.001, 0.004)])
        self.bell = r.choice([0.0, 0.0, r.uniform(0.010, 0.040)])
        self.period = 0.001
        self.gain = [r.uniform(20, 80) for _ in AXES]
        self.lag = [r.choice([0.0, r.uniform(0.001, 0.006)]) for _ in AXES]
        feed_forward = r.choice([0.0, 0.0, r.uniform(0.3, 0.9)])
        self.feed_forward = [feed_forward for _ in AXES]
        dead_time = r.choice([0.0, 0.0, r.uniform(0.002, 0.006)])
        self.dead_time = [dead_time for _ in AXES]
        # How it is recorded.
        self.every = r.choice([1, 1, 2, 4])
        self.noise = r.choice([0.0, 0.0, 0.0005])
        self.random = r


class Program:
    """Moves with the text that makes them: ('line', p, q, F), ('arc', p, q, F, centre, axis), ('rapid', p, q), ('dwell', s)."""

    def __init__(self):
        self.text = ['G21 G90 G94 G17 G40 G49 G80', 'G54']
        self.moves = []  # (line number, kind, start, end, feed in mm/s, extra)
        self.parts = []  # (first line, last line, F)
        self.at = (0.0, 0.0, 0.0)
        self.add('G0 X0. Y0. Z0.', 'rapid', self.at)

    def add(self, text, kind, end, feed=0.0, extra=None):
        self.text.append(text)
        self.moves.append((len(self.text), kind, self.at, end, feed / 60, extra))
        self.at = end

    def dwell(self, seconds):
        self.add(f'G4 X{seconds:.3f}', 'dwell', self.at, 0, seconds)

    def line(self, end, feed):
        end = tuple(round(v, 3) for v in end)
        self.add('G1 X%.3f Y%.3f Z%.3f F%d' % (*end, feed), 'line', end, feed)

    def rapid(self, end):
        end = tuple(round(v, 3) for v in end)
        self.add('G0 X%.3f Y%.3f Z%.3f' % end, 'rapid', end)

    def circle(self, radius, feed):
        """A full turn in XY whose centre lies at +X."""
        centre = (self.at[0] + radius, self.at[1], self.at[2])
        self.add('G3 I%.3f J0. F%d' % (radius, feed), 'arc', self.at, feed, centre)

    def part(self, make, feed):
        self.dwell(0.3)
        first = len(self.text) + 1
        make()
        self.parts.append((first, len(self.text), feed))
        self.dwell(0.3)
        self.rapid((0, 0, 0))

    def polygon(self, plane, turn_deg, side, feed, sides=8):
        def make():
            u = v = 0.0
            for i in range(sides):
                heading = math.radians(i * turn_deg)
                u += side * math.cos(heading)
                v += side * math.sin(heading)
                p = [0.0, 0.0, 0.0]
                p[plane], p[(plane + 1) % 3] = u, v
                self.line(p, feed)
        self.part(make, feed)

    def chords(self, length, feed, count=120, radius=30):
        def make():
            for i in range(1, count + 1):
                phi = i * length / radius
                self.line((radius * math.sin(phi), radius * (1 - math.cos(phi)), 0), feed)
        self.part(make, feed)

    def finish(self):
        self.text.append('M30')
        return '\n'.join(self.text) + '\n'


def protocol():
    """Every number of a control shows in it."""
    p = Program()
    for axis in range(3):
        for way in (8, 120):
            p.dwell(0.3)
            p.rapid([way if i == axis else 0 for i in range(3)])
            p.dwell(0.3)
            p.rapid((0, 0, 0))
    for feed in (600, 2000, 5000):
        for plane in range(3):
            for turn in (10, 20, 30, 45, 60, 90, 120):
                p.polygon(plane, turn, 4, feed)
            p.polygon(plane, 60, 1, feed)
        for radius in (1, 4, 12):
            p.part(lambda: p.circle(radius, feed), feed)
    p.chords(0.2, 5000)
    p.chords(0.05, 5000)
    p.chords(0.02, 3000)
    return p


def held_out(seed):
    """Shapes that the protocol does not have: slots, zigzags of other angles, waves of short lines, arcs."""
    r = random.Random(1000 + seed)
    p = Program()
    for feed in (900, 1800, 3600):
        for turn in (17, 38, 75, 100):
            def zigzag():
                u = v = 0.0
                for i in range(10):
                    heading = math.radians((0.5 if i % 2 else -0.5) * turn + 20)
                    u += r.uniform(1, 7) * math.cos(heading)
                    v += r.uniform(1, 7) * math.sin(heading)
                    p.line((u, v, 0.3 * i), feed)
            p.part(zigzag, feed)

        def wave():
            for i in range(1, 150):
                p.line((0.4 * i, 3 * math.sin(0.15 * i), math.sin(0.05 * i)), feed)
        p.part(wave, feed)
        p.part(lambda: p.circle(2.5, feed), feed)
    return p


# --- plan -------------------------------------------------------------------------------------------------------------

def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def norm(a):
    return math.sqrt(sum(x * x for x in a))


class Piece:
    """A line or an arc of the path, from rest or corner to corner."""

    def __init__(self, machine, move):
        self.number, self.kind, self.start, self.end, self.feed, self.centre = move
        if self.kind == 'arc':
            self.radius = norm(sub(self.start, self.centre))
            self.length = 2 * math.pi * self.radius
            a = min(machine.acceleration[0], machine.acceleration[1])
            self.speed = min(self.feed, machine.velocity[0], machine.velocity[1],
                             math.sqrt(machine.arc_fraction * a * self.radius))
            self.acceleration = a
        else:
            way = sub(self.end, self.start)
            self.length = norm(way)
            self.direction = tuple(w / self.length for w in way)
            ratio = [abs(d) for d in self.direction]
            self.speed = min([self.feed] + [v / d for v, d in zip(machine.velocity, ratio) if d > 1e-12])
            self.acceleration = min(a / d for a, d in zip(machine.acceleration, ratio) if d > 1e-12)
        if machine.block_time > 0:
            self.speed = min(self.speed, self.length / machine.block_time)

    def at(self, s):
        if self.kind == 'arc':
            x, y = self.start[0] - self.centre[0], self.start[1] - self.centre[1]
            phi = s / self.radius
            return (self.centre[0] + x * math.cos(phi) - y * math.sin(phi),
                    self.centre[1] + x * math.sin(phi) + y * math.cos(phi), self.start[2])
        return tuple(p + s * d for p, d in zip(self.start, self.direction))


def corner_speed(machine, a, b):
    if machine.law == 'exact_stop' or a.kind == 'arc' or b.kind == 'arc':
        return 0.0
    change = [abs(x - y) for x, y in zip(a.direction, b.direction)]
    cos = max(-1.0, min(1.0, sum(x * y for x, y in zip(a.direction, b.direction))))
    speed = min(a.speed, b.speed)
    if cos > 1 - 1e-9:
        return speed
    if machine.law.startswith('speed_difference'):
        return min([speed] + [step / c for step, c in zip(machine.speed_step, change) if c > 1e-12])
    if machine.law == 'angle':
        return min(speed, min(a.acceleration, b.acceleration) * machine.corner_time / math.sqrt(2 * (1 - cos)))
    chord = norm(sub(b.end, a.start))
    sine = math.sqrt(max(0.0, 1 - cos * cos))
    radius = chord / (2 * sine) if sine > 1e-6 else (1e9 if cos > 0 else 0.0)
    return min(speed, math.sqrt(machine.corner_acceleration * radius))


def run_of_pieces(machine, pieces, out):
    """Speeds at the corners, then positions at the period: appends (line, position) to `out`."""
    n = len(pieces)
    corner = [0.0] + [corner_speed(machine, pieces[i], pieces[i + 1]) for i in range(n - 1)] + [0.0]
    for i in range(n - 1, -1, -1):
        corner[i] = min(corner[i], math.sqrt(corner[i + 1] ** 2 + 2 * pieces[i].acceleration * pieces[i].length))
    for i in range(n):
        corner[i + 1] = min(corner[i + 1], math.sqrt(corner[i] ** 2 + 2 * pieces[i].acceleration * pieces[i].length))
    begin = len(out) * machine.period
    t0 = begin
    k = len(out)
    for i, piece in enumerate(pieces):
        v0, v1, a, length = corner[i], corner[i + 1], piece.acceleration, piece.length
        top = min(piece.speed, math.sqrt((v0 * v0 + v1 * v1) / 2 + a * length))
        top = max(top, v0, v1)
        t1, t3 = (top - v0) / a, (top - v1) / a
        s1, s3 = (v0 + top) / 2 * t1, (v1 + top) / 2 * t3
        t2 = max(0.0, length - s1 - s3) / top
        end = t0 + t1 + t2 + t3
        while k * machine.period < end:
            t = k * machine.period - t0
            if t < t1:
                s = v0 * t + a * t * t / 2
            elif t < t1 + t2:
                s = s1 + top * (t - t1)
            else:
                left = t1 + t2 + t3 - t
                s = length - v1 * left - a * left * left / 2
            out.append((piece.number, piece.at(max(0.0, min(length, s)))))
            k += 1
        t0 = end


def rapid_times(machine, move):
    """Each axis by itself (dog leg): trapezoids."""
    profiles = []
    for start, end, v, a in zip(move[2], move[3], machine.velocity, machine.acceleration):
        way = abs(end - start)
        top = min(v, math.sqrt(way * a)) if way > 0 else 0.0
        ramp = top / a
        profiles.append((start, math.copysign(1, end - start), way, top, ramp, 0 if way == 0 else way / top + ramp))
    return profiles


def rapid_at(profile, a, t):
    start, sign, way, top, ramp, total = profile
    if t >= total:
        return start + sign * way
    if t < ramp:
        s = a * t * t / 2
    elif t < total - ramp:
        s = top * (t - ramp / 2)
    else:
        s = way - a * (total - t) ** 2 / 2
    return start + sign * s


def commands(machine, program):
    """(line, position) each period; line 0 at rests."""
    out = []
    pieces = []

    def flush():
        if pieces:
            run_of_pieces(machine, pieces, out)
            out.append((0, pieces[-1].end))
            pieces.clear()
    for move in program.moves:
        number, kind, start, end, _, extra = move
        if kind in ('line', 'arc'):
            if kind == 'arc' or start != end:
                pieces.append(Piece(machine, move))
            continue
        flush()
        if kind == 'dwell':
            out.extend([(0, start)] * round(extra / machine.period))
        elif start != end:
            profiles = rapid_times(machine, move)
            for k in range(math.ceil(max(p[5] for p in profiles) / machine.period)):
                out.append((number, tuple(rapid_at(p, a, k * machine.period)
                                          for p, a in zip(profiles, machine.acceleration))))
            # In position, as far as a control without a look at the drives knows.
            out.extend([(0, end)] * 100)
    flush()
    return out


# --- after the interpolation --------------------------------------------------------------------------------------------

def averaged(values, window):
    if window < 2:
        return values
    out, total = [], values[0] * window
    ring = [values[0]] * window
    for k, v in enumerate(values):
        total += v - ring[k % window]
        ring[k % window] = v
        out.append(total / window)
    return out


def followed(machine, axis, values):
    """The drive in steps of 0.1 ms, by the midpoint rule: Tv x'' + x' = Kp (c - x) + F c', c delayed."""
    steps = 10
    h = machine.period / steps
    gain, lag, forward = machine.gain[axis], machine.lag[axis], machine.feed_forward[axis]
    delay = round(machine.dead_time[axis] / h)
    command = [values[0]] * (delay + 1)
    for a, b in zip([values[0]] + values, values):
        command.extend(a + (b - a) * i / steps for i in range(1, steps + 1))
    x, v = values[0], 0.0
    out = []
    for k in range(len(values) * steps):
        c, slope = command[k], forward * (command[k + 1] - command[k]) / h
        middle = (c + command[k + 1]) / 2
        if lag > 0:
            v_middle = v + h / 2 * (gain * (c - x) + slope - v) / lag
            v += h * (gain * (middle - x - h / 2 * v) + slope - v_middle) / lag
            x += h * v_middle
        else:
            x += h * (gain * (middle - x - h / 2 * (gain * (c - x) + slope)) + slope)
        if k % steps == steps - 1:
            out.append(x)
    return out


def trace(machine, program):
    """Rows t, 3 commanded, 3 actual, line, as the machine's recorder keeps them."""
    samples = commands(machine, program)
    samples += [(0, samples[-1][1])] * 500
    window = round(machine.bell / machine.period)
    command = [averaged([s[1][i] for s in samples], window) for i in range(3)]
    actual = [followed(machine, i, command[i]) for i in range(3)]
    noise = machine.random.gauss
    rows = []
    for k in range(0, len(samples), machine.every):
        rows.append((k * machine.period, *(round(command[i][k], 4) for i in range(3)),
                     *(round(actual[i][k] + (noise(0, machine.noise) if machine.noise else 0), 4) for i in range(3)),
                     samples[k][0]))
    return rows


def write_csv(rows, path):
    with open(path, 'w') as f:
        f.write('t_s,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_act_mm,y_act_mm,z_act_mm,line\n')
        for r in rows:
            f.write('%.6f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%d\n' % r)
