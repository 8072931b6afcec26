"""What scripts/compare-outputs runs: the inputs in a workspace, and the commands on them."""
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass, field

import small_jobs

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
JOBS = ("01-finishing", "05-freeform", "06-wall", "07-pocket-corner", "09-guide", "10-raster")
LINUXCNC = "samples/machines/linuxcnc_fitted.toml"
BLOCK_TIME = "samples/machines/block_time_2ms.toml"


@dataclass
class Case:
    """One run of camber, in the workspace. Everything that it writes goes to out/NAME; {out} stands for that folder.
    `copies`: results handed on, from this case's folder to a place in the workspace. `needs`: cases that must be done."""
    name: str
    arguments: str
    needs: tuple = ()
    copies: dict = field(default_factory=dict)

    @property
    def command(self):
        return self.name.split("/")[0]


# Inputs

def make_inputs(folder, full):
    """Copies the samples and has the scripts that make the benchmarks' inputs make them."""
    shutil.copytree(os.path.join(TOP, "samples"), os.path.join(folder, "samples"))
    made = os.path.join(folder, "made")
    os.makedirs(made)
    python(["samples/04-compress/make_sample.py", made])
    python(["samples/08-resegment/make_sample.py"], os.path.join(made, "character_line.nc"))
    python(["samples/08-resegment/make_arcs.py"], os.path.join(made, "arcs.nc"))
    python(["samples/10-raster/make_sample.py", os.path.join(made, "part.stl"), "60", "30"])
    for name in ("scan", "mixed", "contour"):  # the programs of bench/resegment/table before camber compress
        edit(os.path.join(made, name + ".nc"), os.path.join(made, name + "_fast.nc"), (r"F270\.", "F8000"))
    for machine in ("block_time_2ms", "linuxcnc_fitted"):
        edit(os.path.join(folder, "samples/10-raster/job.toml"), os.path.join(made, "raster_%s.toml" % machine),
             ('"machine.toml"', '"../samples/machines/%s.toml"' % machine))
    make_finishing(os.path.join(folder, "finishing"), 334 if full else 4)
    small_jobs.write(os.path.join(folder, "small"))


def python(arguments, output=None):
    """Runs a Python script of the repository; what it prints goes to a file."""
    text = subprocess.run([sys.executable, os.path.join(TOP, arguments[0]), *arguments[1:]], check=True,
                          stdout=subprocess.PIPE).stdout
    if output:
        with open(output, "wb") as out:
            out.write(text)


def edit(source, target, *replacements):
    with open(source, encoding="utf8") as file:
        text = file.read()
    for pattern, replacement in replacements:
        text = re.sub(pattern, replacement, text, flags=re.M)
    with open(target, "w", encoding="utf8", newline="\n") as out:
        out.write(text)


def make_finishing(folder, rows):
    """bench/finishing/predict writes its inputs, with `true` in camber's place."""
    for coupling in ("rigid", "static"):
        for second in "01":
            subprocess.run([os.path.join(TOP, "bench/finishing/predict"), str(rows), "0.2", coupling, "1"], check=True,
                           stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                           env=dict(os.environ, CAMBER="true", FOLDER=folder, SECOND=second))
            name = ("second_" if second == "1" else "box_") + coupling + ".toml"
            os.replace(os.path.join(folder, "job.toml"), os.path.join(folder, name))


# Commands

def cases(full):
    return [*fits(), *jobs(full), *small(), *finishing(full), *compress(full), *resegment(full), *raster(full),
            *programs(), *others()]


