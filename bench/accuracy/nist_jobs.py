"""Jobs of the measured NIST plates: one for every plate and group of features, each in a folder of its own.

    bench/accuracy/nist_jobs.py DIR [--plate N]...     writes DIR/NN-GROUP/{plate.nc,job.toml}, DIR/machine.toml

Data: tests/data/nist_parts (README there). The program of plate 1 with the S and F words of each plate; features where
the program cuts them. What nobody tells and is assumed here: two flutes, 30 degrees, carbide, the blank's top at the
program's Z0 and its lower face at -8 mm; sizes measured over the depth of a bore or slot.
"""
import csv
import lzma
import os
import re
import sys

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
DATA = os.path.join(ROOT, "tests", "data", "nist_parts")
INCH = 25.4
STICK_OUT_IN = {"short": {5: 0.375, 1: 0.375, 4: 0.5, 3: 0.75}, "long": {5: 1.375, 1: 1.375, 4: 1.5, 3: 1.75},
                "op": {5: 0.4, 1: 0.4, 4: 0.52, 3: 0.78}}  # op: not told; other lengths than short ones: a clamping of their own
DIAMETER_MM = {5: 3.175, 1: 2.362, 4: 6.35, 3: 12.7}
SHANK_MM = {1: 3.175}  # mills of 3/32 inch have shanks of 1/8 inch
TOP_MM, BOTTOM_MM = -0.6, -4.7  # between which a bore is measured
# group: tool, lines of the program, middle (inches), features [(name, kind, x, y, nominal, arc)]
GROUPS = {
    "bore4a": (5, [1173, 1277], [("Diameter 10", 0.61715, -1.3218, 4.0), ("Diameter 2", 0.61715, -1.3218, 4.0),
                                 ("Diameter 7", 0.61715, -1.3218, 4.0), ("Diameter 8", 0.61715, -1.3218, 4.0),
                                 ("Diameter 9", 0.61715, -1.3218, 4.0)]),
    "bore4b": (5, [1485, 1589], [("Diameter 1", 2.0935, -0.2919, 4.0), ("Diameter 5", 2.0935, -0.2919, 4.0),
                                 ("Diameter 6", 2.0935, -0.2919, 4.0)]),
    "bore10": (4, [252, 328], [("Diameter 4", 0.61715, -1.7155, 10.0)]),
    "bore3": (1, [2647, 2750], [("Diameter 3", 3.88905, -1.1031, 3.0), ("Diameter 11", 3.88905, -1.1031, 3.0),
                                ("Diameter 12", 3.88905, -1.1031, 3.0)]),
    "keyhole": (5, [873, 1067], [("Diameter 13", 3.4715, -0.6856, 10.0, -145, 145),
                                 ("Diameter 18", 3.1762, -0.6856, 5.0, 95, 265)]),
    "slot1": (5, [2318, 2425], [("Diameter 19", 3.12865, -2.5521, 5.0, 185, 355), ("Diameter 20", 3.12865, -1.5678, 5.0, 5, 175),
                                ("Distance 3", "Diameter 19", "Diameter 20", 25.0)]),
    "slot2": (5, [2426, 2533], [("Diameter 21", 3.45345, -2.621, 4.0, 185, 355), ("Diameter 22", 3.45345, -2.0895, 4.0, 5, 175),
                                ("Distance 6", "Diameter 21", "Diameter 22", 13.5)]),
    "slot3": (5, [2534, 2641], [("Diameter 23", 3.74875, -2.621, 4.0, 185, 355), ("Diameter 24", 3.74875, -2.0895, 4.0, 5, 175),
                                ("Distance 7", "Diameter 23", "Diameter 24", 13.5)]),
}


# Slots lose the middle of their straight walls, inches: only their ends were measured, and a prediction takes a quarter
# of the time; lag has settled along the 3 mm that remain. Their distances lose the same.
SHORTENED_IN = {"slot1": 0.86, "slot2": 0.4, "slot3": 0.4}
MIDDLE_IN = {"slot1": -2.06, "slot2": -2.36, "slot3": -2.36}


