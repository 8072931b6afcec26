"""freecadcmd make_job.py: a Path job made by script, predicted and compensated through the add-on, without a screen.

The block has a pocket, its profile, and a top that a ball end mill finishes. Writes block.FCStd, block.nc (the plain
program) and block.compensated.nc to the folder out/19-freecad of the current folder.
"""
import os
import sys

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "..", "addons", "freecad"))  # unless the add-on is installed
sys.path.insert(0, os.path.join(HERE, "..", "..", "tests", "freecad"))

import path_job  # the job of the tests
from camber_freecad import compat, post, settings

OUT = os.path.abspath("out/19-freecad")
os.makedirs(OUT, exist_ok=True)
job = path_job.make("Block")
settings.prepare(job)
job.CamberMachine = os.path.abspath(os.path.join(HERE, "..", "01-finishing", "machine.toml"))
job.CamberMaterial = "C45"
job.CamberVoxel = 0.2
for controller in job.Tools.Group:
    controller.CamberOverhang = 25 if controller.ToolNumber == 1 else 40
job.Document.saveAs(os.path.join(OUT, "block.FCStd"))

objects = compat.post_list(job)
with open(os.path.join(OUT, "block.nc"), "w") as file:
    file.write(compat.run_post("linuxcnc", "--no-show-editor", job, objects))
post.export(objects, os.path.join(OUT, "block.compensated.nc"), "--post linuxcnc --no-show-editor --keep %s/files" % OUT)
print("written to " + OUT)
os._exit(0)
