"""Tool controllers of a job as a tool library of FreeCAD (.fctl, .fctb), which Camber reads as it stands."""
import json
import os
import re

from . import settings

# Kinds of old tools (Path.Tool) and the shapes of tool bits.
LEGACY_SHAPES = {"EndMill": "endmill", "BallEndMill": "ballend", "ChamferMill": "chamfer", "Drill": "drill",
                 "CenterDrill": "drill", "CounterSink": "chamfer", "SlotCutter": "endmill", "Engraver": "v-bit",
                 "CornerRound": "radius", "Reamer": "reamer", "Tap": "tap"}
# Properties of a tool bit that are not sizes of the cutter.
NO_SIZES = {"ExpressionEngine", "Label", "Label2", "Placement", "Proxy", "Shape", "Visibility", "BitBody", "BitShape",
            "BitPropertyNames", "File", "ShapeName", "ShapeID", "ShapeType", "ToolBitID"}
TYPICAL_OVERHANG_DIAMETERS = 4
TYPICAL_CLEAR_OF_CUT_MM = 5


class ToolProblem(Exception):
    """A tool that Camber cannot use, in the user's words."""


def _shape(bit):
    for name in ("ShapeID", "ShapeName", "BitShape", "ShapeType"):
        value = getattr(bit, name, "")
        if value:
            return os.path.splitext(os.path.basename(str(value)))[0]
    return ""


def _text(value):
    """Independent of the language and the unit system that FreeCAD shows."""
    unit = getattr(value, "Unit", None)
    if unit is None:
        return str(value)
    kind = getattr(unit, "Type", "")
    return "%.9g %s" % (value.Value, "deg" if kind == "Angle" else "mm") if kind in ("Length", "Angle") else None


def bit_of(controller):
    """What a .fctb file of the controller's tool says."""
    tool = controller.Tool
    if tool is None:
        raise ToolProblem("Tool controller '%s' has no tool" % controller.Label)
    if hasattr(tool, "ToolType"):  # an old tool, without a document object of its own
        sizes = {"Diameter": "%.9g mm" % tool.Diameter}
        for name, value in (("CuttingEdgeHeight", tool.CuttingEdgeHeight), ("FlatRadius", tool.FlatRadius)):
            if value > 0:
                sizes[name] = "%.9g mm" % value
        if tool.CuttingEdgeAngle and tool.ToolType in ("Drill", "CenterDrill"):
            sizes["TipAngle"] = "%.9g deg" % tool.CuttingEdgeAngle
        elif tool.CuttingEdgeAngle:
            sizes["CuttingEdgeAngle"] = "%.9g deg" % tool.CuttingEdgeAngle
        return {"version": 2, "name": tool.Name, "shape": LEGACY_SHAPES.get(tool.ToolType, tool.ToolType) + ".fcstd",
                "parameter": sizes, "attribute": {}}
    sizes = {}
    for name in tool.PropertiesList:
        if name in NO_SIZES:
            continue
        text = _text(getattr(tool, name))
        if text is not None:
            sizes[name] = text
    stickout = sizes.pop("btl_stickout", None) or sizes.pop("Stickout", None)
    return {"version": 2, "name": tool.Label, "shape": _shape(tool) + ".fcstd", "parameter": sizes,
            "attribute": {"btl-stickout": stickout} if stickout else {}}


def diameter_mm(controller):
    return settings.number(controller.Tool.Diameter)


def holder_rows(text, job):
    """Rows of lower diameter, upper diameter, length."""
    if not text.strip():
        return []
    path = settings.file_or_name(job, text.strip())
    if path.endswith(".fcholder"):
        return _rows_of_profile(path)
    rows = []
    for part in text.split(";"):
        numbers = [float(word) for word in re.findall(r"[-+.\d]+", part)]
        if not numbers:
            continue
        if len(numbers) != 3 or min(numbers) <= 0:
            raise ToolProblem("Holder '%s': \"lower diameter, upper diameter, length\" was expected" % part.strip())
        rows.append(numbers)
    return rows


