"""What a prediction wrote: the coloured mesh, the figures, and the worst places."""
import os

import numpy

TYPES = {"float": "<f4", "uchar": "u1", "int": "<i4"}


class ErrorMesh:
    """Vertices with their form error, and triangles. points, normals: (n, 3) in mm; error_um, block: (n,); triangles:
    (m, 3); colours: (n, 3), 0 to 255; full_um: error at which a colour is full."""


def read_mesh(path):
    """A form_error_mesh.ply."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    head = data[:end].decode("ascii").split("\n")
    counts, fields, full = {}, [], 0.0
    element = ""
    for line in head:
        words = line.split()
        if words[:1] == ["comment"] and "full colour at" in line:
            full = float(words[-1])
        elif words[:1] == ["element"]:
            element = words[1]
            counts[element] = int(words[2])
        elif words[:1] == ["property"] and element == "vertex":
            fields.append((words[2], TYPES[words[1]]))
    vertices = numpy.frombuffer(data, dtype=fields, count=counts["vertex"], offset=end)
    faces = numpy.frombuffer(data, dtype=[("n", "u1"), ("v", "<i4", 3)], count=counts["face"],
                             offset=end + vertices.nbytes)
    out = ErrorMesh()
    out.points = numpy.column_stack([vertices[name] for name in "xyz"])
    out.normals = numpy.column_stack([vertices[name] for name in ("nx", "ny", "nz")])
    out.colours = numpy.column_stack([vertices[name] for name in ("red", "green", "blue")])
    out.error_um, out.block = vertices["error_um"], vertices["block"]
    out.triangles = faces["v"]
    out.full_um = full
    return out


class Place:
    """A place of the surface where the error is large."""

    def __init__(self, point, error_um, line, operation):
        self.point, self.error_um, self.line, self.operation = point, error_um, line, operation


def worst_places(mesh, operation_at, count=12, apart_mm=2.0):
    """The places with the largest errors, the worst first, none nearer than apart_mm to a worse one of its operation."""
    out = []
    for i in numpy.argsort(-numpy.abs(mesh.error_um), kind="stable"):
        operation = operation_at(int(mesh.block[i]))
        point = mesh.points[i]
        if any(place.operation is operation and numpy.linalg.norm(place.point - point) < apart_mm for place in out):
            continue
        out.append(Place(point, float(mesh.error_um[i]), int(mesh.block[i]), operation))
        if len(out) == count:
            break
    return out


def by_operation(mesh, spans):
    """{label of an operation: largest magnitude of its error, um}."""
    out = {}
    for span in spans:
        of = (mesh.block >= span.first) & (mesh.block <= span.last)
        if of.any():
            out[span.label] = float(numpy.abs(mesh.error_um[of]).max())
    return out


def mesh_path(folder):
    return os.path.join(folder, "form_error_mesh.ply")