# What an earlier pass has left of a group, mm: all along the walls and nothing on the floor, so that the blank ends above
# the program's deepest place. Where the tool is short its first pass hardly bends; the line where the second one begins.
LEFT_MM = {"keyhole": 0.266, "bore4a": 0.0762, "bore4b": 0.0762, "slot1": 0.127}
SECOND_PASS = {"bore4a": 1225, "bore4b": 1537, "slot1": 2371}
CUT_THROUGH_MM = -5.06


def shortened(line, group):
    def moved(word):
        y = float(word.group(1))
        return "Y%.4f" % (y - SHORTENED_IN[group] if y > MIDDLE_IN[group] else y)
    return re.sub(r"Y(-?[\d.]+)", moved, line)


def settings():
    with open(os.path.join(DATA, "settings.csv"), encoding="utf8") as file:
        return {int(row["part"]): row for row in csv.DictReader(file)}


def measured():
    """{feature: {plate: mm}}"""
    out = {}
    with open(os.path.join(DATA, "measured.csv"), encoding="utf8") as file:
        for row in csv.DictReader(file):
            out[row["feature"]] = {n: float(row["p%02d" % n]) for n in range(1, 21) if row.get("p%02d" % n)}
    return out


def program(row, group=None):
    """The text of plate 1 with the speeds and feeds of another one. Of a group its own lines, with their numbers."""
    with lzma.open(os.path.join(DATA, "plate_01.nc.xz"), "rt", encoding="latin1", newline="") as file:
        lines = file.read().split("\n")
    tool = None
    for i, line in enumerate(lines):
        change = re.search(r"T(\d+)M6", line)
        if change:
            tool = int(change.group(1))
        if tool not in DIAMETER_MM:
            continue
        line = re.sub(r"S\d+M3", "S%sM3" % row["spindle_rpm"], line)
        feed = row["T%d_F" % tool if tool != 5 else "T5_F_in_per_min"]
        lines[i] = re.sub(r"F[\d.]+", "F%s." % feed, line)
    if group:
        own, (first, last), _ = GROUPS[group]
        change = next(i for i, line in enumerate(lines) if "T%dM6" % own in line)
        if group in SHORTENED_IN:
            lines[first - 3:last] = [shortened(line, group) for line in lines[first - 3:last]]
        keep = set(range(0, 11)) | set(range(change, change + 5)) | set(range(first - 3, last))
        lines = [line if i in keep or "M30" in line or line.startswith("%") else "" for i, line in enumerate(lines)]
    return "\n".join(lines)


def removed_mm(group, name):
    """By which the prediction of a distance is smaller than the part's."""
    return INCH * SHORTENED_IN.get(group, 0) if name.startswith("Distance") else 0


def feature_text(feature, tool, values, plate, group):
    cut = SHORTENED_IN.get(group, 0)
    name, out = feature[0], ["", "[[feature]]", 'name = "%s"' % feature[0], "tool = %d" % tool]
    if name.startswith("Distance"):
        out += ['kind = "distance"', 'of = ["%s", "%s"]' % feature[1:3]]
    else:
        x, y = INCH * feature[1], INCH * (feature[2] - (cut if cut and feature[2] > MIDDLE_IN[group] else 0))
        out += ['kind = "bore"', "axis_mm = [[%.4f, %.4f, %.2f], [%.4f, %.4f, %.2f]]" % (x, y, TOP_MM, x, y, BOTTOM_MM)]
        if len(feature) > 4:
            out += ["arc_deg = [%g, %g]" % feature[4:6]]
    less = removed_mm(group, name)
    out += ["nominal_mm = %.6g" % (feature[3] - less), "tol_mm = [-0.25, 0.25]"]
    if plate in values.get(name, {}):
        out += ["measured_mm = [%.4f]" % (values[name][plate] - less)]
    return "\n".join(out)


