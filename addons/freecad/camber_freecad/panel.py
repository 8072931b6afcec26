"""The task panel of a running command: progress, cancel, messages, and the table of the worst places."""
import os
import tempfile

import FreeCAD
import FreeCADGui
from PySide import QtCore, QtGui

from . import error_view, job_files, operations, post, results, run

EVERY_MS = 200
OPEN = []  # panels that are shown; FreeCAD keeps no reference to them


def start(job, command, output):
    """Writes the job's files, starts the command and shows the panel. Raises what job_files.write() and Run raise."""
    folder = tempfile.mkdtemp(prefix="camber-")
    files = job_files.write(job, folder)
    target = output or os.path.join(folder, "predicted")
    started = run.Run(files, command, target).start()
    FreeCADGui.Control.closeDialog()
    panel = Panel(job, files, started)
    OPEN[:] = [panel]
    FreeCADGui.Control.showDialog(panel)
    return panel


class Panel:
    def __init__(self, job, files, started):
        self.job, self.files, self.run = job, files, started
        self.places = []
        self.form = QtGui.QWidget()
        self.form.setWindowTitle("Camber: %s of %s" % (started.command, job.Label))
        layout = QtGui.QVBoxLayout(self.form)
        self.bar = QtGui.QProgressBar()
        self.bar.setRange(0, 0)
        self.cancel = QtGui.QPushButton("Cancel")
        self.cancel.clicked.connect(started.cancel)
        self.text = QtGui.QLabel("")
        self.text.setWordWrap(True)
        self.text.setTextInteractionFlags(QtCore.Qt.TextSelectableByMouse)
        self.messages = QtGui.QListWidget()
        self.messages.setWordWrap(True)
        self.messages.itemActivated.connect(lambda item: self.select(item.data(QtCore.Qt.UserRole)))
        self.table = QtGui.QTableWidget(0, 4)
        self.table.setHorizontalHeaderLabels(["error, um", "operation", "place, mm", "line"])
        self.table.setEditTriggers(QtGui.QAbstractItemView.NoEditTriggers)
        self.table.setSelectionBehavior(QtGui.QAbstractItemView.SelectRows)
        self.table.cellClicked.connect(lambda row, _: self.jump(row))
        for widget in (self.bar, self.cancel, self.text, self.messages, self.table):
            layout.addWidget(widget)
        self.table.hide()
        for note in files.notes:
            self.messages.addItem(note)
        self.timer = QtCore.QTimer()
        self.timer.timeout.connect(self.tick)
        self.timer.start(EVERY_MS)

    def getStandardButtons(self):
        return int(QtGui.QDialogButtonBox.Close)

    def reject(self):
        self.timer.stop()
        self.run.cancel()
        FreeCADGui.Control.closeDialog()

    def tick(self):
        if self.run.running():
            if self.run.fraction > 0:
                self.bar.setRange(0, 100)
                self.bar.setValue(int(100 * self.run.fraction))
            self.text.setText(self.run.what)
            return
        self.timer.stop()
        self.bar.hide()
        self.cancel.hide()
        self.finish(self.run.outcome)

    def finish(self, outcome):
        for message in outcome.messages:
            item = QtGui.QListWidgetItem(str(message))
            item.setData(QtCore.Qt.UserRole, message.operation.Name if message.operation else "")
            self.messages.addItem(item)
        for reason in outcome.reasons:
            self.messages.addItem(reason)
        self.text.setText(self.headline(outcome))
        if self.run.command == "predict" and os.path.exists(results.mesh_path(self.run.output)):
            self.show_map(outcome.figures)

    def headline(self, outcome):
        if outcome.status is None:
            return "Cancelled."
        if outcome.status not in (0, 3):
            return "Camber refuses this job: see the messages."
        said = post.summary(outcome.figures)
        written = "" if self.run.command == "predict" else "\nWritten: %s" % self.run.output
        if self.run.command != "predict" and not os.path.exists(self.run.output):
            written = "\nNo program was written: see the messages."
        return said[0].upper() + said[1:] + "." + written

    def show_map(self, figures):
        error_view.show(self.job, self.run.output, figures)
        mesh = results.read_mesh(results.mesh_path(self.run.output))
        self.places = results.worst_places(mesh, lambda line: operations.operation_at(self.files.spans, line))
        self.table.setRowCount(len(self.places))
        for row, place in enumerate(self.places):
            cells = ["%+.1f" % place.error_um, place.operation.Label if place.operation else "",
                     "%.2f  %.2f  %.2f" % tuple(place.point), str(place.line)]
            for column, text in enumerate(cells):
                self.table.setItem(row, column, QtGui.QTableWidgetItem(text))
        self.table.resizeColumnsToContents()
        self.table.show()

    def select(self, name):
        """Selects an operation in the tree."""
        obj = self.job.Document.getObject(name) if name else None
        if obj is not None:
            FreeCADGui.Selection.clearSelection()
            FreeCADGui.Selection.addSelection(obj)

    def jump(self, row):
        """To the operation of a place, and to the place itself."""
        place = self.places[row]
        if place.operation is not None:
            self.select(place.operation.Name)
        view = FreeCADGui.ActiveDocument.ActiveView
        camera = view.getCameraNode()
        point = FreeCAD.Vector(*[float(c) for c in place.point])
        direction = view.getViewDirection()
        distance = camera.focalDistance.getValue()
        camera.position = tuple(point - direction * distance)