def fits():
    sample = "samples/01-finishing/"
    yield Case("fit-feed/sample-01", f"fit-feed --program {sample}trace_program.nc --trace {sample}trace.csv --machine "
               f"{sample}machine.toml -o {{out}}/machine.toml --json {{out}}/fit.json "
               "--block-time-plot {out}/block_time.svg",
               copies={"machine.toml": "samples/09-guide/machine.toml"})
    yield Case("fit-force/sample-03", "fit-force --log samples/03-force-fit/means.csv --job samples/03-force-fit/job.toml "
               "-o {out}/material.toml --json {out}/fit.json",
               copies={"material.toml": "samples/09-guide/material.toml"})
    yield Case("raster/sample-10", "resegment --job samples/10-raster/job.toml --scallop-mm 0.005 --tolerance-mm 0.01 "
               "--feed-mm-per-min 3000 --spindle-rpm 12000 -o {out}/raster.nc --json {out}/r.json "
               "--report {out}/r.html", copies={"raster.nc": "samples/10-raster/raster.nc"})


NEEDS = {"09-guide": ("fit-feed/sample-01", "fit-force/sample-03"), "10-raster": ("raster/sample-10",)}


def jobs(full):
    """Every sample with a job: compensate (the longest first), predict, and options that samples 07 and 09 do fast."""
    for sample in JOBS:
        checks = " --check-voxel 0.13 --check-voxel 0.087" if full else ""
        yield Case(f"compensate/{sample}", f"compensate samples/{sample}/job.toml -o {{out}}/out.nc --json {{out}}/r.json "
                   f"--report {{out}}/r.html --header-hash{checks}", NEEDS.get(sample, ()))
    for sample in JOBS:
        yield Case(f"predict/{sample}", f"predict samples/{sample}/job.toml -o {{out}}/files --json {{out}}/r.json",
                   NEEDS.get(sample, ()))
        yield Case(f"config/{sample}", f"--effective-config predict samples/{sample}/job.toml -o {{out}}/files",
                   NEEDS.get(sample, ()))
    guide = "samples/09-guide/job.toml"
    yield Case("predict/forces-at", f"predict {guide} -o {{out}}/files --forces-at 12", NEEDS["09-guide"])
    yield Case("compensate/uncertainty", f"compensate {guide} -o {{out}}/out.nc --json {{out}}/r.json --report "
               "{out}/r.html --header --uncertainty out/fit-force/sample-03/fit.json", NEEDS["09-guide"])
    yield Case("compensate/check-voxel", f"compensate {guide} --dry-run --json {{out}}/r.json --check-voxel 0.25",
               NEEDS["09-guide"])
    yield Case("compensate/measured", f"compensate {guide} -o {{out}}/out.nc --json {{out}}/r.json --measured "
               "out/predict/09-guide/files/form_error.csv", ("predict/09-guide",))


def small():
    for name in small_jobs.jobs():
        needs = ("predict/small-flat-rigid",) if name == "second" else ()
        yield Case(f"predict/small-{name}", f"predict small/{name}.toml -o {{out}}/files --json {{out}}/r.json", needs)
        yield Case(f"config/small-{name}", f"--effective-config predict small/{name}.toml -o {{out}}/files", needs)
    for name in ("general-rigid", "bull-static", "ball-rigid", "inch"):
        yield Case(f"compensate/small-{name}", f"compensate small/{name}.toml -o {{out}}/out.nc --json {{out}}/r.json "
                   "--report {out}/r.html --header")


def finishing(full):
    threads = "--threads 2 " if full else ""
    yield Case("predict/finishing-lifted", f"{threads}predict finishing/lifted.toml -o {{out}}/files "
               "--json {out}/r.json", copies={"files/stock.vdb": "finishing/lifted/stock.vdb"})
    for name in ("box_rigid", "box_static", "second_rigid", "second_static"):
        yield Case(f"predict/finishing-{name}", f"{threads}predict finishing/{name}.toml -o {{out}}/files "
                   "--json {out}/r.json", ("predict/finishing-lifted",) if "second" in name else ())


