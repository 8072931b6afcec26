"""scripts/pack-trace gives back what it packed, byte for byte, and refuses what it could not; tests/data is in order."""
import importlib.machinery
import importlib.util
import lzma
import pathlib
import random
import unittest

ROOT = pathlib.Path(__file__).parents[2]
DATA = ROOT / "tests" / "data"
MOST_BYTES = 10_000_000

loader = importlib.machinery.SourceFileLoader("pack_trace", str(ROOT / "scripts" / "pack-trace"))
loader_spec = importlib.util.spec_from_loader("pack_trace", loader)
script = importlib.util.module_from_spec(loader_spec)
loader.exec_module(script)


class PackTrace(unittest.TestCase):
    def round_trip(self, text):
        self.assertEqual(script.unpack(script.pack(text)), text)

    def refused(self, text):
        with self.assertRaises(SystemExit) as end:
            script.unpack(script.pack(text))
        return str(end.exception)

    def test_gives_back_what_it_packed(self):
        noise = random.Random(1)
        rows = ["t_s,x_mm,y_mm,line"]
        for i in range(500):
            rows.append(f"{i / 1000:.3f},{noise.randint(-10**7, 10**7) / 1e4:.9g},{noise.randint(1, 99) / 1e4 - 300:.7g},{i // 7}")
        self.round_trip("\n".join(rows) + "\n")

    def test_takes_few_rows_and_large_numbers(self):
        self.round_trip("a,b\n")
        self.round_trip("a\n0\n")
        self.round_trip("a,b,c\n-0.05,123456789012.25,7\n-12,-123456789012,-8\n0.5,0,0\n")
        self.round_trip("a\n0.000\n-1.500\n10.000\n")

    def test_refuses_other_forms(self):
        for cell in ("1e-05", "007", ".5", "5.", "+1", "", "nan"):
            self.assertEqual(self.refused(f"a,b\n1,2.5\n2,{cell}\n"),
                             f"pack-trace: column b: {cell!r} is not a decimal number in its shortest form")
        # A zero with a sign; zeros at the end of some numbers, but not of all.
        for text in ("a\n-0\n", "a\n1.50\n1.255\n2\n"):
            self.assertEqual(self.refused(text), "pack-trace: unpacking does not give the text that was packed")
        self.assertIn("a line feed", self.refused("a\n1"))
        self.assertIn("as many columns", self.refused("a,b\n1\n"))
        self.assertIn("as many columns", self.refused("a b\n1\n"))

    def test_refuses_a_damaged_file(self):
        with self.assertRaises((EOFError, lzma.LZMAError)):
            script.unpack(script.pack("a\n1\n2\n")[:-20])
        with self.assertRaises(SystemExit):
            script.unpack(lzma.compress(b"no trace"))


class TestData(unittest.TestCase):
    def test_is_small_and_described(self):
        self.assertLess(sum(f.stat().st_size for f in DATA.rglob("*") if f.is_file()), MOST_BYTES)
        readme = (DATA / "README.md").read_text()
        for entry in DATA.iterdir():
            if entry.is_dir():
                self.assertIn(f"| `{entry.name}/` |", readme)
        for entry in [*(DATA / "nc").iterdir(), *(DATA / "cases").iterdir()]:
            self.assertIn(f"| `{entry.name}` |", readme)


if __name__ == "__main__":
    unittest.main()
