"""Every command has a door in the library, which gives what the command writes."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import camber
from quick_inputs import MACHINE, ROOT

SAMPLES = ROOT / "samples"
RASTER = SAMPLES / "10-raster/job.toml"
ROWS = """G21 G90 G94 G17
T1 M6
S8000 M3
G0 X0 Y0 Z5
G1 Z0 F300
""" + "".join(f"G1 X{0.5 * i:.3f} Y{0.0002 * i * i:.4f} F1500\n" for i in range(1, 120)) + "G0 Z5\nM30\n"


class Doors(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "rows.nc").write_text(ROWS)

    def command(self, *words):
        subprocess.run([os.environ["CAMBER"], "-q", *map(str, words)], cwd=self.folder, check=True)

    def written(self, name):
        return (self.folder / name).read_text()

    def test_compress(self):
        self.command("compress", "rows.nc", "--tolerance-mm", 0.01, "-o", "new.nc", "--json", "r.json")
        result = camber.compress(camber.program_from_text("rows.nc", ROWS), 0.01)
        self.assertEqual(result.program, self.written("new.nc"))
        self.assertEqual(result.json, self.written("r.json"))
        self.assertLess(result.after.blocks, result.before.blocks)

    def test_resegment(self):
        self.command("resegment", "rows.nc", "--machine", MACHINE, "--tolerance-mm", 0.01, "-o", "new.nc", "--json",
                     "r.json")
        result = camber.resegment(camber.program_from_text("rows.nc", ROWS), MACHINE, 0.01)
        self.assertEqual(result.program, self.written("new.nc"))
        self.assertEqual(result.json, self.written("r.json"))
        self.assertTrue(result.within_limit)

    def test_raster(self):
        self.command("resegment", "--job", RASTER, "--tolerance-mm", 0.01, "--scallop-mm", 0.2, "--feed-mm-per-min",
                     2000, "--spindle-rpm", 8000, "--length-mm", 1, "-o", "new.nc", "--json", "r.json")
        result = camber.raster(RASTER, tolerance_mm=0.01, scallop_mm=0.2, feed_mm_per_min=2000, spindle_rpm=8000,
                               length_mm=1)
        self.assertEqual(result.program, self.written("new.nc"))
        self.assertEqual(result.json, self.written("r.json"))

    def test_lobes(self):
        job = SAMPLES / "24-chatter/job.toml"
        self.command("lobes", job, "--radial-mm", 1, "--rpm", "4000:12000:3", "-o", "l.csv", "--json", "r.json")
        result = camber.lobes(job, 1, [4000, 8000, 12000])
        self.assertEqual(result.csv, self.written("l.csv"))
        self.assertEqual(result.json, self.written("r.json"))
        self.assertEqual([p.speed_rpm for p in result.lobes], [4000, 8000, 12000])

    def test_fit_modes(self):
        tap = SAMPLES / "24-chatter/tap_x.csv"
        self.command("fit-modes", tap, "-o", "m.toml", "--json", "r.json")
        result = camber.fit_modes(tap)
        self.assertEqual(result.tables, self.written("m.toml"))
        self.assertEqual(result.json, self.written("r.json"))
        self.assertEqual(len(result.modes), len(result.figures["modes"]))

    def test_fit_force(self):
        log, job = SAMPLES / "03-force-fit/means.csv", SAMPLES / "03-force-fit/job.toml"
        self.command("fit-force", "--log", log, "--job", job, "-o", "m.toml", "--json", "r.json")
        result = camber.fit_force([(log, job)])
        self.assertTrue(result.success)
        self.assertEqual(result.material, self.written("m.toml"))
        self.assertEqual(result.json, self.written("r.json"))

    def test_fit_parts(self):
        with self.assertRaises(camber.InputError) as problem:
            camber.fit_parts([SAMPLES / "23-measured-parts/plate_01.toml"], hold_out=["nobody"])
        self.assertEqual(problem.exception.id, "hold-out")

    def test_protocol(self):
        self.command("protocol", "--machine", MACHINE, "-o", "programs")
        files = camber.protocol(MACHINE)
        self.assertEqual(sorted(name for name, _ in files), sorted(os.listdir(self.folder / "programs")))
        for name, text in files:
            self.assertEqual(text, self.written("programs/" + name))


if __name__ == "__main__":
    unittest.main()
