"""A finishing raster of N blocks over a wavy surface, with its job: the workload of bench/real/length and
bench/real/memory.

z = 2 sin(2 pi x / 50) cos(2 pi y / 50) mm; blocks 0.5 mm long in rows 0.5 mm apart: a quarter of a square
millimetre a block whatever N is. Ball D12, two flutes, S15000, F7500: 0.25 mm a tooth, two tooth passings a
block; 0.3 mm of allowance left by the pass before.
"""
import math
import os

STEP = 0.5
WAVE = 2 * math.pi / 50

MACHINE = """[control]
dialect = "fanuc"
period_ms = 1.0
corner = { law = "blend", tolerance_mm = 0.01 }
[axis.x]
[axis.y]
[axis.z]
[spindle]
max_rpm = 18000.0
"""

def tool_text(diameter_mm, tangential_MPa, edge_N_per_mm, radial_MPa):
    """[tool.1], a long carbide ball with two flutes, and [material]."""
    return """[tool.1]
type = "ball"
diameter_mm = %.1f
flutes = 2
helix_deg = 30.0
overhang_mm = 40.0
effective_diameter_ratio = 0.8
youngs_modulus_GPa = 600.0
[material]
ktc_MPa = %.1f
krc_MPa = %.1f
kac_MPa = 0.0
kte_N_per_mm = %.1f
kre_N_per_mm = %.1f
kae_N_per_mm = 0.0
""" % (diameter_mm, tangential_MPa, radial_MPa, edge_N_per_mm, edge_N_per_mm)


JOB = """program = "%(name)s.nc"
machine = "machine.toml"
""" + tool_text(12, 700, 10, 200) + """[stock]
box_mm = [[0, 0, %(bottom)g], [%(side)g, %(side)g, 4]]
allowance_mm = 0.3
[simulation]
voxel_mm = %(voxel)g
coupling = "%(coupling)s"
%(more)s"""


def side_mm(blocks):
    """Of the square that so many blocks cover."""
    return STEP * round(math.sqrt(blocks))


def write_program(path, blocks, side=None, row_mm=STEP):
    """Rows of one square, forth and back, until there are so many blocks."""
    side = side or side_mm(blocks)
    per_row = round(side / STEP)
    sine = [2 * math.sin(WAVE * STEP * i) for i in range(per_row + 1)]
    with open(path + ".part", "w") as out:
        out.write("G21 G17 G40 G49 G80 G90 G94\nT1 M6\nS15000 M3\nG0 X0. Y0. Z20.\nG1 Z0. F7500\n")
        row = i = 0
        for _ in range(blocks):
            x = i if row % 2 == 0 else per_row - i
            out.write("X%.3f Y%.3f Z%.4f\n" % (STEP * x, row_mm * row, sine[x] * math.cos(WAVE * row_mm * row)))
            i += 1
            if i > per_row:
                row, i = row + 1, 0
        out.write("G0 Z20.\nM30\n")
    os.replace(path + ".part", path)


def write_job(folder, name, blocks, *, side=None, row_mm=STEP, depth_mm=20.0, voxel_mm=0.2, coupling="rigid", more=""):
    """NAME.nc, NAME.toml and machine.toml in the folder; the path of the job."""
    os.makedirs(folder, exist_ok=True)
    side = side or side_mm(blocks)
    program = os.path.join(folder, name + ".nc")
    if not os.path.exists(program):
        write_program(program, blocks, side, row_mm)
    with open(os.path.join(folder, "machine.toml"), "w") as out:
        out.write(MACHINE)
    job = os.path.join(folder, name + ".toml")
    with open(job, "w") as out:
        out.write(JOB % {"name": name, "side": side, "bottom": 4 - depth_mm, "voxel": voxel_mm, "coupling": coupling,
                         "more": more})
    return job
