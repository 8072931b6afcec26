#!/usr/bin/env python3
"""What cpack makes: a Debian package with everything in its place, whose program runs and whose Depends are those of its
files. Whether it installs on a bare Debian: scripts/check-package.

    debian_package_test.py SOURCE_DIR BUILD_DIR
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE, BUILD = (pathlib.Path(path).resolve() for path in sys.argv[1:3])


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


@unittest.skipUnless(shutil.which("dpkg-shlibdeps"), "no dpkg-dev")
class DebianPackage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        out = pathlib.Path(cls.folder.name)
        run("cpack", "-B", out / "packages", cwd=BUILD)
        cls.package = next((out / "packages").glob("*.deb"))
        cls.root = out / "root"
        run("dpkg-deb", "--extract", cls.package, cls.root)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def field(self, name):
        return run("dpkg-deb", "--field", self.package, name).strip()

    def test_its_name_and_version(self):
        version = re.search(r"project\(camber VERSION ([\d.]+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertEqual((self.field("Package"), self.field("Version")), ("camber", version))
        self.assertRegex(self.package.name, rf"^camber_{re.escape(version)}_\w+\.deb$")

    def test_everything_is_in_its_place(self):
        for path in ("usr/bin/camber", "usr/lib/libcamber.so", "usr/include/camber/camber.h",
                     "usr/lib/cmake/camber/camberConfig.cmake", "usr/lib/cmake/camber/modules/FindOpenVDB.cmake",
                     "usr/lib/pkgconfig/camber.pc", "usr/lib/python3/dist-packages/camber/__init__.py",
                     "usr/share/bash-completion/completions/camber", "usr/share/man/man1/camber.1",
                     "usr/share/camber/samples/01-finishing/job.toml", "usr/share/doc/camber/LICENSE",
                     "usr/share/doc/camber/examples/library/worst_lines.cpp"):
            self.assertTrue((self.root / path).exists(), path)

    def test_a_man_page_for_every_command(self):
        text = run(self.root / "usr/bin/camber", "--help")
        commands = re.findall(r"^  ([a-z-]+)  ", text[text.index("Subcommands:"):], flags=re.M)
        self.assertGreaterEqual(len(commands), 12)
        folder = self.root / "usr/share/man/man1"
        for command in commands:
            page = (folder / f"camber-{command}.1").read_text()
            for option in re.findall(r"^  (--[a-z-]+)", run(self.root / "usr/bin/camber", command, "--help"), re.M):
                self.assertIn(option.replace("-", "\\-"), page, command)
        if shutil.which("man"):
            for page in folder.glob("*.1"):
                faults = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", page],
                                        capture_output=True, text=True).stderr
                self.assertEqual(faults, "", page.name)

    def test_it_depends_on_what_its_files_link(self):
        depends = {re.split(r"[ (]", part.strip())[0] for part in re.split(r"[,|]", self.field("Depends"))}
        self.assertLessEqual({"libc6", "libstdc++6", "python3", "python3-numpy"}, depends)
        linked = ""
        for path in ("usr/bin/camber", "usr/lib/libcamber.so"):
            linked += run("objdump", "-p", self.root / path)
        for library in re.findall(r"NEEDED +(\S+)", linked):
            if library.startswith("libcamber"):
                continue
            file = re.search(rf"\b{re.escape(library)} .*=> (\S+)", run("ldconfig", "-p"))[1]
            if library in depends:  # liblapack.so.3 is what several packages provide
                continue
            found = run("dpkg-query", "--search", f"*/{os.path.basename(os.path.realpath(file))}")
            self.assertTrue({line.split(":")[0] for line in found.splitlines()} & depends, f"{library}: {found}")
        self.assertFalse([name for name in depends if name.endswith("-dev")])

    def test_program_and_module_run_from_it(self):
        sample = self.root / "usr/share/camber/samples/01-finishing"
        self.assertIn("blocks", run(self.root / "usr/bin/camber", "check", sample / "finish.nc"))
        shown = run("/usr/bin/python3", "-c", f"import camber; print(camber.check('{sample}/finish.nc').blocks)",
                    env={**os.environ, "PYTHONPATH": str(self.root / "usr/lib/python3/dist-packages")})
        self.assertGreater(int(shown), 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
