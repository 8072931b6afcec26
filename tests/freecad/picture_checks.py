"""Run by FreeCAD on a screen: predicts through the command, and takes a picture of the coloured mesh."""
import os
import sys
import traceback

ROOT = os.environ["CAMBER_ROOT"]
sys.path.insert(0, os.path.join(ROOT, "tests", "freecad"))
sys.path.insert(0, os.path.join(ROOT, "addons", "freecad"))

import FreeCAD
import FreeCADGui
from PySide import QtCore, QtGui


def colours(path):
    """Numbers of pixels that are rather red, rather blue."""
    image = QtGui.QImage(path)
    red = blue = 0
    for x in range(0, image.width(), 2):
        for y in range(0, image.height(), 2):
            c = image.pixelColor(x, y)
            red += c.red() > 120 and c.red() > 1.4 * c.blue() and c.red() > 1.4 * c.green()
            blue += c.blue() > 120 and c.blue() > 1.4 * c.red()
    return red, blue


def check():
    for name in ("Init.py", "InitGui.py"):
        exec(open(os.path.join(ROOT, "addons", "freecad", name)).read(), globals())
    import path_job
    from camber_freecad import commands, panel, settings

    assert set(commands.COMMANDS) <= set(FreeCADGui.listCommands())
    assert "CamberWorkbench" in FreeCADGui.listWorkbenches()
    FreeCADGui.activateWorkbench("CamberWorkbench")
    job = path_job.make(apart_mm=4)
    settings.prepare(job)
    job.CamberMachine = os.path.join(ROOT, "samples", "01-finishing", "machine.toml")
    job.CamberMaterial = "C45"
    job.CamberVoxel = 0.4
    for controller in job.Tools.Group:
        controller.CamberOverhang = 12 if controller.ToolNumber == 1 else 20
    assert commands.selected_job() is job
    FreeCADGui.runCommand("Camber_Predict")
    shown = FreeCADGui.Control.activeDialog()
    assert shown, "no panel"
    panels = [p for p in panel.OPEN if p.job is job]
    one = panels[-1]
    while one.timer.isActive():
        QtGui.QApplication.processEvents(QtCore.QEventLoop.AllEvents, 100)
    assert one.run.outcome.status == 0, one.run.outcome.output
    assert "form error" in one.text.text().lower(), one.text.text()
    assert one.table.rowCount() == len(one.places) > 3
    worst = next(i for i, place in enumerate(one.places) if place.operation)
    one.jump(worst)
    assert FreeCADGui.Selection.getSelection() == [one.places[worst].operation]
    FreeCADGui.Selection.clearSelection()
    for obj in job.Document.Objects:
        if obj.ViewObject and obj.Name != "CamberFormError":
            obj.ViewObject.Visibility = False
    view = FreeCADGui.ActiveDocument.ActiveView
    view.viewIsometric()
    FreeCADGui.SendMsgToActiveView("ViewFit")
    QtGui.QApplication.processEvents()
    path = os.environ["CAMBER_PICTURE"]
    view.saveImage(path, 1000, 700, "White")
    red, blue = colours(path)
    print("picture: red %d, blue %d" % (red, blue))
    assert red > 500 and blue > 20, (red, blue)
    print("picture: good")


def run():
    try:
        check()
    except Exception:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


QtCore.QTimer.singleShot(500, run)
