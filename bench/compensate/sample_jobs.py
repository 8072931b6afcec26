"""Jobs of the samples with other levers, for the scripts beside this file."""
import json
import os
import re
import shutil
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CAMBER = os.path.abspath(os.environ.get("CAMBER", os.path.join(ROOT, "build/release/camber")))


def camber(*arguments):
    return subprocess.run([CAMBER, "-q", *arguments], stderr=subprocess.DEVNULL, check=False).returncode


def copy_sample(out, sample):
    """The sample in a folder of `out`, beside a machine and a material as quickstart and the guide fit them."""
    folder = os.path.join(out, sample)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(os.path.join(ROOT, "samples", sample), folder)
    samples = os.path.join(ROOT, "samples")
    if sample in ("01-finishing", "09-guide"):
        first = os.path.join(samples, "01-finishing")
        camber("fit-feed", "--program", first + "/trace_program.nc", "--trace", first + "/trace.csv",
               "--machine", first + "/machine.toml", "-o", folder + "/machine.toml")
        force = os.path.join(samples, "03-force-fit")
        camber("fit-force", "--log", force + "/means.csv", "--job", force + "/job.toml", "-o", folder + "/material.toml")
    with open(folder + "/job.toml") as f:
        text = f.read()
    text = re.sub(r'"\.\./', '"%s/' % samples, text)
    with open(folder + "/job.toml", "w") as f:
        f.write(text)
    return folder


def write_job(folder, name, program=None, levers=None, rounds=None):
    with open(folder + "/job.toml") as f:
        text = f.read()
    if program:
        text = re.sub(r'(?m)^program *= *"[^"]*"', 'program = "%s"' % program, text)
    if "[compensation]" not in text:
        text += "\n[compensation]\n"
    if levers:
        text = text.replace("[compensation]", "[compensation]\nlevers = %s" % json.dumps(levers), 1)
    if rounds:
        text = re.sub(r"(?m)^max_rounds.*$", "", text)
        text = text.replace("[compensation]", "[compensation]\nmax_rounds = %d" % rounds, 1)
    with open("%s/%s.toml" % (folder, name), "w") as f:
        f.write(text)
    return "%s/%s.toml" % (folder, name)


def compensate(folder, name, *more, **job):
    """Exit status and figures of the job with other keys."""
    path = write_job(folder, name, **job)
    out = "%s/out-%s" % (folder, name)
    status = camber("compensate", path, "-o", out + ".nc", "--json", out + ".json", "--keep-anyway", *more)
    with open(out + ".json") as f:
        return status, json.load(f)
