"""What the module promises in seconds: a quick import, other threads and Ctrl-C while a call runs. Nothing else may run
meanwhile.
"""
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

import camber
from quick_inputs import COARSE, MACHINE, SAMPLE, long_program


class Threads(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        done, ticks = threading.Event(), []

        def tick():
            while not done.wait(0.01):
                ticks.append(time.monotonic())
        ticking = threading.Thread(target=tick)
        ticking.start()
        begin = time.monotonic()
        camber.predict(COARSE)
        took = time.monotonic() - begin
        done.set()
        ticking.join()
        gaps = [b - a for a, b in zip(ticks, ticks[1:])]
        self.assertGreater(len(ticks), 5 * took)  # a call that keeps the GIL leaves none
        self.assertLess(max(gaps), max(0.5, took / 4))


class Signals(unittest.TestCase):
    """Ctrl-C is honoured within half a second, wherever a call is."""
    LIMIT_S = 0.5

    def interrupted(self, call, after_s):
        """Seconds from SIGINT to KeyboardInterrupt; None where the call was done before."""
        sent = []

        def send():
            sent.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        timer = threading.Timer(after_s, send)
        timer.start()
        try:
            call()
            timer.cancel()
            timer.join()
            if sent:
                time.sleep(0.01)  # the signal comes now
            return None
        except KeyboardInterrupt:
            return time.monotonic() - sent[0]

    def everywhere(self, name, call):
        take_s = self.timed(call)
        latencies = []
        for step in range(1, 6):
            latency = None
            while latency is None:  # a call that was done before the signal: it takes less than was thought
                try:
                    latency = self.interrupted(call, take_s * step / 6)
                except KeyboardInterrupt:  # the signal came when the call had just ended
                    pass
                if latency is None:
                    take_s *= 0.8
                    self.assertGreater(take_s, 0.01, name)
            latencies.append(latency)
        print(f"{name}: {len(latencies)} interrupts, at most {1000 * max(latencies):.0f} ms", file=sys.stderr)
        self.assertLess(max(latencies), self.LIMIT_S, name)

    def timed(self, call):
        begin = time.monotonic()
        call()
        return time.monotonic() - begin

    def test_predict(self):
        call = lambda: camber.predict(SAMPLE / "job.toml")  # noqa: E731
        self.everywhere("predict", call)

    def test_compensate(self):
        self.everywhere("compensate", lambda: camber.compensate(COARSE))

    def test_fit_feed(self):
        call = lambda: camber.fit_feed([(SAMPLE / "trace_program.nc", SAMPLE / "trace.csv")], MACHINE)  # noqa: E731
        self.everywhere("fit_feed", call)

    def test_feed(self):
        program = long_program(40)
        call = lambda: camber.feed(program, MACHINE, points=False)  # noqa: E731
        self.everywhere("feed", call)

    def test_the_module_works_after_an_interrupt(self):
        before = camber.predict(COARSE).json
        self.interrupted(lambda: camber.predict(COARSE), 0.3)
        after = camber.predict(COARSE).json
        strip = lambda text: [line for line in text.splitlines() if "compute_s" not in line]  # noqa: E731
        self.assertEqual(strip(before), strip(after))


class Import(unittest.TestCase):
    def test_it_takes_less_than_300_ms(self):
        code = "import time; a = time.perf_counter(); import camber; print(time.perf_counter() - a)"
        times = [float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True).stdout)
                 for _ in range(5)]
        self.assertLess(min(times), 0.3)
        print(f"import: {1000 * min(times):.0f} ms", file=sys.stderr)


if __name__ == "__main__":
    unittest.main()
