"""What the module promises beside its figures: shared memory, exceptions, progress."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import unittest

import numpy

import camber
from quick_inputs import COARSE, MACHINE, ROOT, SAMPLE, long_program


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGESIZE")


class Sections(unittest.TestCase):
    def test_parts_are_merged_as_the_command_line_does(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([ROOT / "bench/many/make_job.py", folder, "2", "0.8"], check=True)
            job, out = pathlib.Path(folder) / "job.toml", pathlib.Path(folder) / "out"
            with self.assertRaises(camber.InputError) as missing:
                camber.predict_section(job, out, sections=2, section=1, solve=True)
            self.assertEqual(missing.exception.id, "part-missing")
            for solve in (False, True):
                for section in (2, 1):
                    part = camber.predict_section(job, out, sections=2, section=section, solve=solve)
                    self.assertTrue(part.computed)
                    self.assertGreater(part.stamps, 500)
                    self.assertTrue(pathlib.Path(part.part).exists())
            self.assertFalse(camber.predict_section(job, out, sections=2, section=1).computed)
            merged = camber.merge(out)
            self.assertEqual(merged.figures["sections"]["pieces"], 3)
            self.assertEqual(merged.doubts, [])
            plain = camber.predict(job)
            self.assertAlmostEqual(merged.form_error_um.p95, plain.form_error_um.p95, places=2)
            self.assertTrue((out / "report.html").exists())
            with self.assertRaises(ValueError):
                camber.predict_section(job, out, sections=2, section=3)


class Trace(unittest.TestCase):
    def test_its_own_motion_as_a_trace_gives_the_same_map(self):
        plain = camber.predict(COARSE, feed=True)
        self.assertIsNone(plain.trace)
        self.assertTrue(numpy.isnan(plain.form_error.model_error_um).all())
        points = plain.feed
        with tempfile.TemporaryDirectory() as folder:
            trace = pathlib.Path(folder) / "trace.csv"
            columns = [points.t_s, points.x_mm, points.y_mm, points.z_mm, points.block]
            numpy.savetxt(trace, numpy.column_stack(columns), delimiter=",", fmt=["%.7f"] * 4 + ["%d"],
                          header="t_s,x_act_mm,y_act_mm,z_act_mm,line", comments="")
            traced = camber.predict(COARSE, trace=trace)
        self.assertTrue(traced.trace.by_line)
        self.assertEqual(traced.trace.samples, len(points))
        self.assertLess(traced.trace.difference_um.p95, 0.1)
        numpy.testing.assert_allclose(traced.form_error.model_error_um, plain.form_error.error_um)


class Arrays(unittest.TestCase):
    def test_a_million_points_without_a_copy(self):
        result = camber.feed(long_program(20), MACHINE)  # a point a millisecond
        points = result.points
        self.assertGreater(len(points), 1_000_000)
        before = resident_bytes()
        columns = {name: getattr(points, name) for name in points.columns}
        self.assertLess(resident_bytes() - before, 1_000_000)  # a copy of one column takes 8 MB
        row = 80
        for name, column in columns.items():
            self.assertEqual(column.shape, (len(points),), name)
            self.assertEqual(column.strides, (row,), name)
            self.assertFalse(column.flags.owndata, name)
            self.assertFalse(column.flags.writeable, name)
        addresses = sorted(c.__array_interface__["data"][0] for c in columns.values())
        self.assertEqual([a - addresses[0] for a in addresses], list(range(0, row, 8)))
        # The same memory each time.
        self.assertTrue(numpy.shares_memory(columns["t_s"], result.points.t_s))

    def test_an_array_keeps_its_result_alive(self):
        t_s = camber.feed(SAMPLE / "finish.nc", MACHINE).points.t_s
        again = camber.feed(SAMPLE / "finish.nc", MACHINE)
        numpy.testing.assert_array_equal(t_s, again.points.t_s)

    def test_no_points_give_empty_arrays(self):
        self.assertEqual(camber.feed(SAMPLE / "finish.nc", MACHINE, points=False).points.t_s.shape, (0,))


class Meshes(unittest.TestCase):
    def test_they_are_arrays_for_matplotlib_and_pyvista(self):
        with tempfile.TemporaryDirectory() as folder:
            result = camber.predict(COARSE, meshes=True, output_folder=folder)
            self.assertTrue((pathlib.Path(folder) / "machined.stl").exists())
            with open(pathlib.Path(folder) / "spindle_load.csv", encoding="ascii") as file:
                rows = [line.split(",") for line in file.read().split()[1:]]
        for mesh in (result.error_mesh, result.machined_mesh):
            self.assertEqual(mesh.points.shape, (len(mesh), 3))
            self.assertFalse(mesh.points.flags.owndata)
            self.assertFalse(mesh.points.flags.writeable)
            numpy.testing.assert_allclose(numpy.linalg.norm(mesh.normals, axis=1), 1)
            self.assertEqual(mesh.triangles.min(), 0)
            self.assertEqual(mesh.triangles.max(), len(mesh) - 1)
            faces = mesh.faces.reshape(-1, 4)
            self.assertTrue((faces[:, 0] == 3).all())
            numpy.testing.assert_array_equal(faces[:, 1:], mesh.triangles)
        # The largest error of the points is that of the vertices; the part is closed.
        self.assertEqual(abs(result.error_mesh.error_um).max(), abs(result.form_error.error_um).max())
        a, b, c = (result.machined_mesh.points[result.machined_mesh.triangles[:, k]] for k in range(3))
        numpy.testing.assert_allclose(numpy.cross(b - a, c - a).sum(axis=0), 0, atol=1e-9)
        self.assertGreater(numpy.einsum("ij,ij->i", a, numpy.cross(b, c)).sum() / 6, 100)
        load = result.spindle_load
        self.assertEqual([(str(t), str(line)) for t, line in zip(load.tool, load.line)], [tuple(r[:2]) for r in rows])
        self.assertEqual(load.power_W.max(), result.forces.power_W.max())
        numpy.testing.assert_array_equal(result.forces.points[:, 1], result.forces.y_mm)
        numpy.testing.assert_array_equal(result.form_error.normals[:, 2], result.form_error.nz)
        none = camber.predict(COARSE)
        self.assertEqual((len(none.error_mesh), none.error_mesh.triangles.shape), (0, (0, 3)))


class Inputs(unittest.TestCase):
    def test_a_wrong_program_raises_with_its_place(self):
        program = camber.program_from_text("wrong.nc", "G21\nG90\nG1 X10 F0\n")
        with self.assertRaises(camber.InputError) as raised:
            camber.check(program)
        problem = raised.exception
        self.assertEqual((problem.file, problem.line, problem.column), ("wrong.nc", 3, 8))
        self.assertEqual(problem.id, next(d for d in problem.diagnostics if d.severity == "error").id)
        self.assertIn("F0", problem.message)
        self.assertIn("wrong.nc:3:8: error: " + problem.message, str(problem))
        self.assertIsInstance(problem, ValueError)

    def test_a_missing_file_raises(self):
        with self.assertRaises(camber.InputError) as raised:
            camber.check("nowhere.nc")
        self.assertEqual((raised.exception.file, raised.exception.id), ("nowhere.nc", "file-missing"))

    def test_programs_without_a_record_and_outputs_over_inputs_raise(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(camber.InputError) as raised:
            camber.verify(folder)
        self.assertEqual(raised.exception.id, "record-missing")
        job = camber.read_job(SAMPLE / "job.toml")
        with self.assertRaises(camber.InputError) as raised:
            camber.compensate(job, output=job.program_path)
        self.assertEqual(raised.exception.id, "output-is-input")

    def test_levers_of_other_names_raise(self):
        with self.assertRaises(camber.InputError) as raised:
            camber.compensate(camber.read_job(SAMPLE / "job.toml"), levers=["shift", "speed"])
        self.assertEqual(raised.exception.id, "value-choice")
        self.assertEqual(raised.exception.message, 'compensate: levers names "speed"; a list of "shift", "feed", '
                                                   '"passes" and "allowance" was expected')

    def test_a_job_may_be_read_before_its_program_is_made(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "job.toml")
            text = (SAMPLE / "job.toml").read_text().replace('machine = "', f'machine = "{SAMPLE}/')
            text, left_out = re.subn(r"(?m)^program = .*\n", "", re.sub(r'mesh = "', f'mesh = "{SAMPLE}/', text))
            self.assertEqual(left_out, 1)
            pathlib.Path(path).write_text(text)
            with self.assertRaises(camber.InputError):
                camber.read_job(path)
            job = camber.read_unprogrammed_job(path)
        self.assertEqual(job.program_path, "")
        for call in (camber.predict, camber.compensate, camber.adapt):
            with self.assertRaises(camber.InputError) as raised:
                call(job)
            self.assertEqual(raised.exception.id, "job-program")
            self.assertEqual(str(raised.exception), f"{path}: error: the job has no program; a program in the file, or "
                             "set_program(), was expected [job-program]")

    def test_strict_raises_on_warnings(self):
        program = camber.program_from_text("no_unit.nc", "G90 G94\nS1000 M3\nG1 X10 F100\nM30\n")
        self.assertEqual([d.severity for d in camber.check(program).diagnostics][:1], ["warning"])
        with self.assertRaises(camber.InputError):
            camber.check(program, strict=True)

    def test_a_machine_is_changed_by_key(self):
        machine = camber.read_machine(MACHINE)
        before = camber.time(SAMPLE / "finish.nc", machine).all.total_s
        machine.set("axis.all.acceleration_mm_per_s2", 100)
        self.assertGreater(camber.time(SAMPLE / "finish.nc", machine).all.total_s, before)
        with self.assertRaises(ValueError):
            machine.set("axis.q.acceleration_mm_per_s2", 100)

    def test_an_unknown_dialect_raises(self):
        with self.assertRaises(camber.InputError):
            camber.read_program(SAMPLE / "finish.nc", dialect="abacus")


class Calls(unittest.TestCase):
    def test_progress_is_called_and_stops(self):
        seen = []
        camber.predict(COARSE, progress=lambda what, done: seen.append((what, done)))
        self.assertIn("cutting", {what for what, _ in seen})
        self.assertTrue(all(0 <= done <= 1 for _, done in seen))
        self.assertEqual(seen[-1], ("done", 1))
        with self.assertRaises(camber.Cancelled):
            camber.predict(COARSE, progress=lambda what, done: done < 0.3)

    def test_an_exception_of_progress_passes(self):
        def progress(what, done):
            raise KeyError(what)
        with self.assertRaises(KeyError):
            camber.predict(COARSE, progress=progress)

    def test_two_calls_at_once_and_one_is_stopped(self):
        results = {}

        def predict():
            results["whole"] = camber.predict(COARSE).form_error_um.p95
        other = threading.Thread(target=predict)
        other.start()
        with self.assertRaises(camber.Cancelled):
            camber.predict(COARSE, progress=lambda what, done: done < 0.2)
        other.join()
        self.assertEqual(results["whole"], camber.predict(COARSE).form_error_um.p95)

    def test_the_number_of_threads_changes_nothing(self):
        job = COARSE
        self.assertEqual(camber.predict(job, threads=1).figures["form_error_um"],
                         camber.predict(job, threads=2).figures["form_error_um"])


class Example(unittest.TestCase):
    def test_the_plot_is_drawn(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("no matplotlib")
        with tempfile.TemporaryDirectory() as folder:
            picture = os.path.join(folder, "error.png")
            subprocess.run([sys.executable, ROOT / "examples/python/error_along_the_path.py", SAMPLE / "job.toml",
                            picture], check=True)
            with open(picture, "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")


if __name__ == "__main__":
    unittest.main(verbosity=2)
