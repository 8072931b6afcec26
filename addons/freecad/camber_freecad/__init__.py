"""Camber in FreeCAD: prediction and compensation of a Path (CAM) job.

Modules that need no screen: compat, settings, tools, stock, job_files, run, operations, results, post.
With a screen: commands, panel, error_view.
"""
