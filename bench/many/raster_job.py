"""machine.toml and job.toml of the rasters of this folder: a ball in a block, forces by a linear law."""


def write(folder, diameter_mm, box_mm, voxel_mm, coupling, control=""):
    """box_mm: its two corners. control: a [control] table, or nothing. The program is raster.nc."""
    (folder / "machine.toml").write_text(
        "".join("[axis.%s]\nacceleration_mm_per_s2 = 3000\n" % axis for axis in "xyz") + control +
        "[spindle]\nmax_rpm = 12000\n")
    (folder / "job.toml").write_text("""program = "raster.nc"
machine = "machine.toml"
[tool.1]
type = "ball"
diameter_mm = %.1f
flutes = 2
overhang_mm = 25.0
[material]
ktc_MPa = 800.0
krc_MPa = 250.0
kte_N_per_mm = 5.0
kre_N_per_mm = 5.0
[stock]
box_mm = %s
[simulation]
voxel_mm = %g
coupling = "%s"
""" % (diameter_mm, box_mm, voxel_mm, coupling))