def job(plate, group, row, values, overrides):
    tool, lines, features = GROUPS[group]
    stick_out = INCH * STICK_OUT_IN[row["tool_length"]][tool]
    places = [f for f in features if not f[0].startswith("Distance")]
    room = 7.0 if group == "keyhole" else 4.5 if group != "bore10" else 7.5
    lo = [min(INCH * f[1] for f in places) - room, min(INCH * f[2] for f in places) - room]
    hi = [max(INCH * f[1] for f in places) + room, max(INCH * f[2] for f in places) + room]
    finishing = group == "keyhole" or (group in SECOND_PASS and row["tool_length"] == "short")
    first = SECOND_PASS.get(group, lines[0]) if finishing else lines[0]
    bottom = CUT_THROUGH_MM if finishing else -8
    allowance = f"allowance_mm = {LEFT_MM[group]}  # of the pass before\n" if finishing else ""
    diameter = overrides.get("diameters", {}).get((tool, row["tool_length"]), DIAMETER_MM[tool])
    shank = f"\nshank_diameter_mm = {SHANK_MM[tool]}" if tool in SHANK_MM else ""
    return f"""# Plate {plate} of the NIST test bed, {group}: made by bench/accuracy/nist_jobs.py.
program = "plate.nc"
machine = "../machine.toml"
operations = {{ tools = [{tool}], blocks = [[{first}, {lines[1]}]] }}

[tool.{tool}]
type = "flat"
diameter_mm = {diameter:.6g}
flutes = 2
helix_deg = 30
overhang_mm = {stick_out:.3f}{shank}
youngs_modulus_GPa = 600
runout_um = 5              # of a collet: one tooth finishes, its feed marks are those of a whole turn
{overrides.get("tool", "")}
[material]
{overrides.get("material", 'preset = "6061"')}

[stock]
box_mm = [[{lo[0]:.2f}, {lo[1]:.2f}, {bottom:g}], [{hi[0]:.2f}, {hi[1]:.2f}, 0]]
{allowance}
[simulation]
voxel_mm = 0.15
collisions = "off"
rotation_step_deg = 4
envelope_step_mm = 0.12
{overrides.get("model_error", "")}""" + "\n".join(feature_text(f, tool, values, plate, group) for f in features) + "\n"


MACHINE = """# Hurco of the NIST test bed. The logs tell feeds: arcs are passed at 330 mm/s^2 (v^2 / r); loop gains as by
# hand from the bores (tests/data/nist_parts).
[control]
dialect = "fanuc"
period_ms = 1
corner = { law = "blend", tolerance_mm = 0.005 }
[axis.x]
acceleration_mm_per_s2 = 330
position_gain_per_s = 150
[axis.y]
acceleration_mm_per_s2 = 330
position_gain_per_s = 150
[axis.z]
acceleration_mm_per_s2 = 330
position_gain_per_s = 150
[spindle]
max_rpm = 15000
"""


# Where a fit begins. By hand from the bores and slots of short tools: both axes lag by 2.5 ms, as the axes of a machine
# that cuts round bores do, and X loses more of an arc than Y.
START = MACHINE.replace("position_gain_per_s = 150", "position_gain_per_s = 76\nfeed_forward_percent = 81", 1)
START = START.replace("position_gain_per_s = 150", "position_gain_per_s = 400", 1)


def write_jobs(folder, plates, groups=None, overrides=None):
    """Paths of the jobs that were written."""
    rows, values, out = settings(), measured(), []
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "machine.toml"), "w", encoding="utf8") as file:
        file.write((overrides or {}).get("machine", MACHINE))
    for plate in plates:
        for group in groups or GROUPS:
            own = os.path.join(folder, "%02d-%s" % (plate, group))
            os.makedirs(own, exist_ok=True)
            with open(os.path.join(own, "plate.nc"), "w", encoding="latin1", newline="") as file:
                file.write(program(rows[plate], group))
            with open(os.path.join(own, "job.toml"), "w", encoding="utf8") as file:
                file.write(job(plate, group, rows[plate], values, overrides or {}))
            out.append(os.path.join(own, "job.toml"))
    return out


if __name__ == "__main__":
    wanted = [int(a) for i, a in enumerate(sys.argv) if i > 1 and sys.argv[i - 1] == "--plate"]
    for path in write_jobs(sys.argv[1], wanted or range(1, 21)):
        print(path)
