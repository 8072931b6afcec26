"""The Python module's figures against the command line's --json, over the samples: equal to the last digit.

CAMBER names the executable; the module is found by PYTHONPATH.
"""
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import camber

ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
CAMBER = os.environ["CAMBER"]
FIVE_AXIS = [SAMPLES / "12-five-axis", SAMPLES / "13-dome"]
PROGRAMS = sorted(p for p in SAMPLES.glob("*/*.nc") if p.parent not in FIVE_AXIS)
MACHINES = [SAMPLES / "01-finishing/machine.toml", SAMPLES / "machines/yan_shirase.toml"]


def command_line(*arguments, expected=(0,)):
    """What --json holds."""
    with tempfile.TemporaryDirectory() as folder:
        figures = os.path.join(folder, "figures.json")
        run = subprocess.run([CAMBER, "-q", *map(str, arguments), "--json", figures], capture_output=True, text=True)
        if run.returncode == 1 and 1 in expected:
            return None
        assert run.returncode in expected, f"{arguments}: {run.returncode}\n{run.stderr}"
        with open(figures, encoding="utf8") as file:
            return json.load(file)


def without_compute(figures):
    return {key: value for key, value in figures.items() if key != "compute_s"}


def coarse_copy(sample, into):
    """A sample's folder with voxels of twice the size in its job, for quickness."""
    shutil.copytree(SAMPLES / sample, into)
    job = into / "job.toml"
    text, changed = re.subn(r"(?m)^voxel_mm = (\S+)", lambda m: f"voxel_mm = {2 * float(m[1])}", job.read_text())
    assert changed == 1, sample
    job.write_text(text)
    return job


