"""Samples and programs for the module's tests, from the repository: a coarse job (mm, takes a second), a long program."""
import pathlib

import camber

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLE = ROOT / "samples/01-finishing"
MACHINE = SAMPLE / "machine.toml"
COARSE = camber.read_job(ROOT / "samples/06-wall/job.toml")
COARSE.set_voxel_mm(0.3)  # takes a second


def long_program(minutes):
    """Straight cuts that take so long."""
    return camber.program_from_text(
        "long.nc", "G21 G90 G94\nS3000 M3\nG0 X0 Y0 Z5\n" +
        "".join(f"G1 X{200 * (i % 2)} F200\n" for i in range(1, minutes + 1)) + "M30\n")
