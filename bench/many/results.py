"""What predict leaves in a folder, for comparing runs byte by byte."""
import hashlib
import json

RESULTS = ["feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb", "report.html"]


def digest(folder):
    """Name: hash of the file; of summary.json all but the computing time."""
    out = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in RESULTS}
    figures = json.loads((folder / "summary.json").read_text())
    del figures["compute_s"]
    return out | {"summary.json": json.dumps(figures)}
