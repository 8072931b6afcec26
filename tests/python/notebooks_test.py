"""The notebooks of samples/20-notebooks, cell by cell, without Jupyter; pictures are drawn and thrown away."""
import json
import os
import pathlib
import sys

try:
    import matplotlib
except ImportError:
    print(f"{__file__}:1: Skipped\nno matplotlib\n\n[  SKIPPED ] Python.notebooks")
    sys.exit(77)
matplotlib.use("Agg")
import matplotlib.pyplot as plt

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "samples/20-notebooks"
os.chdir(FOLDER)
for path in sorted(FOLDER.glob("*.ipynb")):
    notebook = json.loads(path.read_text(encoding="utf8"))
    assert notebook["nbformat"] == 4
    names = {}
    drawn = 0
    for number, cell in enumerate(notebook["cells"], 1):
        assert cell["cell_type"] in ("markdown", "code")
        if cell["cell_type"] == "code":
            assert cell["outputs"] == [] and cell["execution_count"] is None, "outputs are not kept"
            code = compile("".join(cell["source"]), f"{path.name}, cell {number}", "exec")
            exec(code, names)
            for figure in plt.get_fignums():
                plt.figure(figure).canvas.draw()
                drawn += 1
            plt.close("all")
    assert drawn >= 2, path
    print(path.name, "done,", drawn, "figures")
