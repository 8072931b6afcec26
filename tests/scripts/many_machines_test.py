"""The ways of docs/many-machines.md give the same bytes: sections in one process, GNU parallel, MPI, Slurm.

What is not installed is left out, and said. Argument: the executable.
"""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CAMBER = os.path.abspath(sys.argv.pop(1))
RESULTS = ["feed.csv", "forces.csv", "form_error.csv", "form_error.vtp", "form_error.ply", "stock.vdb", "report.html"]
SLURM = """ClusterName=camber
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
AuthType=auth/none
CredType=cred/none
SlurmctldPort=16817
SlurmdPort=16818
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SchedulerParameters=batch_sched_delay=0,sched_interval=1
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def digest(folder):
    out = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in RESULTS}
    figures = json.loads((folder / "summary.json").read_text())
    del figures["compute_s"]
    return out | {"summary.json": json.dumps(figures)}


class SameBytes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="camber-many-"))
        subprocess.run([ROOT / "bench/many/make_job.py", cls.folder, "3", "0.5"], check=True)
        subprocess.run([CAMBER, "-q", "predict", "job.toml", "-o", "one", "--sections", "1"], check=True,
                       cwd=cls.folder)
        cls.expected = digest(cls.folder / "one")
        cls.environment = os.environ | {"CAMBER": CAMBER}

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def run_it(self, command, **more):
        done = subprocess.run(command, cwd=self.folder, env=self.environment | more, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done

    def needs(self, *programs):
        for program in programs:
            if not shutil.which(program):
                self.skipTest("%s is not installed" % program)

    def test_gnu_parallel(self):
        self.needs("parallel")
        self.run_it([ROOT / "scripts/parallel-predict", "job.toml", "parallel", "3", "1", "-S", "2/:"])
        self.assertEqual(digest(self.folder / "parallel"), self.expected)

    def test_mpi(self):
        self.needs("mpirun")
        for ranks in (2, 3):
            place = "mpi%d" % ranks
            done = self.mpirun(ranks, "-v", "predict", "job.toml", "-o", place)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("rank %d: " % (ranks - 1), done.stderr)
            self.assertEqual(digest(self.folder / place), self.expected)

    def mpirun(self, ranks, *command):
        done = subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), CAMBER, *command,
                               "--threads", "1"], cwd=self.folder, capture_output=True, text=True)
        if "is built without MPI" in done.stderr:
            self.skipTest("camber is built without MPI")
        return done

    def test_compensate_by_mpi(self):
        self.needs("mpirun")
        job = (self.folder / "job.toml").read_text().replace('"rigid"', '"static"').replace("= 0.5", "= 0.8")
        (self.folder / "compensated.toml").write_text(job + "[compensation]\nlevers = ['shift']\ntolerance_um = 1.0\nmax_rounds = 1\n")
        lines = (self.folder / "raster.nc").read_text().split("\n")
        (self.folder / "compensated.nc").write_text("\n".join(lines[:8] + ["M30", ""]))
        (self.folder / "compensated.toml").write_text(
            (self.folder / "compensated.toml").read_text().replace("raster.nc", "compensated.nc"))
        found = []
        for ranks in (1, 2):
            done = self.mpirun(ranks, "compensate", "compensated.toml", "-o", "out.nc", "--json", "out.json",
                               "--keep-anyway")
            self.assertIn(done.returncode, (0, 3), done.stderr)
            figures = json.loads((self.folder / "out.json").read_text())
            del figures["compute_s"]
            found.append((self.folder / "out.nc").read_text() + json.dumps(figures))
            self.assertNotEqual((self.folder / "out.nc").read_text(), (self.folder / "compensated.nc").read_text())
        self.assertEqual(found[0], found[1])

    def test_other_commands_are_refused_under_mpi(self):
        self.needs("mpirun")
        done = self.mpirun(2, "merge", "one")
        self.assertEqual(done.returncode, 2)
        self.assertIn("camber: error: under mpirun predict and compensate share their work; merge runs without it\n",
                      done.stderr)

    def test_slurm(self):
        self.needs("slurmctld", "slurmd", "sbatch", "squeue")
        if os.getuid() != 0:
            self.skipTest("slurmd needs root")
        place = self.folder / "slurm"
        (place / "state").mkdir(parents=True)
        (place / "spool").mkdir()
        host = subprocess.run(["hostname", "-s"], capture_output=True, text=True).stdout.strip()
        config = place / "slurm.conf"
        config.write_text(SLURM.format(host=host, user="root", folder=place, cpus=os.cpu_count()))
        environment = {"SLURM_CONF": str(config)}
        daemons = []
        try:
            for daemon in ("slurmctld", "slurmd"):
                daemons.append(subprocess.Popen([daemon, "-D", "-f", config], stdout=subprocess.DEVNULL,
                                                stderr=subprocess.DEVNULL))
                time.sleep(2)
            last = self.run_it([ROOT / "scripts/slurm/predict", "job.toml", "by_slurm", "3", "1"],
                               **environment).stdout.strip()
            self.assertTrue(last.isdigit(), last)
            for _ in range(240):
                if not self.run_it(["squeue", "-h"], **environment).stdout.strip():
                    break
                time.sleep(0.5)
            logs = "".join(f.read_text() for f in (self.folder / "by_slurm/log").glob("*.txt"))
            self.assertTrue((self.folder / "by_slurm/summary.json").exists(), logs)
            self.assertEqual(digest(self.folder / "by_slurm"), self.expected)
        finally:
            for daemon in reversed(daemons):
                daemon.terminate()
                daemon.wait()


if __name__ == "__main__":
    unittest.main(verbosity=2)
