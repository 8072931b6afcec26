#!/usr/bin/env python3
"""bench/copy/table.py [--camber CAMBER] [JOB.toml ...]: copies the jobs of samples/14-copy-milling and prints a table.

force: greatest over target; within: of the tooth passings whose feed the rule chose freely, those with 80 to 105 % of
the target; ticks in computing time, which depends on what else the machine does.
"""
import argparse
import glob
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "../.."))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--camber", default=os.path.join(ROOT, "build/release/camber"))
    parser.add_argument("--hardness", help="REGIONS.csv for every job")
    parser.add_argument("jobs", nargs="*")
    given = parser.parse_args()
    jobs = given.jobs or sorted(glob.glob(os.path.join(ROOT, "samples/14-copy-milling/*.toml")))
    print(f"{'job':<16}{'time, s':>9}{'blocks':>8}{'force':>8}{'within':>8}{'counted':>9}{'over':>6}"
          f"{'gouge, um':>11}{'left p95, max, um':>20}{'tick mean, max, ms':>20}")
    for job in jobs:
        name = os.path.splitext(os.path.basename(job))[0]
        if name == "machine":
            continue
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "r.json")
            command = [given.camber, "-q", "copy", job, "-o", os.path.join(folder, "out.nc"), "--json", out]
            command += ["--hardness", given.hardness] if given.hardness else []
            run = subprocess.run(command, stderr=subprocess.PIPE, text=True)
            if run.returncode != 0:
                print(f"{name:<16}{run.stderr.splitlines()[0] if run.stderr else run.returncode}")
                continue
            with open(out, encoding="utf8") as file:
                r = json.load(file)
        load = r["load"]
        force = f"{load['max'] / load['target']:.2f}" if load["target"] else "-"
        within = f"{100 * load['within_share']:.1f} %" if load["counted"] else "-"
        left, tick = r["left_um"], r["tick_ms"]
        print(f"{name:<16}{r['time_s']:>9.1f}{r['blocks']:>8}{force:>8}{within:>8}{load['counted']:>9}{load['over']:>6}"
              f"{r['gouge_um']:>11.1f}{left['p95']:>11.1f},{left['max']:>8.0f}{tick['mean']:>12.4f},{tick['max']:>7.3f}",
              flush=True)


if __name__ == "__main__":
    sys.exit(main())
