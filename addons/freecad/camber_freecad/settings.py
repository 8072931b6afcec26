"""What a job does not say itself, asked once and stored in the document: properties of the group "Camber"."""
import os

GROUP = "Camber"
PRESET = "preset:"  # before a class of machines

# name, type, default, description. Of the job.
JOB_PROPERTIES = [
    ("CamberMachine", "App::PropertyFile", "", "Machine file of Camber, or a class of machines (preset:vmc-40)"),
    ("CamberMaterial", "App::PropertyString", "", "Material: the name of a preset, or a file with a [material] table"),
    ("CamberVoxel", "App::PropertyLength", 0.0, "Width of the voxels; 0: chosen by the size of the stock"),
    ("CamberTolerance", "App::PropertyFloat", 5.0, "Tolerance of the surface in micrometres"),
    ("CamberGoal", "App::PropertyEnumeration", ["best", "tolerance"],
     "Compensate until no round helps any more (best), or until the tolerance is reached: sooner"),
    ("CamberLevers", "App::PropertyEnumeration", ["shift,feed", "shift"],
     "Compensate: move the path and lower feeds where that pays (shift,feed), or move the path alone (shift)"),
    ("CamberForceLimit", "App::PropertyFloat", 0.0, "Adapt feeds: largest force across the tool in N; 0: not limited"),
    ("CamberPowerLimit", "App::PropertyFloat", 0.0, "Adapt feeds: largest power of the cut in W; 0: not limited"),
    ("CamberWorkOffset", "App::PropertyString", "",
     "Program zero in machine coordinates, \"x y z\" in mm, for the travel of the axes; empty: travel is not checked"),
]
# Of a tool controller. The tool bit may have the same sizes; these count.
TOOL_PROPERTIES = [
    ("CamberOverhang", "App::PropertyLength", 0.0, "Holder face to tip; 0: a typical length"),
    ("CamberHelix", "App::PropertyAngle", 30.0, "Helix angle of the flutes"),
    ("CamberRootStiffness", "App::PropertyFloat", 20.0, "Lateral stiffness of holder and spindle, N per micrometre"),
    ("CamberHolder", "App::PropertyString", "",
     "Holder: rows \"lower diameter, upper diameter, length; ...\" from its face up, or a .fcholder file"),
]


class MissingSetting(Exception):
    """A setting that only the user knows; `name` is its property."""

    def __init__(self, name, what):
        super().__init__("%s is missing: set the property %s of the job (group %s)" % (what, name, GROUP))
        self.name = name


def add_properties(obj, properties):
    for name, kind, default, description in properties:
        if name in obj.PropertiesList:
            continue
        obj.addProperty(kind, name, GROUP, description)
        if default:
            setattr(obj, name, default)


def prepare(job):
    """Gives the job and its tool controllers their properties. Values that are there stay."""
    add_properties(job, JOB_PROPERTIES)
    for controller in job.Tools.Group:
        add_properties(controller, TOOL_PROPERTIES)


def number(value):
    """Of a property: quantities in mm and degrees."""
    return float(getattr(value, "Value", value))


def file_or_name(job, text):
    """A path beside the document where there is such a file; else the text itself."""
    if not text or os.path.isabs(text):
        return text
    beside = os.path.join(os.path.dirname(job.Document.FileName or ""), text)
    return os.path.abspath(beside) if os.path.exists(beside) else text


def check(job):
    """The first setting that is missing, or a file that is not there. Raises MissingSetting."""
    prepare(job)
    machine = file_or_name(job, job.CamberMachine)
    if not machine:
        raise MissingSetting("CamberMachine", "The machine file")
    if not machine.startswith(PRESET) and not os.path.isfile(machine):
        raise MissingSetting("CamberMachine", "The machine file %s" % machine)
    if not job.CamberMaterial:
        raise MissingSetting("CamberMaterial", "The material")
