"""Runs Camber in the background: the executable, or the Python module where there is no executable."""
import json
import os
import re
import shutil
import subprocess
import sys
import threading

from . import operations


class NoCamber(Exception):
    def __init__(self):
        super().__init__("Camber is not installed: neither the program camber (on the PATH, in the environment variable "
                         "CAMBER or in the preference Mod/Camber/Executable) nor its Python module was found")


class Outcome:
    """How a command ended. status: 0 done, 1 input wrong, 3 numbers did not work out; None: cancelled."""

    def __init__(self, status, output, messages, figures):
        self.status, self.output, self.messages, self.figures = status, output, messages, figures

    @property
    def ok(self):
        return self.status == 0

    @property
    def reasons(self):
        """Sentences that say why the numbers did not work out."""
        return re.findall(r"^(?:camber: )?error: (.*)$", self.output, re.M)


def executable():
    """The program camber, or None."""
    preferred = ""
    try:
        import FreeCAD
        preferred = FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Camber").GetString("Executable", "")
    except ImportError:
        pass
    for name in (preferred, os.environ.get("CAMBER", ""), "camber"):
        found = shutil.which(name) if name else None
        if found:
            return found
    return None


def module():
    try:
        import camber
        return camber
    except ImportError:
        return None


MATERIALS = ["C45", "42CrMo4", "1.2343", "1.2379", "Al6082-T6"]  # to begin with; Camber knows many more names


def machine_presets():
    """Classes of machines, "preset:vmc-40", as the program tells them."""
    program = executable()
    if not program:
        return []
    text = subprocess.run([program, "init", "--help"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True).stdout
    return list(dict.fromkeys(name for name in re.findall(r"preset:[a-z0-9-]+", text)))


def problems_of_job(toml):
    """What Camber says of a job file when it reads it."""
    program = executable()
    if program:
        return subprocess.run([program, "--effective-config", "predict", toml, "-o", os.path.dirname(toml) + "/none"],
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              universal_newlines=True, **_hidden()).stderr
    camber = module()
    if camber is None:
        raise NoCamber()
    try:
        camber.read_job(toml)
    except camber.InputError as problem:
        return "\n".join(str(d) for d in problem.diagnostics)
    return ""


class Run:
    """One command on a job's files. Start it, ask `fraction` and `what` now and then, call cancel() to end it.

    command: "predict", "compensate" or "adapt"; output: a folder for predict, a program for the others.
    """

    def __init__(self, files, command, output, options=()):
        self.files, self.command, self.output, self.options = files, command, output, list(options)
        self.fraction, self.what = 0.0, ""
        self.outcome = None
        self._process = None
        self._cancelled = False
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._json = os.path.join(files.folder, command + ".json")

    def start(self):
        if executable() is None and module() is None:
            raise NoCamber()
        self._thread.start()
        return self

    def running(self):
        return self._thread.is_alive()

    def wait(self):
        self._thread.join()
        return self.outcome

    def cancel(self):
        self._cancelled = True
        process = self._process
        if process is not None and process.poll() is None:
            process.terminate()

    def _work(self):
        try:
            status, output = self._execute() if executable() else self._call()
        except Exception as problem:  # a thread's exception would be lost
            status, output = 1, "error: %s" % problem
        figures = {}
        if status in (0, 3) and os.path.exists(self._json):
            with open(self._json, encoding="utf8") as file:
                figures = json.load(file)
        self.outcome = Outcome(None if self._cancelled else status, output,
                               operations.messages_of(output, self.files.spans), figures)

    # -- the executable

    def _arguments(self):
        out = [executable(), self.command, self.files.toml, "-o", self.output, "--json", self._json]
        if self.command == "predict":
            out.append("--meshes")
        return out + self.options

    def _execute(self):
        """Standard error is a terminal where there are any, so that progress is shown there."""
        if os.path.exists(self._json):
            os.remove(self._json)
        try:
            import pty
            master, slave = pty.openpty()
        except (ImportError, OSError):
            process = self._begin(subprocess.PIPE, **_hidden())
            text = process.communicate()[1].decode("utf8", "replace")
            return process.returncode, text
        process = self._begin(slave)
        os.close(slave)
        pieces = []
        while True:
            try:
                piece = os.read(master, 4096)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            pieces.append(piece)
            self._take_progress(piece.decode("utf8", "replace"))
        os.close(master)
        text = b"".join(pieces).decode("utf8", "replace").replace("\r\n", "\n")
        return process.wait(), re.sub(r"\r[^\n]*?\x1b\[K(?:[^\n\r]*(?=\r))?", "", text)

    def _begin(self, errors, **how):
        process = self._process = subprocess.Popen(self._arguments(), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                                   stderr=errors, env=dict(os.environ, NO_COLOR="1"), **how)
        if self._cancelled:  # before there was a process to end
            process.terminate()
        return process

    def _take_progress(self, text):
        for m in re.finditer(r"\s*(\d+) % \[[#.]*\] ([^\r\n\x1b,]*)", text):
            self.fraction, self.what = int(m[1]) / 100, m[2].strip()

    # -- the module

    def _progress(self, what, fraction):
        self.what, self.fraction = what, fraction
        return not self._cancelled

    def _call(self):
        camber = module()
        try:
            if self.command == "predict":
                result = camber.predict(self.files.toml, output_folder=self.output, meshes=True,
                                        progress=self._progress)
                reasons = result.doubts
            elif self.command == "compensate":
                result = camber.compensate(self.files.toml, output=self.output, progress=self._progress)
                reasons = [] if result.success else list(result.reasons)
            else:
                result = camber.adapt(self.files.toml, progress=self._progress)
                with open(self.output, "w", encoding="utf8", newline="") as file:
                    file.write(result.program)
                reasons = [] if result.success else list(result.reasons)
        except camber.Cancelled:
            return None, ""
        except camber.InputError as problem:
            return 1, "\n".join(str(d) for d in problem.diagnostics)
        except camber.BeyondModel as problem:
            return 3, "error: %s" % problem
        with open(self._json, "w", encoding="utf8") as file:
            file.write(result.json)
        output = "\n".join([str(d) for d in result.diagnostics] + ["error: %s" % reason for reason in reasons])
        return (3 if reasons else 0), output


def _hidden():
    return {"creationflags": 0x08000000} if sys.platform == "win32" else {}  # no console window
