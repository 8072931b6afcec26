"""Camber: how far a milling cutter bends along an NC program, and the program that makes up for it.

    import camber
    result = camber.predict("job.toml")
    print(result.form_error_um.p95)
    print(result.form_error.error_um.max())   # a numpy array; nothing was copied

Where a function takes a program, a machine or a job, a path does as well. Every function takes progress, a
function of a few words and the fraction done (False stops the call: Cancelled), strict (warnings are errors) and
threads. Wrong input raises InputError with file, line, column, id and message, and all diagnostics.
"""
from ._camber import *  # noqa: F403
from ._camber import __version__  # noqa: F401
