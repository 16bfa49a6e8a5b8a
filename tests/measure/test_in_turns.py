#!/usr/bin/env python3
"""tests/measure/in_turns, with a real build and with programs that only look like one."""

import os
import pathlib
import stat
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
WORLD = ["--", "column", "--servers", "2", "--seconds", "1", "--no-references", "--no-judge"]


def compare(*arguments):
    return subprocess.run([HERE / "in_turns", *arguments], capture_output=True, text=True)


def program(folder, name, body):
    path = folder / name
    path.write_text("#!/bin/sh\n" + body, encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def expect(holds, what, got):
    if not holds:
        sys.exit(f"{what}: exit status {got.returncode}\n{got.stdout}{got.stderr}")


def main(aureole, folder):
    alike = compare(f"a={aureole}", f"b={aureole}", "--turn", "0.1", *WORLD)
    expect(alike.returncode == 0 and "The same states" in alike.stdout, "one build twice", alike)
    rows = [line.split() for line in alike.stdout.splitlines() if line[:1] in ("a", "b")]
    expect(len(rows) == 2 and rows[0][5:8] == ["1.0000"] * 3, "the first one is the measure", alike)
    expect(0 < float(rows[1][5]) < 100, "the second one is compared with it", alike)

    other = program(folder, "other", f'shift; exec {aureole} experiment "$@" --seed 2\n')
    differ = compare(f"a={aureole}", f"b={other}", *WORLD)
    expect(differ.returncode == 1 and "states differ" in differ.stdout, "another world", differ)

    fails = program(folder, "fails", "echo no such layout >&2; exit 2\n")
    failed = compare(f"a={aureole}", f"b={fails}", *WORLD)
    expect(failed.returncode == 1 and failed.stderr == "b failed: no such layout\n",
           "a build that fails", failed)

    for wrong in ([f"a={aureole}", *WORLD], [f"a={aureole}", f"a={aureole}", *WORLD],
                  [f"a={aureole}", "b=/nowhere", *WORLD], [aureole, f"b={aureole}", *WORLD],
                  [f"a={aureole}", f"b={aureole}"],
                  [f"a={aureole}", f"b={aureole}", "--processor", "9999", *WORLD],
                  [f"a={aureole}", f"b={aureole}", "--turn", "0", *WORLD],
                  [f"a={aureole}", f"b={aureole}", "--turn", "nan", *WORLD]):
        refused = compare(*wrong)
        expect(refused.returncode == 2 and "error:" in refused.stderr, f"refuses {wrong}", refused)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        main(os.path.abspath(sys.argv[1]), pathlib.Path(scratch))
