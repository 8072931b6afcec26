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
            done = subprocess.run(["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), CAMBER, "-v",
                                   "predict", "job.toml", "-o", place, "--threads", "1"],
                                  cwd=self.folder, capture_output=True, text=True)
            if "is built without MPI" in done.stderr:
                self.skipTest("camber is built without MPI")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("rank %d: " % (ranks - 1), done.stderr)
            self.assertEqual(digest(self.folder / place), self.expected)

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
    unittest.main()
