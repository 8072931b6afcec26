"""A job made by script: a block with a pocket, its profile, and its top finished by a ball end mill."""
import FreeCAD
import Part
import PathScripts.PathCustom as PathCustom
import PathScripts.PathJob as PathJob
import PathScripts.PathPocketShape as PathPocket
import PathScripts.PathProfile as PathProfile
import PathScripts.PathToolBit as PathToolBit
import PathScripts.PathToolController as PathToolController

BITS = FreeCAD.getHomePath() + "Mod/Path/Tools/Bit/"


def controller(job, number, bit, feed_mm_per_min, rpm):
    if number == 1:
        out = job.Tools.Group[0]
    else:
        out = PathToolController.Create("TC%d" % number)
        job.Proxy.addToolController(out)
    out.Tool = PathToolBit.Factory.CreateFrom(BITS + bit)
    out.ToolNumber = number
    out.Label = "TC: %s" % out.Tool.Label
    out.HorizFeed = "%g mm/min" % feed_mm_per_min
    out.VertFeed = "%g mm/min" % (feed_mm_per_min / 2)
    out.SpindleSpeed = rpm
    out.SpindleDir = "Forward"
    return out


def raster(apart_mm):
    """Rows along X over the top; feeds of a path are in mm/s."""
    lines = ["G0 X-4 Y1 Z5"]
    for row in range(int(16 / apart_mm) + 1):
        ends = (-4, 28) if row % 2 == 0 else (28, -4)
        y = 1 + row * apart_mm
        lines += ["G1 X%g Y%g Z0 F8" % (ends[0], y), "G1 X%g Y%g Z0 F8" % (ends[1], y)]
    return lines + ["G0 Z5"]


def make(name="Part", apart_mm=1.0, rpm=6000):
    doc = FreeCAD.newDocument(name)
    block = Part.makeBox(24, 18, 6, FreeCAD.Vector(0, 0, -6)).cut(
        Part.makeBox(12, 9, 2, FreeCAD.Vector(6, 4.5, -2)))
    model = doc.addObject("Part::Feature", "Block")
    model.Shape = block
    job = PathJob.Create("Job", [model], None)
    doc.recompute()
    mill = controller(job, 1, "5mm_Endmill.fctb", 480, rpm)
    # While there is one tool controller: with two, FreeCAD asks on the screen which an operation takes.
    top = PathCustom.Create("Surface")
    top.Gcode = raster(apart_mm)
    solid = job.Model.Group[0]
    floor = [i for i, face in enumerate(solid.Shape.Faces) if abs(face.BoundBox.ZMax + 2) < 1e-6][0]
    pocket = PathPocket.Create("Pocket")
    pocket.Base = [(solid, ["Face%d" % (floor + 1)])]
    profile = PathProfile.Create("Profile")
    top.ToolController = controller(job, 2, "6mm_Ball_End.fctb", 480, rpm)
    for operation in (pocket, profile):
        operation.ToolController = mill
    doc.recompute()
    for operation, step in ((pocket, 1), (profile, 4)):
        operation.setExpression("StepDown", None)
        operation.StepDown = step
    profile.setExpression("FinalDepth", None)
    profile.FinalDepth = -6
    doc.recompute()
    job.PostProcessor = "linuxcnc"
    job.PostProcessorArgs = "--no-show-editor"
    return job
