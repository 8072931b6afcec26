"""Stock and model of a job for Camber."""
import os

import Mesh
import MeshPart
import Part

CHORD_MM = 0.01  # between the model and its triangles
TURN_RAD = 0.3


def box_of(shape):
    """[[x, y, z], [x, y, z]] of a box that lies along the axes; None for any other shape."""
    box = shape.BoundBox
    volume = box.XLength * box.YLength * box.ZLength
    if volume <= 0 or abs(shape.Volume - volume) > 1e-6 * volume:
        return None
    return [[box.XMin, box.YMin, box.ZMin], [box.XMax, box.YMax, box.ZMax]]


def cylinder_of(shape):
    """(base, diameter, height) of an upright cylinder; None for any other shape."""
    box = shape.BoundBox
    if abs(box.XLength - box.YLength) > 1e-6 * max(box.XLength, 1):
        return None
    if abs(shape.Volume - 0.25 * 3.141592653589793 * box.XLength ** 2 * box.ZLength) > 1e-6 * max(shape.Volume, 1):
        return None
    base = [(box.XMin + box.XMax) / 2, (box.YMin + box.YMax) / 2, box.ZMin]
    return base, box.XLength, box.ZLength


def write_stl(shape, path):
    mesh = MeshPart.meshFromShape(Shape=shape, LinearDeflection=CHORD_MM, AngularDeflection=TURN_RAD, Relative=False)
    mesh.harmonizeNormals()
    mesh.write(path)


def _row(point):
    return "[%s]" % ", ".join("%.6f" % value for value in point)


def stock_table(shape, folder):
    """The [stock] table; a shape that is neither a box nor a cylinder goes to stock.stl."""
    box = box_of(shape)
    if box:
        return "\n[stock]\nbox_mm = [%s, %s]\n" % (_row(box[0]), _row(box[1]))
    cylinder = cylinder_of(shape)
    if cylinder:
        return "\n[stock]\ncylinder = { base_mm = %s, diameter_mm = %.6f, height_mm = %.6f }\n" % (
            _row(cylinder[0]), cylinder[1], cylinder[2])
    write_stl(shape, os.path.join(folder, "stock.stl"))
    return "\n[stock]\nmesh = \"stock.stl\"\n"


def model_shape(job):
    """All models of the job as one shape; None where none of them is a solid."""
    shapes = [obj.Shape for obj in job.Model.Group if hasattr(obj, "Shape") and obj.Shape.Volume > 0]
    return Part.makeCompound(shapes) if shapes else None


def part_table(job, folder):
    """The [part] table, its mesh in part.stl."""
    shape = model_shape(job)
    meshes = [obj.Mesh for obj in job.Model.Group if hasattr(obj, "Mesh")]
    if shape is not None:
        write_stl(shape, os.path.join(folder, "part.stl"))
    elif meshes:
        whole = Mesh.Mesh()
        for mesh in meshes:
            whole.addMesh(mesh)
        whole.write(os.path.join(folder, "part.stl"))
    else:
        return ""
    return "\n[part]\nmesh = \"part.stl\"\n"


def voxel_mm(box):
    """By the size of the stock, so that it stays quick and fits the memory."""
    longest = max(box.XLength, box.YLength, box.ZLength)
    for limit, voxel in ((100, 0.1), (200, 0.2), (400, 0.3)):
        if longest <= limit:
            return voxel
    return 0.5
