#!/usr/bin/env python3
"""The installed package: found by CMake and pkg-config in a prefix that was moved, with headers that stand alone.

    installed_library_test.py SOURCE_DIR BUILD_DIR
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
SAMPLE = SOURCE / "samples/01-finishing"
FOREIGN = re.compile(r"/(openvdb|ceres|tbb|oneapi|fmt|Eigen|boost|nlohmann)/")


def run(*command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        run("cmake", "--install", BUILD, "--prefix", cls.out / "first")
        (cls.out / "elsewhere").mkdir()
        cls.prefix = cls.out / "elsewhere" / "moved"
        shutil.move(cls.out / "first", cls.prefix)
        cls.include = cls.prefix / "include"

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_examples_build_against_it_and_run(self):
        build = self.out / "examples"
        run("cmake", "-G", "Ninja", "-S", SOURCE / "examples/library", "-B", build,
            f"-DCMAKE_PREFIX_PATH={self.prefix}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        run("cmake", "--build", build)
        study = run(build / "acceleration_study", SAMPLE / "finish.nc", SAMPLE / "machine.toml").splitlines()
        times = [float(line.split()[1]) for line in study[1:]]
        self.assertEqual(len(times), 5)
        self.assertEqual(times, sorted(times, reverse=True))  # a faster machine takes less
        worst = run(build / "worst_lines", SAMPLE / "job.toml")
        self.assertRegex(worst, r"95 % of the surface is within \d+\.\d\d um\nline +\d+:")
        stopped = subprocess.run([build / "compensate_job", SAMPLE / "job.toml", self.out / "out.nc", "0.3"],
                                 capture_output=True, text=True)
        self.assertEqual((stopped.returncode, stopped.stdout), (3, "not finished in time\n"))
        missing = subprocess.run([build / "worst_lines", "nowhere.toml"], capture_output=True, text=True)
        self.assertEqual(missing.returncode, 1)
        self.assertIn("[file-missing]", missing.stderr)

    def test_examples_are_short(self):
        examples = sorted((SOURCE / "examples/library").glob("*.cpp"))
        self.assertEqual(len(examples), 3)
        for example in examples:
            self.assertLess(len(example.read_text().splitlines()), 40, example.name)

    def test_pkg_config(self):
        flags = run("pkg-config", "--cflags", "--libs", "camber",
                    env={**os.environ, "PKG_CONFIG_PATH": str(self.prefix / "lib/pkgconfig")}).split()
        self.assertIn(str(self.prefix), flags[0])
        program = self.out / "by_pkg_config"
        run("g++", SOURCE / "examples/library/acceleration_study.cpp", *flags, "-o", program)
        run(program, SAMPLE / "finish.nc", SAMPLE / "machine.toml",
            env={**os.environ, "LD_LIBRARY_PATH": str(self.prefix / "lib")})

    def test_every_header_stands_alone(self):
        headers = sorted(self.include.rglob("*.h"))
        self.assertGreaterEqual(len(headers), 12)
        for header in headers:
            name = header.relative_to(self.include)
            source = self.out / "one.cpp"
            source.write_text(f"#include <{name}>\n")
            included = subprocess.run(
                ["g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-H", "-I", self.include, source],
                capture_output=True, text=True)
            self.assertEqual(included.returncode, 0, included.stderr)
            self.assertNotRegex(included.stderr, FOREIGN, name)
            self.assertIn(str(header), included.stderr)

    def test_only_public_names_are_shown(self):
        library = self.prefix / "lib/libcamber.so"
        names = [line.split(" ", 2)[2] for line in run("nm", "-D", "-C", "--defined-only", library).splitlines()]
        self.assertTrue(any(name.startswith("camber::v0::predict(") for name in names))
        kinds = ("camber::v0::", "typeinfo for camber::v0::", "typeinfo name for camber::v0::",
                 "vtable for camber::v0::")
        self.assertEqual([name for name in names if not name.startswith(kinds) and "openvdb" not in name], [])

    def test_the_find_module_for_openvdb(self):
        project = self.out / "openvdb"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(reader LANGUAGES CXX)\n"
            "find_package(camber CONFIG REQUIRED)\nlist(APPEND CMAKE_MODULE_PATH ${camber_MODULE_PATH})\n"
            "find_package(OpenVDB REQUIRED)\n"
            "if(NOT TARGET OpenVDB::openvdb)\n  message(FATAL_ERROR none)\nendif()\n")
        run("cmake", "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}")

    def test_another_version_is_refused(self):
        project = self.out / "version"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(reader LANGUAGES CXX)\n"
            "find_package(camber 0.4 CONFIG QUIET)\nif(camber_FOUND)\n  message(FATAL_ERROR found)\nendif()\n")
        run("cmake", "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}")

    def test_the_python_module_comes_with_it(self):
        package = self.prefix / "lib/python3/dist-packages"
        if not package.exists():
            self.skipTest("built without Python")
        job = SAMPLE / "job.toml"
        code = f"import camber; print(camber.__file__, camber.check({str(SAMPLE / 'finish.nc')!r}, job={str(job)!r}).blocks)"
        shown = run("/usr/bin/python3", "-c", code, env={**os.environ, "PYTHONPATH": str(package)})
        self.assertIn(str(package), shown)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
