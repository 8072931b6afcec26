"""The form error as a coloured mesh in the 3D view, with a legend."""
import FreeCAD

from . import results

if FreeCAD.GuiUp:
    import FreeCADGui
    from pivy import coin

OBJECT = "CamberFormError"


class ErrorMap:
    """Proxy of the document object: it keeps the mesh's file in the document."""

    def __init__(self, obj):
        obj.addProperty("App::PropertyFileIncluded", "MeshFile", "Camber", "The surface with its form error (PLY)")
        obj.addProperty("App::PropertyFloat", "FullColour", "Camber", "Error at which the colour is full, um")
        obj.addProperty("App::PropertyFloat", "Percentile95", "Camber", "95th percentile of the error's magnitude, um")
        obj.addProperty("App::PropertyFloat", "Largest", "Camber", "Most material left, um")
        obj.addProperty("App::PropertyFloat", "Smallest", "Camber", "Deepest cut into the part, um (negative)")
        obj.addProperty("App::PropertyLink", "Job", "Camber", "The job")
        for name in ("FullColour", "Percentile95", "Largest", "Smallest"):
            obj.setEditorMode(name, 1)
        obj.Proxy = self

    def execute(self, obj):
        pass

    def __getstate__(self):
        return None

    def __setstate__(self, state):
        return None

    dumps, loads = __getstate__, __setstate__  # their names from FreeCAD 1.0 on


def show(job, folder, figures):
    """The map of a prediction as an object of the document; a former one of the job is replaced."""
    document = job.Document
    for old in [o for o in document.Objects if isinstance(getattr(o, "Proxy", None), ErrorMap) and o.Job == job]:
        document.removeObject(old.Name)
    obj = document.addObject("App::FeaturePython", OBJECT)
    obj.Label = "Form error of %s" % job.Label
    ErrorMap(obj)
    obj.Job = job
    obj.MeshFile = results.mesh_path(folder)
    error = figures["form_error_um"]
    obj.FullColour = results.read_mesh(results.mesh_path(folder)).full_um
    obj.Percentile95, obj.Largest, obj.Smallest = error["p95"], error["max"], error["min"]
    if FreeCAD.GuiUp:
        ErrorMapView(obj.ViewObject)
    return obj


def legend_lines(full_um):
    """(colour, text) from the top down."""
    steps = []
    for fraction in (1.0, 0.5, 0.0, -0.5, -1.0):
        faded = 1 - abs(fraction)
        colour = (faded, faded, 1.0) if fraction < 0 else (1.0, faded, faded)
        more = {1.0: " and more: material left", -1.0: " and less: cut too deep"}.get(fraction, "")
        steps.append((colour, ("%+.1f um%s" % (fraction * full_um, more)) if fraction else "0 um"))
    return steps


class ErrorMapView:
    def __init__(self, view):
        view.Proxy = self

    def attach(self, view):
        self.root = coin.SoSeparator()
        view.addDisplayMode(self.root, "Shaded")
        self.fill(view.Object)

    def updateData(self, obj, name):
        if name == "MeshFile" and hasattr(self, "root"):
            self.fill(obj)

    def fill(self, obj):
        self.root.removeAllChildren()
        if not getattr(obj, "MeshFile", ""):
            return
        mesh = results.read_mesh(obj.MeshFile)
        hints = coin.SoShapeHints()
        hints.vertexOrdering = coin.SoShapeHints.COUNTERCLOCKWISE
        material = coin.SoMaterial()
        material.diffuseColor.setValues(0, len(mesh.colours), [[float(c) for c in row] for row in mesh.colours / 255.0])
        binding = coin.SoMaterialBinding()
        binding.value = coin.SoMaterialBinding.PER_VERTEX_INDEXED
        points = coin.SoCoordinate3()
        points.point.setValues(0, len(mesh.points), [[float(c) for c in row] for row in mesh.points])
        normals = coin.SoNormal()
        normals.vector.setValues(0, len(mesh.normals), [[float(c) for c in row] for row in mesh.normals])
        normal_binding = coin.SoNormalBinding()
        normal_binding.value = coin.SoNormalBinding.PER_VERTEX_INDEXED
        faces = coin.SoIndexedFaceSet()
        indices = []
        for a, b, c in mesh.triangles.tolist():
            indices += (a, b, c, -1)
        faces.coordIndex.setValues(0, len(indices), indices)
        surface = coin.SoSeparator()
        for node in (hints, material, binding, points, normals, normal_binding, faces):
            surface.addChild(node)
        self.root.addChild(surface)
        self.root.addChild(legend_node(mesh.full_um))

    def getDisplayModes(self, view):
        return ["Shaded"]

    def getDefaultDisplayMode(self):
        return "Shaded"

    def setDisplayMode(self, mode):
        return mode

    def __getstate__(self):
        return None

    def __setstate__(self, state):
        return None

    dumps, loads = __getstate__, __setstate__


def legend_node(full_um):
    """Fields of colour with their errors, at the left edge of the view whatever its size."""
    left, top, width, height = -0.97, 0.9, 0.04, 0.07
    out = coin.SoAnnotation()
    camera = coin.SoOrthographicCamera()
    camera.viewportMapping = coin.SoCamera.LEAVE_ALONE
    camera.height = 2
    camera.position = (0, 0, 1)
    camera.nearDistance, camera.farDistance = 0.1, 10
    light = coin.SoLightModel()
    light.model = coin.SoLightModel.BASE_COLOR
    out.addChild(camera)
    out.addChild(light)
    title = [((0.0, 0.0, 0.0), "Form error")]
    for i, (colour, text) in enumerate(title + legend_lines(full_um)):
        row = coin.SoSeparator()
        y = top - i * height
        if i > 0:
            base = coin.SoBaseColor()
            base.rgb = colour
            corners = coin.SoCoordinate3()
            corners.point.setValues(0, 4, [[left, y, 0], [left + width, y, 0], [left + width, y - height, 0],
                                           [left, y - height, 0]])
            face = coin.SoFaceSet()
            face.numVertices.setValue(4)
            for node in (base, corners, face):
                row.addChild(node)
        words = coin.SoSeparator()
        black = coin.SoBaseColor()
        black.rgb = (0, 0, 0)
        place = coin.SoTranslation()
        place.translation = (left + width + 0.01 if i > 0 else left, y - 0.75 * height, 0)
        font = coin.SoFont()
        font.size = 14
        label = coin.SoText2()
        label.string = text
        for node in (black, place, font, label):
            words.addChild(node)
        row.addChild(words)
        out.addChild(row)
    return out