def _rows_of_profile(path):
    """A .fcholder: points [radius, height] of the holder's outline, from its face up."""
    try:
        with open(path, encoding="utf8") as file:
            data = json.load(file)
        points = [(float(r), float(z)) for r, z in data["profile"]]
    except (OSError, ValueError, KeyError, TypeError) as problem:
        raise ToolProblem("Holder file %s cannot be read: %s" % (path, problem))
    unit = 25.4 if str(data.get("units", "mm")).lower() in ("in", "inch", "inches") else 1.0
    rows = []
    for (r0, z0), (r1, z1) in zip(points, points[1:]):
        if z1 > z0 and max(r0, r1) > 0:
            rows.append([2 * unit * max(r0, 1e-3), 2 * unit * max(r1, 1e-3), unit * (z1 - z0)])
    return rows


def _flutes(bit):
    try:
        return int(float(bit["parameter"].get("Flutes", "0") or 0))
    except ValueError:
        return 0


def _given(bit, name):
    return float(bit["parameter"].get(name, "0").split()[0] or 0)


def write(job, folder, depth_mm):
    """Writes tools.fctl with its bits, and returns the [tool.N] tables of the job and what in them is typical.

    depth_mm: of the deepest cut below the top of the stock.
    """
    entries, tables, notes = [], [], []
    numbers = {}
    for controller in job.Tools.Group:
        number = int(controller.ToolNumber)
        bit = bit_of(controller)
        if number in numbers:
            if numbers[number] != bit["parameter"]:
                raise ToolProblem("T%d is two different tools: '%s' is one of them" % (number, controller.Label))
            continue
        numbers[number] = bit["parameter"]
        name = "T%d.fctb" % number
        with open(os.path.join(folder, name), "w", encoding="utf8") as file:
            json.dump(bit, file, indent=2, ensure_ascii=False)
        entries.append({"nr": number, "path": name})
        tables.append(_table(job, controller, bit, number, depth_mm, notes))
    with open(os.path.join(folder, "tools.fctl"), "w", encoding="utf8") as file:
        json.dump({"label": job.Label, "tools": entries, "version": 1}, file, indent=2)
    return "".join(tables), notes


def _table(job, controller, bit, number, depth_mm, notes):
    out = "\n[tool.%d]\nfrom = %d\n" % (number, number)
    typical = []
    shape = bit["shape"]
    if _flutes(bit) < 1:
        flutes = 2 if shape.startswith(("ballend", "drill")) else 4
        out += "flutes = %d\n" % flutes
        typical.append("%d flutes" % flutes)
    overhang = settings.number(controller.CamberOverhang)
    if overhang <= 0 and not bit["attribute"].get("btl-stickout"):
        edge = _given(bit, "CuttingEdgeHeight")
        overhang = max(TYPICAL_OVERHANG_DIAMETERS * diameter_mm(controller),
                       max(depth_mm, edge) + TYPICAL_CLEAR_OF_CUT_MM)
        typical.append("overhang %.4g mm" % overhang)
    if overhang > 0:
        out += "overhang_mm = %.6f\n" % overhang
        if 0 < overhang < _given(bit, "CuttingEdgeHeight"):
            out += "flute_length_mm = %.6f\n" % overhang
    if not shape.startswith(("drill", "chamfer", "v-bit", "vbit")):
        out += "helix_deg = %.6g\n" % settings.number(controller.CamberHelix)
    if controller.CamberRootStiffness > 0:
        out += "root_stiffness_N_per_um = %.6f\n" % controller.CamberRootStiffness
    rows = holder_rows(controller.CamberHolder, job)
    if rows:
        out += "holder_mm = [%s]\n" % ", ".join("[%.6f, %.6f, %.6f]" % tuple(row) for row in rows)
    if typical:
        notes.append("T%d (%s): %s assumed; set them in the tool controller" % (number, controller.Label,
                                                                              " and ".join(typical)))
    return out
