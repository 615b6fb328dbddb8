#!/usr/bin/env python3
"""Mica's readers of tables and jobs against NumPy's and Python's own, on random inputs.

    compare_parsers.py READ_FILES SOURCE [COUNT [SEED]]

READ_FILES is the program beside this file. COUNT arrays, as many tables of text and as many jobs are made, as programs
write them, and most of them are damaged. Where both readers take a file, they must have read the same numbers, to the
last bit. What one refuses and the other takes is listed by Mica's reason. Exit code: 0 without a difference.
"""
import collections
import csv
import io
import json
import math
import random
import re
import subprocess
import sys
import tempfile
import tomllib
import warnings
from pathlib import Path

import numpy as np

NUMBERS = ["0", "-0.0", "1", "+1", "0.5", ".5", "5.", "1e3", "1E-3", "+1.5e+03", "1e400", "1e-400", "nan", "inf", "-inf",
           "4.9e-324", "0.1", "123456789012345678901234567890", "0x10", "1_000", "NA", "", "1e", "--1", "1,5", "True",
           "Infinity", "2.2250738585072011e-308", "9007199254740993", "-", "1 2", '"0.25"']
TOML = ["1", "-17", "1_000", "0x1F", "0o17", "0b101", "1.5", "-0.0", "1e3", "6.626e-34", "inf", "-inf", "nan", "true",
        "9223372036854775807", "9223372036854775808", "1.", ".5", "01", "1__0", '"a\\u00e9\\n"', "'lit\\eral'",
        '"""\nfirst\n\\\n   second"""', "'''\nx'y'''", "[1, 2.5, [3]]", "{ a = 1, b.c = 2 }", "1979-05-27T07:32:00Z",
        "07:32:00", "[1,\n# c\n2,]", "{ a = 1, }", '"\\x41"', '"\\ud800"', "1979-13-01", "+5", "[ ]", "{}", '""']
NAMES = ["u", "v", "s", "t"]


