"""Camber: predicts the deflection of a milling cutter along an NC program and compensates the program.

    import camber
    result = camber.predict("job.toml")
    print(result.form_error_um.p95)
    print(result.form_error.error_um.max())   # a numpy array that shares memory

Programs, machines and jobs may also be given as paths. Every function takes progress, a
function of a step's name and its completed fraction (False stops the call: Cancelled), strict (warnings are errors) and
threads. Wrong input raises InputError with file, line, column, id and message, and all diagnostics.
"""
from ._camber import *  # noqa: F403
from ._camber import __version__  # noqa: F401
