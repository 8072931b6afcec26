"""Runs camber on a pseudo terminal and follows what its progress line calls the stage that goes on."""
import os
import pty
import re
import select
import time

LINE = re.compile(r"^(?:\s*\d+ % \[[#.]+\] )?(.*?)(?:, \d+ (?:s|min) (?:so far|left))?$")


def resident_MB(pid):
    try:
        with open("/proc/%d/status" % pid, encoding="ascii") as file:
            for line in file:
                if line.startswith("VmRSS:"):
                    return int(line.split()[1]) / 1024
    except OSError:
        pass
    return 0.0


class StagedRun:
    """stages: name, begin_s and peak_MB of each as the progress line has them, in order. Stages under a second are
    part of the one before."""

    def __init__(self, command, period_s=0.05, nice=0):
        self.stages, self.text = [{"name": "begin", "begin_s": 0.0, "peak_MB": 0.0, "left": False}], ""
        begin = time.monotonic()
        pid, terminal = pty.fork()
        if pid == 0:
            os.nice(nice)
            os.environ["TERM"] = "dumb"
            os.execvp(command[0], command)
        self.started(pid)
        done = False
        while not done:
            ready, _, _ = select.select([terminal], [], [], period_s)
            if ready:
                try:
                    done = not self.take(os.read(terminal, 65536).decode(errors="replace"), time.monotonic() - begin)
                except OSError:
                    done = True
            now = self.stages[-1]
            now["peak_MB"] = max(now["peak_MB"], resident_MB(pid))
        _, status, usage = os.wait4(pid, 0)
        self.ended = time.monotonic()
        os.close(terminal)
        self.status = os.waitstatus_to_exitcode(status)
        self.clock_s = self.ended - begin
        self.processor_s = usage.ru_utime + usage.ru_stime
        self.peak_MB = usage.ru_maxrss / 1024

    def started(self, pid):
        """For those who want to do something to it."""

    def take(self, text, now_s):
        self.text += text
        for piece in text.split("\r\x1b[K")[1:]:
            piece = piece.split("\r")[0].strip()
            if not piece or "\n" in piece:
                continue
            name = LINE.match(piece).group(1)
            if name != self.stages[-1]["name"]:
                self.stages.append({"name": name, "begin_s": now_s, "peak_MB": 0.0, "left": False})
            self.stages[-1]["left"] |= piece.endswith(" left")
        return bool(text)
