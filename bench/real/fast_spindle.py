#!/usr/bin/env python3
"""bench/real/fast_spindle.py PROGRAM RPM FIRST LAST OUT: the program with the spindle at RPM in the lines FIRST to LAST.

Every S word of these lines becomes RPM, and every F word is scaled by the same factor as the S word in force, so that the feed per
tooth stays. Everything else is copied byte for byte.
"""
import re
import sys

WORD = re.compile(r"(?<![A-Za-z])([SF])(\d*\.?\d+\.?)")


def number(value):
    return ("%.4f" % value).rstrip("0")


def faster(lines, rpm):
    """`lines`, with speeds and feeds scaled; raises where a feed comes before the first speed."""
    factor, out = None, []
    for line in lines:
        code, bracket, comment = line.partition("(")
        speed = re.search(r"S(\d+)", code)
        if speed:
            factor = rpm / float(speed[1])
        if factor is None and re.search(r"F[\d.]", code):
            raise ValueError("a feed comes before the first spindle speed: " + line.strip())
        out.append(WORD.sub(lambda m: "S%d" % rpm if m[1] == "S" else "F" + number(factor * float(m[2])), code) + bracket + comment)
    return out


def main():
    program, rpm, first, last, out = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4]), sys.argv[5]
    with open(program, encoding="latin-1", newline="") as file:
        lines = file.readlines()
    lines[first - 1:last] = faster(lines[first - 1:last], rpm)
    with open(out, "w", encoding="latin-1", newline="") as file:
        file.writelines(lines)


if __name__ == "__main__":
    main()
