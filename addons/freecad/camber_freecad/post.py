"""The work of camber_post.py: the user's own post-processor, then Camber."""
import argparse
import os
import shlex
import shutil
import tempfile

from . import compat, job_files, run, settings, tools


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        raise job_files.JobProblem("Arguments of the post-processor camber: %s" % message)


def parser():
    out = _Parser(prog="camber", add_help=False)
    out.add_argument("--post", default="", help="the post-processor that makes the program, for example linuxcnc")
    out.add_argument("--do", choices=("compensate", "adapt", "predict"), default="compensate",
                     help="compensate (the default): the path is moved against the deflection of the tool; adapt: the "
                          "feeds follow the load; predict: the program stays as it is")
    out.add_argument("--machine", help="machine file of Camber")
    out.add_argument("--material", help="name of a material preset, or a file with a [material] table")
    out.add_argument("--tolerance-um", type=float, help="tolerance of the surface")
    out.add_argument("--goal", choices=("best", "tolerance"),
                     help="tolerance: stop where it is reached, which is sooner")
    out.add_argument("--levers", choices=("shift,feed", "shift"), help="shift: the feeds stay as they are")
    out.add_argument("--voxel-mm", type=float, help="width of the voxels")
    out.add_argument("--force-limit-N", type=float, help="of adapt")
    out.add_argument("--power-limit-W", type=float, help="of adapt")
    out.add_argument("--overhang", action="append", default=[], metavar="T=MM",
                     help="holder face to tip of a tool, for example 1=32.5; may be repeated")
    out.add_argument("--report", action="store_true", help="write the report page beside the program")
    out.add_argument("--keep", metavar="FOLDER", help="keep the files that Camber is given in this folder")
    return out


def parse(argstring):
    """Camber's options, and the arguments that go to the other post-processor."""
    options, others = parser().parse_known_args(shlex.split(argstring or ""))
    return options, " ".join(shlex.quote(word) for word in others if word != "--")


def default_post():
    """Of the preferences; else linuxcnc."""
    name = compat.preferences().defaultPostProcessor()
    return name if name and name != "camber" else "linuxcnc"


def _take(options, job):
    """Settings given as arguments count before those of the document, and are stored there."""
    settings.prepare(job)
    for name, value in (("CamberMachine", options.machine), ("CamberMaterial", options.material),
                        ("CamberTolerance", options.tolerance_um), ("CamberGoal", options.goal),
                        ("CamberLevers", options.levers), ("CamberVoxel", options.voxel_mm),
                        ("CamberForceLimit", options.force_limit_N), ("CamberPowerLimit", options.power_limit_W)):
        if value is not None:
            setattr(job, name, value)
    for text in options.overhang:
        number, _, length = text.partition("=")
        controllers = [c for c in job.Tools.Group if str(int(c.ToolNumber)) == number.strip().lstrip("T")]
        try:
            value = float(length)
        except ValueError:
            value = 0.0
        if not controllers or value <= 0:
            raise job_files.JobProblem("--overhang %s: the number of a tool of the job and a length in mm were expected, "
                                       "as in 1=32.5" % text)
        for controller in controllers:
            controller.CamberOverhang = value


def _job_of(objects):
    for obj in objects:
        job = compat.job_of(obj)
        if job is not None:
            return job
    return None


class Result:
    """text: the program to write; said: what the user should read; done: whether Camber has done its work."""

    def __init__(self, text, said, done):
        self.text, self.said, self.done = text, said, done


def export(objects, filename, argstring, say=print):
    """As a post-processor's export: returns the program and writes it to `filename`, unless that is "-".

    Where Camber refuses, the program is that of the other post-processor, and `say` is told why.
    """
    options, others = parse(argstring)
    name = options.post or default_post()
    if name == "camber":
        raise job_files.JobProblem("--post camber: the name of another post-processor was expected")
    job = _job_of(objects)
    plain = compat.run_post(name, others, job, objects)
    if plain is None:
        return None
    result = _camber(options, job, objects, plain, filename)
    for line in result.said:
        say(line)
    if filename and filename != "-":
        with open(filename, "w", encoding="utf8", newline="") as file:
            file.write(result.text)
    return result.text


def _camber(options, job, objects, plain, filename):
    if job is None:
        return Result(plain, ["Camber: these objects belong to no job. The program is written as it is."], False)
    folder = options.keep or tempfile.mkdtemp(prefix="camber-")
    os.makedirs(folder, exist_ok=True)
    try:
        return _run(options, job, objects, plain, filename, folder)
    except (settings.MissingSetting, job_files.JobProblem, tools.ToolProblem, run.NoCamber, OSError) as problem:
        return Result(plain, ["Camber: %s. The program is written as it is." % str(problem).rstrip(".")], False)
    finally:
        if not options.keep:
            shutil.rmtree(folder, ignore_errors=True)


def _run(options, job, objects, plain, filename, folder):
    _take(options, job)
    files = job_files.write(job, folder, objects=objects, program=plain)
    said = ["Camber: " + note for note in files.notes]
    target = os.path.join(folder, "predicted" if options.do == "predict" else "made.nc")
    more = []
    if options.report and options.do != "predict":
        more = ["--report", os.path.join(folder, "report.html")]
    outcome = run.Run(files, options.do, target, more).start().wait()
    said += ["Camber: %s" % message for message in outcome.messages]
    if options.report and filename and filename != "-":
        page = os.path.join(target, "report.html") if options.do == "predict" else os.path.join(folder, "report.html")
        if os.path.exists(page):
            shutil.copy(page, os.path.splitext(filename)[0] + ".camber.html")
    if options.do == "predict":
        if outcome.figures:
            said.append("Camber: " + summary(outcome.figures))
        return Result(plain, said + _reasons(outcome), outcome.ok)
    if outcome.status in (0, 3) and os.path.exists(target):
        with open(target, encoding="utf8", newline="") as file:
            text = file.read()
        return Result(text, said + _reasons(outcome) + ["Camber: " + summary(outcome.figures)], outcome.ok)
    return Result(plain, said + _reasons(outcome) + ["Camber: The program is written as it is."], False)


def _reasons(outcome):
    return ["Camber: " + reason for reason in outcome.reasons]


def summary(figures):
    """One sentence."""
    before, after = figures.get("before_um"), figures.get("after_um")
    if before and after:
        return "form error, 95th percentile: %.1f um before, %.1f um after" % (before["p95"], after["p95"])
    if "form_error_um" in figures and isinstance(figures["form_error_um"], dict):
        return "form error, 95th percentile: %.1f um" % figures["form_error_um"]["p95"]
    return "done"
