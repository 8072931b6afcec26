# Run by FreeCAD with a screen: the commands, a workbench of their own, and their place in the menu of Path (CAM).
import FreeCADGui


class CamberWorkbench(FreeCADGui.Workbench):
    MenuText = "Camber"
    ToolTip = "Form error of a Path (CAM) job, and its compensation"

    def __init__(self):
        import os

        import camber_freecad

        folder = os.path.dirname(os.path.dirname(os.path.realpath(camber_freecad.__file__)))
        self.__class__.Icon = os.path.join(folder, "resources", "icons", "camber.svg")

    def Initialize(self):
        from camber_freecad import commands

        names = list(commands.COMMANDS)
        self.appendToolbar("Camber", names)
        self.appendMenu("Camber", names)

    def GetClassName(self):
        return "Gui::PythonWorkbench"


class _InPathMenu:
    """Behind "Post Process" in the menu of the Path (CAM) workbench."""

    def modifyMenuBar(self):
        from camber_freecad import commands

        return [{"insert": name, "menuItem": post, "after": ""} for post in ("Path_Post", "CAM_Post")
                for name in reversed(list(commands.COMMANDS))]


def _register():
    from camber_freecad import commands

    commands.register()
    FreeCADGui.addWorkbench(CamberWorkbench())
    if hasattr(FreeCADGui, "addWorkbenchManipulator"):
        FreeCADGui.addWorkbenchManipulator(_InPathMenu())


_register()