def compress(full):
    clock = "--line-feed-mm-per-min 270 --arc-feed-mm-per-min 1000 --block-s 0"
    variants = {"0.01": "--tolerance-mm 0.01 --report {out}/r.html", "time": f"--tolerance-mm 0.01 --machine {LINUXCNC}",
                "clock": f"--tolerance-mm 0.01 {clock}", "any-kink": "--tolerance-mm 0.01 --tangent-deg 180",
                "lines": "--tolerance-mm 0.01 --lines-only", "planes": "--tolerance-mm 0.01 --switch-planes",
                "helices": "--tolerance-mm 0.01 --helices"}
    for tolerance in ("0.002", "0.05") + (("0.003", "0.005", "0.0075", "0.02") if full else ()):
        variants[tolerance] = f"--tolerance-mm {tolerance}"
    for kink in ("0.2",) + (("5", "2", "0.5") if full else ()):
        variants["kink-" + kink] = f"--tolerance-mm 0.01 --tangent-deg {kink}"
    for program in ("scan", "mixed", "pockets", "contour"):
        for name, options in variants.items():
            yield Case(f"compress/{program}-{name}", f"compress made/{program}.nc {options} -o {{out}}/out.nc "
                       "--json {out}/r.json")
    for sample in ("01-finishing", "05-freeform"):
        yield Case(f"compress/{sample}", f"compress samples/{sample}/finish.nc --tolerance-mm 0.005 -o {{out}}/out.nc "
                   "--json {out}/r.json")


def resegment(full):
    """The programs of bench/resegment/table; the character line whole or, for time, at one tolerance."""
    for machine in (BLOCK_TIME, LINUXCNC):
        short = os.path.basename(machine)[:-5]
        for options, word in (("", "no-larger"), (" --contour-mm 10", "any")):
            for tolerance in ("0.005", "0.01", "0.02") if full else ("0.01",):
                yield Case(f"resegment/line-{short}-{word}-{tolerance}", f"resegment made/character_line.nc --machine "
                           f"{machine} --tolerance-mm {tolerance}{options} -o {{out}}/out.nc --json {{out}}/r.json")
            yield Case(f"resegment/arcs-{short}-{word}", f"resegment made/arcs.nc --machine {machine} --tolerance-mm 0.01"
                       f"{options} -o {{out}}/out.nc --json {{out}}/r.json --report {{out}}/r.html")
            for name in ("scan", "mixed", "contour"):
                yield Case(f"resegment/{name}-{short}-{word}", f"resegment made/{name}_packed.nc --machine {machine} "
                           f"--tolerance-mm 0.01{options} -o {{out}}/out.nc --json {{out}}/r.json",
                           (f"compress/{name}-fast",))
    for name in ("scan", "mixed", "contour"):
        yield Case(f"compress/{name}-fast", f"compress made/{name}_fast.nc --tolerance-mm 0.01 -o {{out}}/out.nc",
                   copies={"out.nc": f"made/{name}_packed.nc"})


def raster(full):
    """Rows of bench/resegment/raster-table: the large part in full, the sample's else."""
    rows = (("0.002", "0.005"), ("0.005", "0.005"), ("0.005", "0.02")) if full else (("0.005", "0.01"),)
    part = "made/part.stl" if full else "samples/10-raster/part.stl"
    for machine in ("block_time_2ms", "linuxcnc_fitted"):
        for scallop, tolerance in rows:
            yield Case(f"raster/{machine}-{scallop}-{tolerance}", f"resegment --job made/raster_{machine}.toml --part {part} "
                       f"--scallop-mm {scallop} --tolerance-mm {tolerance} --feed-mm-per-min 8000 --spindle-rpm 12000 "
                       "--direction-deg 30 -o {out}/out.nc --json {out}/r.json")
    yield Case("raster/boundary", f"resegment --job made/raster_linuxcnc_fitted.toml --part samples/10-raster/part.stl "
               "--scallop-mm 0.01 --tolerance-mm 0.01 --feed-mm-per-min 3000 --spindle-rpm 12000 --boundary 1,1,6,4 "
               "-o {out}/out.nc --json {out}/r.json --contour-mm 0.01")


