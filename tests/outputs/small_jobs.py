"""Jobs of a second each, for what no sample has: every cutter, Kienzle's law, run-out, uneven pitch, a stepped tool,
drilling, inches, and the stock of one job as the blank of the next."""
import os

MACHINE = """[control]
dialect = "%s"
corner = { law = "blend", tolerance_mm = 0.01 }
[axis.x]
acceleration_mm_per_s2 = 500
position_gain_per_s = 40
[axis.y]
acceleration_mm_per_s2 = 500
position_gain_per_s = 40
[axis.z]
acceleration_mm_per_s2 = 500
position_gain_per_s = 40
"""

# A slot, a pass beside it that is a little deeper, an arc, and a slope.
SLOT = """%
O0001 (SLOT AND SIDE)
G21 G17 G40 G49 G80 G90 G54
T1 M6
S4000 M3
G0 X-5. Y2. Z5.
Z-0.6
N10 G1 X5. F600
G3 X7. Y4. I0. J2.
G1 Y10.
G0 Z5.
X-5. Y3.
Z-0.7
G1 X3. F500
X12. Z-0.2
G0 Z5.
M30
%
"""

INCH = """G20 G17 G40 G49 G80 G90 G54
T1 M6
S4000 M3
G0 X-.2 Y.1 Z.2
Z-.02
G1 X.4 F24.
G91 Y.04
X-.3
G90
G0 Z.2
M30
"""

HOLES = """G21 G90 G17 G40 G49 G80 G54
T2 M6
S2000 M3
G0 X0 Y0 Z20
G99 G81 X3 Y2 Z-1.5 R1 F240
G83 X6 Y5 Z-2 R1 Q1
G80
G0 Z20
T1 M6
S4000 M3
G0 X-5. Y2. Z5.
Z-0.6
G1 X12. F600
G0 Z5.
M30
"""

CUTTERS = {
    "flat": 'type = "flat"\ndiameter_mm = 4.0\nrunout_um = 8.0\nrunout_angle_deg = 30.0\n',
    "ball": 'type = "ball"\ndiameter_mm = 4.0\npitch_deg = [170, 190]\n',
    "bull": 'type = "bull"\ndiameter_mm = 4.0\ncorner_radius_mm = 0.8\nflute_length_mm = 8.0\nneck_diameter_mm = 3.6\n'
            'neck_length_mm = 6.0\nshank_diameter_mm = 4.0\nroot_stiffness_N_per_um = 15.0\n'
            'holder_mm = [[12.0, 20.0, 15.0]]\n',
    "tapered-ball": 'type = "tapered_ball"\ndiameter_mm = 3.0\ntaper_deg = 8.0\n',
    "chamfer": 'type = "chamfer"\ndiameter_mm = 5.0\ntip_diameter_mm = 2.0\npoint_angle_deg = 90.0\n',
    "general": 'type = "general"\ndiameter_mm = 4.0\ncorner_radius_mm = 0.5\n'
               'corner_centre_r_mm = 1.53\ncorner_centre_z_mm = 0.5\ntaper_deg = 3.0\nflute_length_mm = 10.0\n',
}
COMMON = "flutes = 2\nhelix_deg = 30.0\noverhang_mm = 18.0\nyoungs_modulus_GPa = 600.0\n"
DRILL = '[tool.2]\ntype = "drill"\ndiameter_mm = 3.0\npoint_angle_deg = 118\nflutes = 2\noverhang_mm = 40.0\n'
MATERIALS = {
    "linear": "ktc_MPa = 700.0\nkrc_MPa = 250.0\nkac_MPa = 120.0\nkte_N_per_mm = 5.0\nkre_N_per_mm = 6.0\n"
              "kae_N_per_mm = 1.0\n",
    "kienzle": "kc1_1_MPa = 641.0\nmc = 0.27\nkrc_ratio = 0.4\nkac_ratio = 0.1\nkte_N_per_mm = 3.0\n",
}
BLANK = "box_mm = [[0, 0, -3], [9, 8, 0]]"


def job(program, tools, material, coupling, stock=BLANK, dialect="fanuc"):
    return ('program = "%s"\nmachine = "%s.toml"\n%s\n[material]\n%s\n[stock]\n%s\n[simulation]\nvoxel_mm = 0.2\n'
            'coupling = "%s"\n[compensation]\nlevers = ["shift"]\ntolerance_um = 1.0\nmax_shift_mm = 0.1\nmax_rounds = 2\n'
            % (program, dialect, tools, MATERIALS[material], stock, coupling))


def jobs():
    """Name and text of each. "second" reads the stock that "flat-rigid" leaves."""
    out = {}
    for n, (name, cutter) in enumerate(CUTTERS.items()):
        tool = "[tool.1]\n" + cutter + COMMON
        for coupling, material in (("rigid", "kienzle"), ("static", "linear")) if n % 2 else \
                                  (("rigid", "linear"), ("static", "kienzle")):
            out["%s-%s" % (name, coupling)] = job("slot.nc", tool, material, coupling)
    flat = "[tool.1]\n" + CUTTERS["flat"] + COMMON
    out["inch"] = job("inch.nc", flat, "linear", "static", dialect="haas")
    out["holes"] = job("holes.nc", flat + DRILL, "kienzle", "static", dialect="mazak")
    # Beside this folder lies the result of flat-rigid.
    out["second"] = job("slot.nc", "[tool.1]\n" + CUTTERS["bull"] + COMMON, "linear", "static",
                         'vdb = "../out/predict/small-flat-rigid/files/stock.vdb"', dialect="linuxcnc")
    return out


def write(folder):
    os.makedirs(folder)
    files = {"slot.nc": SLOT, "inch.nc": INCH, "holes.nc": HOLES}
    for dialect in ("fanuc", "haas", "mazak", "linuxcnc"):
        files[dialect + ".toml"] = MACHINE % dialect
    files.update((name + ".toml", text) for name, text in jobs().items())
    for name, text in files.items():
        with open(os.path.join(folder, name), "w", encoding="utf8", newline="\n") as file:
            file.write(text)
