# SPDX-License-Identifier: Apache-2.0
"""Kills runs and renders with SIGKILL at random moments, and goes on: nothing that was finished is lost, nothing half-written is
read, and the end is that of a run in peace. Usage: kill_nine.py PROGRAM SOURCE_DIR [KILLS [SEED]]"""

import json
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import time

import exr

MATRIX = {
    "name": "kills",
    "axes": {"scene": ["first.json", "second.json"], "scheme": ["nearest", "mean", "distance3d_normal"],
             "reduction": [2, 3], "seed": [1, 2]},
    "include": [{"image": "copied"}],
    "images": {"copied": {"command": ["cp", "made_elsewhere.exr", "{output}"]}},
    "fixed": {"size": [32, 24], "spp": 64},
    "reference": {"spp": 512, "seed": 1000},
}


def check(holds, what):
    if not holds:
        sys.exit(f"kill_nine: {what}")


def files_below(folder):
    return {path.relative_to(folder).as_posix(): path for path in sorted(folder.rglob("*")) if path.is_file()}


def is_temporary(name):
    return name.rsplit("/", 1)[-1].startswith(".vecino.")


def rows_of(folder):
    """Whole lines alone: those are what a later run goes on from."""
    path, rows = folder / "results.jsonl", {}
    for line in path.read_bytes().splitlines() if path.exists() else []:
        try:
            row = json.loads(line)
        except ValueError:
            continue
        # what a clock, or the place, says may differ
        rows[row["cell"]] = {key: value for key, value in row.items() if key != "time_s"}
    return rows


class Program:
    def __init__(self, path, folder):
        self.path, self.folder, self.kills, self.survived = path, folder, 0, 0

    def start(self, *arguments):
        return subprocess.Popen([self.path, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def finish(self, *arguments):
        process = self.start(*arguments)
        text = process.communicate()[0].decode()
        check(process.returncode == 0, f"{arguments} ended with {process.returncode}: {text}")

    def kill_after(self, delay_s, *arguments):
        """Whether it was killed before its end."""
        process = self.start(*arguments)
        try:
            text = process.communicate(timeout=delay_s)[0].decode()
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.kills += 1
            return True
        check(process.returncode == 0, f"{arguments} ended with {process.returncode}: {text}")
        self.survived += 1
        return False


def check_whole(folder, peace):
    """Every file under its own name is whole; of those that no clock decides, each is that of the run in peace."""
    for name, path in files_below(folder).items():
        if is_temporary(name):
            continue
        data = path.read_bytes()
        if name.endswith((".exr", ".png", ".js")):
            check(data == (peace / name).read_bytes(), f"{name} is not the one of a run in peace")
        elif name.endswith(".json"):
            json.loads(data)
        elif name.endswith(".html"):
            check(data.rstrip().endswith(b"</html>"), f"{name} is cut off")
        elif name.endswith(".csv"):
            check(data.endswith(b"\n"), f"{name} is cut off")


def check_rows(rows, before, peace, folder):
    check(before.keys() <= rows.keys(), f"lost: {sorted(before.keys() - rows.keys())}")
    for cell, row in rows.items():
        check(row == peace[cell], f"{cell} differs from a run in peace: {row}")
        check((folder / "cells" / cell / "image.exr").exists(), f"{cell} is finished and has no image")


def kill_runs(program, kills, chance, peace, span_s):
    """Runs under fire until the kills are spent; a run that gets through is checked, and begun anew."""
    folder, rows = program.folder / "shot", {}
    expected = rows_of(peace)
    while program.kills < kills:
        killed = program.kill_after(chance.uniform(0, span_s), "run", "m.json", "-o", "shot")
        check_whole(folder, peace) if folder.exists() else None
        found = rows_of(folder)
        check_rows(found, rows, expected, folder)
        rows = found
        if not killed:
            check_end(folder, expected)
            shutil.rmtree(folder)
            rows = {}
    program.finish("run", "m.json", "-o", "shot")
    check_end(folder, expected)


def check_end(folder, expected):
    check(rows_of(folder) == expected, "the end is not that of a run in peace")
    left = [name for name in files_below(folder) if is_temporary(name)]
    check(not left, f"temporary files of killed runs are left: {left}")


def kill_renders(program, kills, chance):
    """The output is always whole: the old one or the new one."""
    out = program.folder / "out.exr"
    old = b"an older result"
    render = ("render", "first.json", "-o", "out.exr", "--size", "160x120", "--spp", "16")
    began = time.monotonic()
    program.finish(*render)
    span_s, new = time.monotonic() - began, exr.read(out)
    while program.kills < kills:
        out.write_bytes(old)
        killed = program.kill_after(chance.uniform(0, span_s), *render)
        is_old = out.read_bytes() == old
        check(killed or not is_old, "a render that ended left the older image")
        # its header says how long it took, so that bytes differ
        check(is_old or exr.read(out) == new, "a render left half an image")


def main():
    program_path, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    kills = int(sys.argv[3]) if len(sys.argv) > 3 else 50
    seed = int(sys.argv[4]) if len(sys.argv) > 4 else time.time_ns() % 1000000
    print(f"seed {seed}", flush=True)
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory(prefix="vecino-kill-") as name:
        program = Program(program_path, pathlib.Path(name))
        for scene, file in (("first", "cornell"), ("second", "cornell_sphere")):
            shutil.copy(source / "scenes" / f"{file}.json", program.folder / f"{scene}.json")
        program.finish("render", "first.json", "-o", "made_elsewhere.exr", "--size", "32x24", "--spp", "4")
        (program.folder / "m.json").write_text(json.dumps(MATRIX))
        began = time.monotonic()
        program.finish("run", "m.json", "-o", "peace")
        took_s = time.monotonic() - began
        kill_runs(program, kills - kills // 5, chance, program.folder / "peace", 0.6 * took_s)
        kill_renders(program, kills, chance)
        print(f"{program.kills} kills, {program.survived} runs that ended before theirs: nothing lost, nothing half")


main()
