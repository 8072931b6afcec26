"""The commands Predict, Compensate and Adapt feeds."""
import os

import FreeCAD
import FreeCADGui
from PySide import QtGui

from . import compat, job_files, panel, run, settings, tools

ICONS = os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "resources", "icons")


def selected_job():
    """The job of the selection; else the only one of the document; else what the user picks."""
    for obj in FreeCADGui.Selection.getSelection():
        job = compat.job_of(obj)
        if job is not None:
            return job
    jobs = compat.jobs_of(FreeCAD.ActiveDocument)
    if len(jobs) < 2:
        return jobs[0] if jobs else None
    labels = [job.Label for job in jobs]
    label, chosen = QtGui.QInputDialog.getItem(FreeCADGui.getMainWindow(), "Camber", "Job", labels, 0, False)
    return jobs[labels.index(label)] if chosen else None


def ask_for(job, name):
    """Asks for a setting and stores it in the document; False where the user gives none."""
    window = FreeCADGui.getMainWindow()
    if name == "CamberMachine":
        file = "a machine file ..."
        text, chosen = QtGui.QInputDialog.getItem(window, "Camber", "Machine", [file] + run.machine_presets(), 0, False)
        if chosen and text == file:
            text = QtGui.QFileDialog.getOpenFileName(window, "Machine file of Camber", os.path.dirname(
                job.Document.FileName or ""), "Machine files (*.toml)")[0]
        if chosen and text:
            job.CamberMachine = text
        return bool(chosen and text)
    name, chosen = QtGui.QInputDialog.getItem(window, "Camber", "Material of the workpiece: a number or name, or a file "
                                              "with a [material] table", run.MATERIALS, 0, True)
    if chosen and name:
        job.CamberMaterial = name
    return bool(chosen and name)


def complete(job):
    """Asks for what is missing. False: the user gave up."""
    while True:
        try:
            settings.check(job)
            return True
        except settings.MissingSetting as missing:
            if not ask_for(job, missing.name):
                return False


class _Command:
    command, text, tip, icon = "", "", "", ""

    def GetResources(self):
        return {"Pixmap": os.path.join(ICONS, self.icon), "MenuText": self.text, "ToolTip": self.tip}

    def IsActive(self):
        return FreeCAD.ActiveDocument is not None and bool(compat.jobs_of(FreeCAD.ActiveDocument))

    def Activated(self):
        job = selected_job()
        if job is None or not complete(job):
            return
        output = self.output(job)
        if output is None:
            return
        try:
            panel.start(job, self.command, output)
        except (job_files.JobProblem, tools.ToolProblem, run.NoCamber, settings.MissingSetting) as problem:
            QtGui.QMessageBox.warning(FreeCADGui.getMainWindow(), "Camber", str(problem))

    def output(self, job):
        """Where the program goes; None: the user gave up. A prediction needs no place."""
        name = os.path.splitext(job.Document.FileName or job.Label)[0] + "." + self.command + ".nc"
        path = QtGui.QFileDialog.getSaveFileName(FreeCADGui.getMainWindow(), self.text, name)[0]
        return path or None


class Predict(_Command):
    command, text, icon = "predict", "Predict form error", "predict.svg"
    tip = "Form error, forces and times of the job, with the tool bending under the cut"

    def output(self, job):
        return ""


class Compensate(_Command):
    command, text, icon = "compensate", "Compensate deflection", "compensate.svg"
    tip = "Writes the program with its path moved against the deflection of the tool"


class Adapt(_Command):
    command, text, icon = "adapt", "Adapt feeds", "adapt.svg"
    tip = "Writes the program with feeds that keep the load limits of the job (CamberForceLimit, CamberPowerLimit)"

    def Activated(self):
        job = selected_job()
        if job is not None:
            settings.prepare(job)
            if job.CamberForceLimit <= 0 and job.CamberPowerLimit <= 0:
                value, chosen = QtGui.QInputDialog.getDouble(FreeCADGui.getMainWindow(), "Camber",
                                                             "Largest force across the tool, N", 100, 0.1, 1e6, 1)
                if not chosen:
                    return
                job.CamberForceLimit = value
        super().Activated()


COMMANDS = {"Camber_Predict": Predict, "Camber_Compensate": Compensate, "Camber_Adapt": Adapt}


def register():
    for name, command in COMMANDS.items():
        FreeCADGui.addCommand(name, command())
    return list(COMMANDS)
