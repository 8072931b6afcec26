"""Post-processor of FreeCAD: the post-processor that the user has, and then Camber.

Listed as "camber". Arguments: see TOOLTIP_ARGS; all others go to the other post-processor.
"""
import os
import sys

import FreeCAD

try:
    from camber_freecad import post
except ImportError:  # found through a search path for post-processors alone
    sys.path.append(os.path.dirname(os.path.realpath(__file__)))
    from camber_freecad import post

TOOLTIP = """Posts with the post-processor that --post names, and lets Camber move the path against the deflection of the
tool (or adapt the feeds). Where Camber refuses, the program is written as it is, and the report view says why."""
TOOLTIP_ARGS = post.parser().format_help()


def export(objectslist, filename, argstring):
    def say(text):
        (FreeCAD.Console.PrintWarning if "as it is" in text else FreeCAD.Console.PrintMessage)(text + "\n")

    return post.export(objectslist, filename, argstring, say)