class Figures(unittest.TestCase):
    maxDiff = 4000

    def equal(self, result, from_command_line):
        self.assertEqual(without_compute(result.figures), without_compute(from_command_line))

    def test_there_are_samples(self):
        self.assertGreaterEqual(len(PROGRAMS), 8)

    def test_check_of_every_program(self):
        for program in PROGRAMS:
            with self.subTest(program=program):
                result, expected = camber.check(program), command_line("check", program)
                self.equal(result, expected)
                self.assertEqual(result.cutting_length_mm, expected["cutting_length_mm"])
                self.assertEqual(result.cutting.min_mm, expected["cutting_extents_mm"]["min"])
                self.assertEqual([t.tool for t in result.tools], [t["tool"] for t in expected["tools"]])

    def test_check_of_five_axes(self):
        for program in sorted(p for folder in FIVE_AXIS for p in folder.glob("*.nc")):
            machine = program.parent / "machine.toml"
            with self.subTest(program=program):
                result = camber.check(program, machine=machine)
                expected = command_line("check", program, "--machine", machine)
                self.equal(result, expected)
                self.assertEqual(result.rotary_moves, expected["moves"]["rotary"])
                self.assertGreater(result.rotary_moves, 1)

    def test_explain_kinematics_of_every_machine(self):
        for path in sorted((SAMPLES / "kinematics").glob("*.toml")):
            with self.subTest(machine=path):
                result = camber.explain_kinematics(path)
                expected = command_line("check", "--explain-kinematics", path)
                self.equal(result, expected)
                self.assertEqual(result.machine_type, expected["machine_type"])
                self.assertEqual([(a.letter, a.rotary, "table" if a.table else "head", a.positive, a.limits)
                                  for a in result.axes],
                                 [(a["axis"], a["axis_type"] == "rotary", a["carried_by"], a["positive"], a["limits"])
                                  for a in expected["axes"]])
                self.assertIn(result.axes[0].positive, result.text)
                self.assertEqual(camber.explain_kinematics(camber.read_machine(path)).json, result.json)
        with self.assertRaises(camber.InputError) as raised:
            camber.explain_kinematics(MACHINES[0])
        self.assertEqual(raised.exception.id, "kinematics-missing")

    def test_what_the_operator_has_set_at_the_control(self):
        text = "G21 G54 G0 X0 Y0 Z50 C0\nG234 H1\nG1 X450. C90. F500\nG49\nM30\n"
        machine = SAMPLES / "kinematics/table_bc.toml"
        offsets = {"G54": [-40, 5, -300]}
        checked = camber.check(camber.program_from_text("p.nc", text, tool_lengths={1: 100}, work_offsets=offsets),
                               machine=machine)
        self.assertEqual([d.id for d in checked.diagnostics if d.id.startswith("travel")], [])
        with self.assertRaises(camber.InputError) as raised:
            camber.check(camber.program_from_text("p.nc", text, tool_lengths={1: 100}, work_offsets={"G54": [10, 5, -300]}),
                         machine=machine)
        self.assertEqual(raised.exception.id, "travel")
        with self.assertRaises(camber.InputError) as raised:
            camber.program_from_text("p.nc", text, work_offsets={"G54": [1, 2]})
        self.assertEqual(raised.exception.id, "work-offset")

    def test_check_of_every_job(self):
        with tempfile.TemporaryDirectory() as out:
            for path in sorted(SAMPLES.glob("*/job.toml")):
                program = path.parent / "finish.nc"
                if not program.exists() or "guide" in str(path):
                    continue
                with self.subTest(job=path):
                    # A machine beside the samples is found there too.
                    shutil.copytree(SAMPLES / "machines", os.path.join(out, "machines"), dirs_exist_ok=True)
                    job = coarse_copy(path.parent.name, pathlib.Path(out, path.parent.name))
                    result, expected = camber.check(program, job=job), command_line("check", program, "--job", job)
                    self.equal(result, expected)
                    self.assertEqual(result.memory_GB, expected["memory_GB"])

    def test_feed_of_every_program_on_two_machines(self):
        for program in PROGRAMS:
            for machine in MACHINES:
                with self.subTest(program=program, machine=machine):
                    expected = command_line("feed", program, "--machine", machine, expected=(0, 1))
                    if expected is None:  # the machine cannot run it: the module refuses it as well
                        self.assertRaises(camber.InputError, camber.feed, program, machine)
                        continue
                    result = camber.feed(program, machine)
                    self.equal(result, expected)
                    self.assertEqual(result.time_s, expected["time_s"])
                    self.assertEqual(result.blocks, expected["blocks"])

    def test_feed_points_are_the_rows_of_feed_csv(self):
        program, machine = SAMPLES / "01-finishing/finish.nc", MACHINES[0]
        points = camber.feed(program, machine).points
        with tempfile.TemporaryDirectory() as folder:
            table = os.path.join(folder, "feed.csv")
            subprocess.run([CAMBER, "-q", "feed", program, "--machine", machine, "-o", table], check=True)
            with open(table, encoding="utf8") as file:
                names = file.readline().strip().split(",")
                rows = [[float(cell) for cell in line.split(",")] for line in file]
        self.assertEqual(len(points), len(rows))
        self.assertEqual(set(names), set(points.columns))
        for index, name in enumerate(names):
            half_step = 0.51e-3 if "mm_per_min" in name else 0.51e-5
            column = getattr(points, name)
            self.assertLess(max(abs(column[i] - row[index]) for i, row in enumerate(rows)), half_step, name)

    def test_time_of_every_program_on_two_machines(self):
        for program in PROGRAMS:
            for machine in MACHINES:
                with self.subTest(program=program, machine=machine):
                    result = camber.time(program, machine)
                    expected = command_line("time", program, "--machine", machine)
                    self.equal(result, expected)
                    self.assertEqual(result.all.total_s, expected["total_s"])
                    self.assertEqual(result.all.e, expected["e"])
                    self.assertEqual(result.all.k if math.isfinite(result.all.k) else None, expected["k"])

    def test_adapt(self):
        job = SAMPLES / "11-feed-by-load/job.toml"
        with tempfile.TemporaryDirectory() as out:
            program = os.path.join(out, "adapted.nc")
            expected = command_line("adapt", job, "-o", program)
            text = pathlib.Path(program).read_bytes()
        result = camber.adapt(job)
        self.equal(result, expected)
        self.assertEqual(result.program.encode(), text)
        self.assertEqual(result.time_after_s, expected["time_after_s"])
        self.assertEqual([load.max_after for load in result.loads], [load["max_after"] for load in expected["loads"]])
        self.assertTrue(result.success)

    def test_copy(self):
        job = SAMPLES / "14-copy-milling/slot.toml"
        with tempfile.TemporaryDirectory() as out:
            program = os.path.join(out, "slot.nc")
            expected = command_line("copy", job, "-o", program, "--stop-after", "3", "--stock", out + "/a.vdb")
            text = pathlib.Path(program).read_text()
            result = camber.copy(job, stop_after_s=3, stock=out + "/b.vdb")
            self.assertTrue(os.path.exists(out + "/b.vdb"))
        figures = result.figures
        for both in (figures, expected):
            del both["tick_ms"], both["compute_s"]
        self.assertEqual(figures, expected)
        self.assertEqual(result.program, text)
        self.assertTrue(result.stopped)
        self.assertEqual(result.time_s, expected["time_s"])
        self.assertEqual([o.removed_mm3 for o in result.operations],
                         [o["removed_mm3"] for o in expected["operations"]])
        with self.assertRaises(camber.InputError) as caught:
            camber.copy(SAMPLES / "14-copy-milling/machine.toml")
        self.assertTrue(caught.exception.file.endswith("machine.toml"))

    def test_post_there_and_back(self):
        folder = SAMPLES / "12-five-axis"
        with tempfile.TemporaryDirectory() as out:
            joints = os.path.join(out, "dome_joints.nc")
            expected = command_line("post", folder / "dome.nc", "--machine", folder / "machine.toml", "-o", joints)
            text = pathlib.Path(joints).read_bytes()
        result = camber.post(folder / "dome.nc", folder / "machine.toml")
        self.equal(result, expected)
        self.assertEqual(result.text.encode(), text)
        self.assertEqual(result.feed_blocks, expected["feed_blocks"])
        self.assertLessEqual(result.tip_bound_mm, 0.005)
        back = camber.post(camber.program_from_text("dome_joints.nc", result.text), folder / "machine.toml", to="tcp")
        self.assertIn("G43.4", back.text)
        with self.assertRaises(ValueError):
            camber.post(folder / "dome.nc", folder / "machine.toml", to="pole")

    def test_posture_of_a_die(self):
        folder = SAMPLES / "16-die-cavity"
        arguments = (folder / "finish.nc", "--job", folder / "job.toml", "--step-mm", 5, "--indexed")
        with tempfile.TemporaryDirectory() as out:
            program = os.path.join(out, "finish_5x.nc")
            expected = command_line("posture", *arguments, "-o", program)
            text = pathlib.Path(program).read_bytes()
        result = camber.posture(folder / "finish.nc", folder / "job.toml", step_mm=5, indexed=True)
        self.equal(result, expected)
        self.assertTrue(result.success)
        self.assertEqual(result.text.encode(), text)
        self.assertEqual(result.of_program.time_s, expected["time_s"])
        with self.assertRaisesRegex(ValueError, "write_as: g68; one of tip, tilted, dynamic, joints was expected"):
            camber.posture(folder / "finish.nc", folder / "job.toml", indexed=True, write_as="g68")

    def test_plan(self):
        plan = SAMPLES / "15-plan/plan.toml"
        with tempfile.TemporaryDirectory() as out:
            folder = os.path.join(out, "planned")
            expected = command_line("plan", plan, "-o", folder)
            files = {name: pathlib.Path(folder, name).read_text() for name in os.listdir(folder)}
        result = camber.plan(plan)
        self.equal(result, expected)
        self.assertTrue(result.success)
        for name, text in result.files:
            self.assertEqual(text, files[name])
        self.assertEqual([o.tool for o in result.operations], [o["tool"] for o in expected["operations"]])
        self.assertEqual([a.nominal_time_s for a in result.alternatives],
                         [p["nominal_time_s"] for p in expected["plans"]])

    def test_time_with_a_sweep(self):
        program, machine = SAMPLES / "02-cycle-time/highspeed.nc", MACHINES[0]
        sweep = "axis.x.acceleration_mm_per_s2=500:2000:4"
        result = camber.time(program, machine, sweep=[sweep])
        expected = command_line("time", program, "--machine", machine, "--sweep", sweep)
        self.equal(result, expected)
        self.assertEqual([row.total_s for row in result.sweep], [row["total_s"] for row in expected["sweep"]])

    def test_fit_feed(self):
        folder = SAMPLES / "01-finishing"
        program, trace, machine = (folder / name for name in ("trace_program.nc", "trace.csv", "machine.toml"))
        with tempfile.TemporaryDirectory() as out:
            fitted = os.path.join(out, "fitted.toml")
            expected = command_line("fit-feed", "--program", program, "--trace", trace, "--machine", machine, "-o",
                                    fitted)
            with open(fitted, encoding="utf8") as file:
                text = file.read()
        result = camber.fit_feed([(program, trace)], machine)
        self.equal(result, expected)
        self.assertEqual([p.value for p in result.parameters], [p["value"] for p in expected["parameters"]])
        self.assertEqual(result.machine.to_toml(), text)

    def jobs(self, out):
        """The jobs of the samples, coarse; some with what other commands make for them."""
        for name in ("01-finishing", "05-freeform", "06-wall", "07-pocket-corner", "09-guide", "10-raster"):
            folder = out / name
            job = coarse_copy(name, folder)
            if name == "09-guide":
                shutil.copy(MACHINES[0], folder / "machine.toml")
                (folder / "material.toml").write_text(
                    "[material]\nktc_MPa = 1860.0\nkrc_MPa = 700.0\nkac_MPa = 0.0\n"
                    "kte_N_per_mm = 15.0\nkre_N_per_mm = 15.0\nkae_N_per_mm = 0.0\n")
            elif name == "10-raster":
                subprocess.run([CAMBER, "-q", "resegment", "--part", folder / "part.stl", "--job", folder / "job.toml",
                                "--scallop-mm", "0.02", "--tolerance-mm", "0.01", "--feed-mm-per-min", "1200",
                                "--spindle-rpm", "12000", "-o", folder / "raster.nc"], check=True)
            yield job

    def test_predict_of_every_job(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            for number, job in enumerate(self.jobs(out)):
                with self.subTest(job=job):
                    result = camber.predict(job)
                    expected = command_line("predict", job, "-o", out / f"predicted{number}", expected=(0, 3))
                    self.equal(result, expected)
                    figures = result.form_error_um
                    if "beyond_model" in expected:
                        self.assertTrue(result.doubts)
                        continue
                    self.assertEqual({k: getattr(figures, k) for k in ("min", "max", "mean", "rms", "p95")},
                                     {k: expected["form_error_um"][k] for k in ("min", "max", "mean", "rms", "p95")})
                    self.assertEqual(result.force_max_N, expected["force_N"]["max"])
                    self.assertEqual(result.chips_mm3, expected["removed_mm3"]["path"])
                    self.assertEqual(result.form_error.error_um.max(), expected["form_error_um"]["max"])
                    with open(out / f"predicted{number}" / "forces.csv", encoding="utf8") as file:
                        names = file.readline().strip().split(",")
                        self.assertEqual(len(result.forces), sum(1 for _ in file))
                    # The file has it where a tool is tilted.
                    self.assertEqual(set(names) | {"f_axial_max_N"}, set(result.forces.columns))
                    with open(out / f"predicted{number}" / "form_error.csv", encoding="utf8") as file:
                        names = file.readline().strip().split(",")
                        self.assertEqual(len(result.form_error), sum(1 for _ in file))
                    self.assertEqual(set(names) | {"model_error_um", "tool_deflection_um", "part_deflection_um"}, set(result.form_error.columns))
                    self.assertTrue(all(map(math.isnan, result.form_error.model_error_um)), "no trace")

    def test_compensate_of_two_jobs(self):
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder)
            jobs = list(self.jobs(out))
            for job in (jobs[2], jobs[4]):
                with self.subTest(job=job):
                    emitted = out / "emitted.nc"
                    expected = command_line("compensate", job, "-o", emitted, "--keep-anyway", expected=(0, 3))
                    written = out / "library" / "emitted.nc"
                    written.parent.mkdir(exist_ok=True)
                    result = camber.compensate(job, keep_anyway=True, output=written)
                    self.equal(result, expected)
                    self.assertEqual(written.read_bytes(), emitted.read_bytes())
                    self.assertEqual(result.program.encode(), emitted.read_bytes())
                    self.assertEqual(result.after_um.p95, expected["after_um"]["p95"])
                    self.assertEqual(result.success, expected["verdict"]["success"])
                    judged = command_line("compensate", "--verify", emitted, expected=(0, 3))
                    verified = camber.verify(written)
                    self.equal(verified, judged)
                    self.assertEqual(verified.error_um.p95, judged["emitted"]["error_um"]["p95"])
                    self.assertEqual(verified.gouge_depth_p999_um, judged["into_part"]["gouge_depth_p999_um"])
                    self.assertEqual((verified.success, verified.program), (result.success, str(written)))


if __name__ == "__main__":
    unittest.main()
