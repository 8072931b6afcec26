"""The files of a Path job for Camber: program, tools, stock, model and job.toml in one folder."""
import json
import os

from . import compat, operations, run, settings, stock, tools

PROGRAM = "program.nc"
RADIAL_RATIO = 0.4  # typical, of the radial to the tangential force


class JobProblem(Exception):
    """A job that cannot be given to Camber, in the user's words."""


class JobFiles:
    """What stands in the folder, and what is known about it."""

    def __init__(self, job, folder):
        self.job, self.folder = job, folder
        self.program = ""   # text as the post-processor made it
        self.spans = []     # lines of each operation
        self.notes = []     # assumptions that the user should check

    @property
    def toml(self):
        return os.path.join(self.folder, "job.toml")

    @property
    def program_path(self):
        return os.path.join(self.folder, PROGRAM)


def _post(job, name, arguments):
    name = name or job.PostProcessor
    if name == "camber":  # its own arguments name the other one
        from . import post
        options, arguments = post.parse(job.PostProcessorArgs)
        name = options.post or post.default_post()
    if not compat.post_exists(name):
        raise JobProblem("There is no post-processor '%s'" % name)
    return name, arguments


def _lowest_z(objects):
    lowest = 0.0
    for obj in objects:
        if operations.is_operation(obj):
            for command in obj.Path.Commands:
                if command.Name in ("G1", "G01", "G2", "G02", "G3", "G03") and "Z" in command.Parameters:
                    lowest = min(lowest, command.Parameters["Z"])
    return lowest


def write(job, folder, post=None, arguments=None, objects=None, program=None):
    """Writes the files. `program`: its text, where it is there already; else the job's own post-processor makes it.
    Raises MissingSetting, JobProblem, ToolProblem."""
    settings.check(job)
    out = JobFiles(job, folder)
    objects = objects if objects is not None else compat.post_list(job)
    if program is None:
        name, arguments = _post(job, post, job.PostProcessorArgs if arguments is None else arguments)
        program = compat.run_post(name, arguments, job, objects)
        if not program:
            raise JobProblem("The post-processor '%s' made no program; see the report view" % name)
    if job.Stock is None or not hasattr(job.Stock, "Shape") or job.Stock.Shape.Volume <= 0:
        raise JobProblem("The job has no stock")
    out.program = program
    with open(out.program_path, "w", encoding="utf8", newline="") as file:
        file.write(program)
    out.spans = operations.spans_of(program, objects)
    box = job.Stock.Shape.BoundBox
    tables, out.notes = tools.write(job, folder, max(0.0, box.ZMax - _lowest_z(objects)))
    if len(set(job.Fixtures)) > 1:
        out.notes.append("The job has the fixtures %s; Camber sees one part, in the coordinates of the document" %
                         ", ".join(job.Fixtures))
    others = (stock.stock_table(job.Stock.Shape, folder) + stock.part_table(job, folder) + _simulation(job, box) +
              _compensation(job) + _adapt(job))
    # Most presets give the tangential force alone; those that give all do not take the ratio of the radial one.
    for radial in (True, False):
        with open(out.toml, "w", encoding="utf8") as file:
            file.write(_head(job) + tables + _material(job, radial) + others)
        if "krc_ratio does not belong" not in run.problems_of_job(out.toml):
            break
    return out


def _quoted(text):
    return json.dumps(text.replace("\\", "/"))


def _head(job):
    machine = settings.file_or_name(job, job.CamberMachine)
    return ("# Made by the FreeCAD add-on from the job '%s'.\nprogram = \"%s\"\nmachine = %s\ntools = \"tools.fctl\"\n" %
            (job.Label.replace("\n", " "), PROGRAM,
             _quoted(machine if machine.startswith(settings.PRESET) else os.path.abspath(machine))))


def _material(job, radial):
    text = settings.file_or_name(job, job.CamberMaterial)
    if os.path.isfile(text):
        return "\n[material]\nfile = %s\n" % _quoted(text)
    return "\n[material]\npreset = %s\n%s" % (_quoted(text), "krc_ratio = %g\n" % RADIAL_RATIO if radial else "")


def _simulation(job, box):
    return "\n[simulation]\nvoxel_mm = %.6f\n" % (settings.number(job.CamberVoxel) or stock.voxel_mm(box))


def _compensation(job):
    out = "\n[compensation]\ntolerance_um = %.6f\ngoal = %s\n" % (job.CamberTolerance, _quoted(job.CamberGoal))
    if job.CamberLevers == "shift":  # the others are the default
        out += 'levers = ["shift"]\n'
    if job.CamberWorkOffset.strip():
        try:
            numbers = [float(word) for word in job.CamberWorkOffset.replace(",", " ").split()]
        except ValueError:
            numbers = []
        if len(numbers) != 3:
            raise JobProblem("CamberWorkOffset is '%s'; three numbers \"x y z\" in mm were expected" %
                             job.CamberWorkOffset)
        out += "work_offset_mm = [%s]\n" % ", ".join("%.6f" % n for n in numbers)
    return out


def _feeds(job):
    """The feeds of the program, in mm/min: a tenth of the smallest to three times the greatest."""
    feeds = [60 * settings.number(getattr(c, name)) for c in job.Tools.Group for name in ("HorizFeed", "VertFeed")]
    feeds = [f for f in feeds if f > 0]
    return (min(feeds) / 10, 3 * max(feeds)) if feeds else (10.0, 3000.0)


def _adapt(job):
    limits = [(key, value) for key, value in (("force_N", job.CamberForceLimit), ("power_W", job.CamberPowerLimit))
              if value > 0]
    if not limits:
        return ""
    return "\n[adapt]\nlimits = { %s }\nfeed_mm_per_min = [%.6f, %.6f]\n" % (
        ", ".join("%s = %.6f" % pair for pair in limits), *_feeds(job))