def damaged(data, chance, count=3):
    """Bytes with a few of them changed, left out, or written twice."""
    data = bytearray(data)
    for _ in range(chance.choice([0, chance.randrange(count + 1)])):
        place = chance.randrange(len(data) + 1)
        kind = chance.randrange(4)
        if kind == 0 and place < len(data):
            data[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            del data[place : place + chance.randrange(1, 4)]
        elif kind == 2:
            data[place:place] = data[place : place + chance.randrange(1, 9)]
        else:
            data[place:place] = chance.choice([b"\n", b"\r\n", b" ", b"\t", b"#", b'"', b",", b"\0", b"\xff", b"=", b"_"])
    return bytes(data)


def array_file(chance):
    columns = chance.randrange(1, 5)
    values = np.array([chance.gauss(0, 1) for _ in range(chance.randrange(1, 5) * columns)]).reshape(-1, columns)
    kind = chance.choice(["<f4", "<f8", ">f4", ">f8"] * 3 + ["<f2", "<i4", "<c8"])
    values = values.astype(kind)
    if chance.randrange(4) == 0:
        values = np.asfortranarray(values)
    if chance.randrange(8) == 0:
        values = values.reshape(-1)
    file = io.BytesIO()
    np.lib.format.write_array(file, values, version=chance.choice([(1, 0), (2, 0), (3, 0)]))
    return damaged(file.getvalue(), chance)


def by_numpy(data):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        array = np.load(io.BytesIO(data), allow_pickle=False)
    if array.ndim != 2 or array.dtype.kind != "f":
        raise ValueError(f"{array.ndim} dimensions of {array.dtype}")
    return array.astype(float)


def text_file(chance):
    separator = chance.choice([",", ",", ";", " ", "\t"])
    names = NAMES[: chance.choice([3, 4])]
    chance.shuffle(names)
    quote = chance.choice(["", "", '"'])
    number = lambda: chance.choice(NUMBERS) if chance.randrange(12) == 0 else repr(chance.gauss(0, 1))
    lines = [separator.join(quote + name + quote for name in names)]
    lines += [separator.join(number() for _ in names) for _ in range(chance.randrange(1, 5))]
    if chance.randrange(4) == 0:
        lines[0] = "# " + lines[0]
    if chance.randrange(4) == 0:
        lines.insert(chance.randrange(1, len(lines) + 1), chance.choice(["", "# a comment", "   "]))
    return damaged(chance.choice(["\n", "\r\n"]).join(lines).encode() + b"\n", chance, 2)


def by_loadtxt(data):
    lines = data.decode("utf-8").splitlines()
    while lines and (not lines[0].strip() or (lines[0].lstrip().startswith("#") and lines[1:2] and lines[1].lstrip()[:1] == "#")):
        lines.pop(0)
    header, rows = lines[0].lstrip().removeprefix("#").strip(), lines[1:]
    separator = next((mark for mark in ",;" if mark in header), None)
    split = lambda line: [cell.strip() for cell in next(csv.reader([line], delimiter=separator))] if separator else line.split()
    names = [name.strip('"') for name in split(header)]
    if sorted(names) not in (sorted(NAMES), sorted(NAMES[:3])):
        raise ValueError(f"names {names}")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        array = np.loadtxt(rows, delimiter=separator, quotechar='"', ndmin=2)
    if array.size and array.shape[1] != len(names):
        raise ValueError("another number of columns")
    order = [names.index(name) for name in NAMES if name in names]
    return array[:, order] if array.size else np.zeros((0, len(names)))


def toml_file(chance, jobs):
    lines = chance.choice(jobs).decode().split("\n")
    first = chance.randrange(len(lines))
    lines = lines[first : first + chance.randrange(1, 12)]
    for n in range(chance.randrange(4)):
        lines.insert(chance.randrange(len(lines) + 1), f"k{chance.randrange(4)}{chance.choice(['', '.a', '.b'])} = {chance.choice(TOML)}")
    if chance.randrange(4) == 0:
        lines.insert(chance.randrange(len(lines) + 1), chance.choice(["[x]", "[[y]]", "[x.z]", "[[y.w]]", "[k1]"]))
    return damaged("\n".join(lines).encode(), chance, 2)


def plain(value):
    """A document of tomllib's in the form that READ_FILES prints."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [plain(item) for item in value]
    if isinstance(value, float):
        return {"float": value}
    if isinstance(value, int) and not -(2**63) <= value < 2**63:
        raise ValueError("an integer beyond 64 bits")
    return value if isinstance(value, (str, int)) else {"date": True}


def same(a, b):
    """@param a of READ_FILES. @param b of `plain`."""
    if isinstance(b, dict) and set(b) == {"float"} and isinstance(b["float"], float):
        return isinstance(a, dict) and same_numbers([[a["float"]]], [[b["float"]]])
    if type(a) is not type(b):
        return False
    if isinstance(b, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in b)
    if isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return a == b


def same_numbers(a, b):
    bits = lambda x: "nan" if math.isnan(x) else x.hex()
    return [[bits(float.fromhex(x)) for x in row] for row in a] == [[bits(float(x)) for x in row] for row in b]


def main():
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1000
    chance = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    jobs = [path.read_bytes() for path in sorted(Path(sys.argv[2]).glob("data/jobs/*.toml"))]
    kinds = {"npy": (array_file, by_numpy), "csv": (text_file, by_loadtxt),
             "toml": (lambda c: toml_file(c, jobs), lambda data: plain(tomllib.loads(data.decode())))}
    differences = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind, (make, other) in kinds.items():
            files = [make(chance) for _ in range(count)]
            paths = [Path(folder) / f"{n}.{kind}" for n in range(count)]
            for path, data in zip(paths, files):
                path.write_bytes(data)
            read = subprocess.run([sys.argv[1]], input="\n".join(map(str, paths)) + "\n", capture_output=True, text=True, check=True)
            answers = [json.loads(line) for line in read.stdout.splitlines()]
            assert len(answers) == count
            reasons, tally = collections.Counter(), collections.Counter()
            for data, answer in zip(files, answers):
                try:
                    expected, why = other(data), ""
                except Exception as error:  # NumPy refuses by whatever its own parts throw
                    expected, why = None, f"{type(error).__name__}: {error}"
                refused = answer.get("refused")
                tally["mica" * (refused is None) + " other" * (expected is not None)] += 1
                if refused is None and expected is not None:
                    if not (same(answer["toml"], expected) if kind == "toml" else same_numbers(answer["rows"], expected)):
                        differences += 1
                        print(f"{kind}: {data!r}\n  mica: {answer}\n  other: {expected}")
                elif refused is not None and expected is not None:
                    reasons["only mica refuses: " + re.sub(r"[^ ]*/[^ :]*:?|\d+|'[^']*'|\"[^\"]*\"", "_", refused)[:100]] += 1
                elif refused is None:
                    reasons["only mica takes: " + re.sub(r"\d+|'[^']*'|\"[^\"]*\"|\(at .*", "_", why)[:100]] += 1
            print(f"{kind}: both take {tally['mica other']}, mica alone {tally['mica']}, the other alone {tally[' other']}, "
                  f"neither {tally['']}")
            for reason, times in reasons.most_common():
                print(f"  {times:5} {reason}")
            if tally["mica other"] < count // 10:
                sys.exit(f"{kind}: hardly a file is taken by both: nothing was compared")
    sys.exit(differences != 0)


if __name__ == "__main__":
    main()
