"""Run by freecadcmd: the add-on and the post-processor on a job made by script, without a screen."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = os.environ["CAMBER_ROOT"]
sys.path.insert(0, os.path.join(ROOT, "tests", "freecad"))
sys.path.insert(0, os.path.join(ROOT, "addons", "freecad"))  # as FreeCAD does with an add-on's folder

import FreeCAD

exec(open(os.path.join(ROOT, "addons", "freecad", "Init.py")).read())

import path_job
import PathScripts.PathPost as PathPost
import PathScripts.PathPreferences as PathPreferences
from camber_freecad import compat, job_files, operations, post, results, run, settings, tools

MACHINE = os.path.join(ROOT, "samples", "01-finishing", "machine.toml")
NUMBER = re.compile(r"(?<=[XYZIJK])-?\d+\.?\d*")


def without_coordinates(text):
    text = re.sub(r"\(Output Time:.*\)", "", text)
    return [NUMBER.sub("#", line) for line in text.splitlines()]


ONLY_COORDINATES = re.compile(r"^(G[123] )?([XYZIJK]# ?)+$")


def added_blocks(plain, text):
    """Blocks of `text` beside those of `plain`, which it has all and in their order, coordinates aside."""
    wanted, added = without_coordinates(plain), []
    for line in without_coordinates(text):
        if wanted and line == wanted[0]:
            wanted.pop(0)
        else:
            added.append(line)
    assert not wanted, "not in the new program: %s" % wanted
    return added


def without_times(figures):
    return {key: value for key, value in figures.items() if key != "compute_s"}


class AddOn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.job = path_job.make(apart_mm=8, rpm=2000)
        cls.folder = tempfile.mkdtemp()
        settings.prepare(cls.job)

    def setUp(self):
        self.job.CamberMachine = MACHINE
        self.job.CamberMaterial = "C45"
        self.job.CamberVoxel = 0.8
        self.job.CamberForceLimit = 0
        self.job.CamberTolerance, self.job.CamberGoal, self.job.CamberLevers = 20, "tolerance", "shift"
        self.job.PostProcessor, self.job.PostProcessorArgs = "linuxcnc", "--no-show-editor"
        for controller in self.job.Tools.Group:
            controller.CamberOverhang = 12 if controller.ToolNumber == 1 else 20
            controller.CamberHolder = ""

    def files(self, name):
        folder = os.path.join(self.folder, name)
        os.makedirs(folder, exist_ok=True)
        return job_files.write(self.job, folder)

    def command_line(self, *arguments):
        return subprocess.run([run.executable(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              universal_newlines=True)

    def test_job_is_what_the_document_says(self):
        files = self.files("written")
        with open(files.toml) as file:
            text = file.read()
        self.assertIn("box_mm = [[-1.000000, -1.000000, -7.000000], [25.000000, 19.000000, 1.000000]]", text)
        self.assertIn("[tool.1]\nfrom = 1\nflutes = 4\noverhang_mm = 12.000000\nflute_length_mm = 12.000000\n"
                      "helix_deg = 30\nroot_stiffness_N_per_um = 20.000000\n", text)
        self.assertIn('goal = "tolerance"\nlevers = ["shift"]\n', text)
        self.job.CamberLevers = "shift,feed"
        with open(self.files("feeds").toml) as file:
            self.assertNotIn("levers", file.read())
        self.assertEqual([span.label for span in files.spans],
                         ["G54", "TC: 6mm Ball End", "Surface", "TC: 5mm Endmill", "Pocket", "Profile"])
        self.assertEqual(operations.operation_at(files.spans, files.spans[2].first + 3).Label, "Surface")
        self.assertIsNone(operations.operation_at(files.spans, files.spans[1].first))
        shown = self.command_line("--effective-config", "predict", files.toml, "-o", self.folder + "/none").stdout
        self.assertIn("type = \"flat\"", shown)
        self.assertIn("type = \"ball\"", shown)
        self.assertIn("diameter_mm = 6", shown)
        self.assertIn("shank_diameter_mm = 3", shown)

    def test_prediction_equals_the_command_line(self):
        files = self.files("predict")
        target = os.path.join(files.folder, "predicted")
        seen = []
        started = run.Run(files, "predict", target).start()
        outcome = started.wait()
        self.assertEqual(outcome.status, 0, outcome.output)
        other = os.path.join(files.folder, "other.json")
        done = self.command_line("predict", files.toml, "-o", os.path.join(files.folder, "other"), "--json", other)
        self.assertEqual(done.returncode, 0, done.stdout)
        with open(other) as file:
            self.assertEqual(without_times(outcome.figures), without_times(json.load(file)))
        mesh = results.read_mesh(results.mesh_path(target))
        self.assertGreater(len(mesh.triangles), 1000)
        self.assertEqual(mesh.points.shape, mesh.normals.shape)
        self.assertAlmostEqual(mesh.full_um, outcome.figures["form_error_um"]["p95"], 2)
        places = results.worst_places(mesh, lambda line: operations.operation_at(files.spans, line))
        self.assertLessEqual({place.operation.Label for place in places if place.operation},
                             {"Surface", "Pocket", "Profile"})
        self.assertTrue(any(place.operation for place in places))
        self.assertGreaterEqual(abs(places[0].error_um), abs(places[-1].error_um))
        self.assertLessEqual({"Pocket", "Surface"}, set(results.by_operation(mesh, files.spans)))

    def test_module_gives_the_same(self):
        if run.module() is None:
            self.skipTest("no module camber")
        files = self.files("module")
        kept, run.executable = run.executable, lambda: None
        try:
            target = os.path.join(files.folder, "predicted")
            started = run.Run(files, "predict", target).start()
            outcome = started.wait()
        finally:
            run.executable = kept
        self.assertEqual(outcome.status, 0, outcome.output)
        self.assertEqual((started.what, started.fraction), ("done", 1))
        done = self.command_line("predict", files.toml, "-o", os.path.join(files.folder, "other"), "--json",
                                 os.path.join(files.folder, "other.json"))
        with open(os.path.join(files.folder, "other.json")) as file:
            self.assertEqual(without_times(outcome.figures), without_times(json.load(file)))

    def test_post_moves_coordinates_only(self):
        self.assertIn("camber", PathPreferences.allAvailablePostProcessors())
        command = PathPost.CommandPathPost()
        plain = command.exportObjectsWith(command.buildPostList(self.job)[0], self.job, False)[1]
        target = os.path.join(self.folder, "posted.nc")
        self.job.PostProcessor = "camber"
        self.job.PostProcessorArgs = "--post linuxcnc --no-show-editor --overhang 1=12 --keep %s/kept" % self.folder
        self.job.PostProcessorOutputFile = target
        failed, text, name = command.exportObjectsWith(command.buildPostList(self.job)[0], self.job)
        self.assertFalse(failed)
        self.assertEqual(name, target)
        with open(target) as file:
            self.assertEqual(file.read(), text)
        self.assertNotEqual(plain, text)
        for line in added_blocks(plain, text):  # blocks are split where their ends must move apart
            self.assertRegex(line, ONLY_COORDINATES)
        # The command line, given the same files, makes the same program.
        other = os.path.join(self.folder, "other.nc")
        self.command_line("compensate", self.folder + "/kept/job.toml", "-o", other)
        with open(other, newline="") as file:
            self.assertEqual(file.read(), text)

    def test_post_falls_back_with_a_message(self):
        command = PathPost.CommandPathPost()
        objects = command.buildPostList(self.job)[0]
        plain = command.exportObjectsWith(objects, self.job, False)[1]
        said = []
        self.job.CamberMachine = ""
        text = post.export(objects, "-", "--post linuxcnc --no-show-editor", said.append)
        self.assertEqual(without_coordinates(text), without_coordinates(plain))
        self.assertEqual(said, ["Camber: The machine file is missing: set the property CamberMachine of the job (group "
                                "Camber). The program is written as it is."])
        said.clear()
        text = post.export(objects, "-", "--post linuxcnc --machine %s --material chalk" % MACHINE, said.append)
        self.assertEqual(without_coordinates(text), without_coordinates(plain))
        self.assertEqual(said[-1], "Camber: The program is written as it is.")
        self.assertTrue(any("chalk" in line for line in said), said)
        with self.assertRaisesRegex(job_files.JobProblem, "invalid choice: 'dance'"):
            post.export(objects, "-", "--do dance", said.append)

    def test_post_adapts_feeds(self):
        self.job.CamberForceLimit = 150
        self.job.CamberVoxel = 0.5  # at 0.8 chips and stock lose 3.1 % apart, and adapt refuses
        command = PathPost.CommandPathPost()
        objects = command.buildPostList(self.job)[0]
        plain = command.exportObjectsWith(objects, self.job, False)[1]
        said = []
        text = post.export(objects, "-", "--do adapt --post linuxcnc --no-show-editor", said.append)
        self.assertFalse([line for line in said if "as it is" in line], said)
        moves = lambda t: [re.findall(r"[XYZ]-?[\d.]+", line) for line in t.splitlines() if re.search(r"G[123] ", line)]
        self.assertNotEqual(re.findall(r"F[\d.]+", plain), re.findall(r"F[\d.]+", text))
        self.assertLessEqual(len(moves(plain)), len(moves(text)))  # blocks may be split

    def test_messages_name_the_operation(self):
        surface = [obj for obj in self.job.Operations.Group if obj.Label == "Surface"][0]
        kept = surface.Gcode
        surface.Gcode = kept[:1] + ["G1 X-4 Y1 Z0 F8", "G0 X28 Y1 Z-3"] + kept[3:]
        self.job.Document.recompute()
        try:
            files = self.files("through")
            outcome = run.Run(files, "predict", os.path.join(files.folder, "predicted")).start().wait()
        finally:
            surface.Gcode = kept
            self.job.Document.recompute()
        self.assertEqual(outcome.status, 1)
        named = [m for m in outcome.messages if m.operation is not None]
        self.assertTrue(named, outcome.output)
        self.assertTrue(str(named[0]).startswith("Operation 'Surface': "), str(named[0]))

    def test_run_can_be_cancelled(self):
        self.job.CamberVoxel = 0.1
        files = self.files("cancelled")
        started = run.Run(files, "compensate", os.path.join(files.folder, "out.nc")).start()
        started.cancel()
        self.assertIsNone(started.wait().status)
        self.assertFalse(os.path.exists(os.path.join(files.folder, "out.nc")))

    def test_settings_that_are_missing_are_named(self):
        for name in run.MATERIALS:
            self.job.CamberMaterial = name
            self.assertEqual(run.problems_of_job(self.files("material").toml), "", name)
        self.job.CamberMaterial = ""
        with self.assertRaisesRegex(settings.MissingSetting, "The material is missing"):
            self.files("none")
        self.job.CamberMaterial, self.job.CamberMachine = "C45", "/no/machine.toml"
        with self.assertRaisesRegex(settings.MissingSetting, "The machine file /no/machine.toml is missing"):
            self.files("none")
        self.assertIn("preset:vmc-40", run.machine_presets())
        self.job.CamberMachine = "preset:vmc-40"
        with open(self.files("preset").toml) as file:
            self.assertIn('machine = "preset:vmc-40"', file.read())

    def test_holders(self):
        controller = self.job.Tools.Group[0]
        controller.CamberHolder = "28, 28, 17.5; 28, 40, 5"
        with open(self.files("holder").toml) as file:
            self.assertIn("holder_mm = [[28.000000, 28.000000, 17.500000], [28.000000, 40.000000, 5.000000]]",
                          file.read())
        path = os.path.join(self.folder, "nut.fcholder")
        with open(path, "w") as file:
            json.dump({"units": "mm", "profile": [[0, 0], [12.9, 0], [14.0, 1.1], [14.0, 17.5], [0, 17.5]]}, file)
        self.assertEqual([[round(v, 6) for v in row] for row in tools.holder_rows(path, self.job)],
                         [[25.8, 28.0, 1.1], [28.0, 28.0, 16.4]])
        controller.CamberHolder = "28, 28"
        with self.assertRaisesRegex(tools.ToolProblem, "Holder '28, 28': \"lower diameter, upper diameter, length\""):
            self.files("none")

    def test_document_keeps_the_settings(self):
        path = os.path.join(self.folder, "kept.FCStd")
        document = self.job.Document
        document.saveCopy(path)
        opened = FreeCAD.openDocument(path)
        job = compat.jobs_of(opened)[0]
        self.assertEqual(job.CamberMaterial, "C45")
        self.assertEqual(job.Tools.Group[0].CamberOverhang.Value, 12)
        FreeCAD.closeDocument(opened.Name)
        FreeCAD.setActiveDocument(document.Name)


result = unittest.TextTestRunner(verbosity=2, stream=sys.stderr).run(
    unittest.defaultTestLoader.loadTestsFromTestCase(AddOn))
sys.stderr.flush()
os._exit(0 if result.wasSuccessful() else 1)