PROGRAMS = ("samples/01-finishing/finish.nc", "samples/01-finishing/trace_program.nc", "samples/02-cycle-time/conventional.nc",
            "samples/02-cycle-time/highspeed.nc", "samples/05-freeform/finish.nc", "samples/06-wall/finish.nc",
            "samples/07-pocket-corner/finish.nc", "samples/09-guide/finish.nc", "made/scan.nc", "made/mixed.nc",
            "made/contour.nc", "made/pockets.nc", "made/character_line.nc", "made/arcs.nc", "small/slot.nc",
            "small/inch.nc", "small/holes.nc")
FED = {"samples/01-finishing/finish.nc": "samples/01-finishing/machine.toml",
       "samples/02-cycle-time/conventional.nc": "samples/machines/takata_2_6.toml",
       "samples/02-cycle-time/highspeed.nc": "samples/machines/yan_shirase.toml",
       "samples/05-freeform/finish.nc": LINUXCNC, "samples/06-wall/finish.nc": BLOCK_TIME,
       "samples/07-pocket-corner/finish.nc": "samples/07-pocket-corner/machine.toml", "made/arcs.nc": LINUXCNC,
       "small/slot.nc": "small/fanuc.toml", "small/inch.nc": "small/haas.toml", "small/holes.nc": "small/mazak.toml"}


def programs():
    """check and init of every program, feed of some, time of each on the machines of the samples."""
    for program in PROGRAMS:
        short = "-".join(program[:-3].split("/")[-2:])
        yield Case(f"check/{short}", f"check {program} --json {{out}}/r.json")
        yield Case(f"init/{short}", f"init {program} -o {{out}}/job.toml")
    for program in ("samples/06-wall/finish.nc", "small/holes.nc"):
        for dialect in ("fanuc", "haas", "mazak", "linuxcnc"):
            short = "-".join(program[:-3].split("/")[-2:])
            yield Case(f"check/{short}-{dialect}", f"check {program} --dialect {dialect} --json {{out}}/r.json")
    for program, machine in FED.items():
        short = "-".join(program[:-3].split("/")[-2:])
        yield Case(f"feed/{short}", f"feed {program} --machine {machine} -o {{out}}/feed.csv --json {{out}}/r.json")
    for machine in sorted(os.listdir(os.path.join(TOP, "samples/machines"))):
        yield Case(f"time/{machine[:-5]}", f"time samples/02-cycle-time/conventional.nc --machine samples/machines/{machine} "
                   "--json {out}/r.json --report {out}/r.html")
        yield Case(f"config/{machine[:-5]}", f"--effective-config feed samples/02-cycle-time/conventional.nc --machine "
                   f"samples/machines/{machine}")


def others():
    cycle = "samples/02-cycle-time/"
    yield Case("time/cases", f"time {cycle}conventional.nc --case {cycle}cases.toml --json {{out}}/r.json "
               "--report {out}/r.html")
    yield Case("time/sweep", f"time {cycle}highspeed.nc --machine samples/machines/takata_2_6.toml --sweep "
               "axis.all.acceleration_mm_per_s2=2000:8000:3 --json {out}/r.json --report {out}/r.html")
    yield Case("time/trace", "time samples/01-finishing/trace_program.nc --machine samples/01-finishing/machine.toml "
               "--trace samples/01-finishing/trace.csv --json {out}/r.json")
    for machine in ("samples/01-finishing/machine.toml", LINUXCNC, BLOCK_TIME, "small/mazak.toml"):
        short = "-".join(machine[:-5].split("/")[-2:])
        yield Case(f"protocol/{short}", f"protocol --machine {machine} -o {{out}}/files")
    for shell in ("bash", "zsh", "fish"):
        yield Case(f"completion/{shell}", f"completion {shell}")
    yield Case("help/help", "--help")
