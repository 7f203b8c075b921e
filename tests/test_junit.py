# SPDX-License-Identifier: Apache-2.0
"""Reads the JUnit XML of `vecino check` with an XML parser: a run that passes, one whose error grew, and names that need
escaping. Usage: test_junit.py VECINO SOURCE_DIR.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

PROGRAM, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
AWKWARD = 'a & b <"\'>'


def vecino(*arguments, code=0):
    """What the program prints; its exit code must be the given one."""
    environment = {key: value for key, value in os.environ.items() if key != "CI"}
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, env=environment)
    assert done.returncode == code, (arguments, done.returncode, done.stderr)
    return done.stdout


def cases_of(path):
    """Test cases by outcome, after the counts of every suite were held against them."""
    root = ElementTree.parse(path).getroot()
    assert root.tag == "testsuites"
    for suite in root.iter("testsuite"):
        assert int(suite.get("tests")) == len(suite.findall("testcase"))
        assert int(suite.get("failures")) == len(suite.findall("testcase/failure"))
        assert int(suite.get("skipped")) == len(suite.findall("testcase/skipped"))
    cases = list(root.iter("testcase"))
    return cases, [case for case in cases if case.find("failure") is not None]


def main():
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        scene = work / (AWKWARD + ".json")
        scene.write_text((SOURCE / "scenes/cornell.json").read_text())
        matrix = {
            "name": AWKWARD,
            "axes": {"scene": scene.name, "scheme": ["nearest", "mean"], "reduction": 2, "seed": [1, 2, 3]},
            "fixed": {"size": [16, 16], "spp": 8},
            "reference": {"spp": 64},
            "gates": [{"class": AWKWARD, "where": {"method": "mean"}}],
        }
        (work / "m.json").write_text(json.dumps(matrix))
        run, baseline, report = str(work / "run"), str(work / "b.json"), str(work / "j.xml")
        vecino("run", str(work / "m.json"), "-o", run)
        vecino("accept", run, "--baseline", baseline)

        vecino("check", run, "--baseline", baseline, "--junit", report)
        cases, failed = cases_of(report)
        assert cases and not failed
        assert f"{AWKWARD}.{AWKWARD}" in {case.get("classname") for case in cases}

        results = work / "run/results.jsonl"
        rows = [json.loads(line) for line in results.read_text().splitlines()]
        for row in rows:
            if row["method"] == "mean":
                row["metrics"]["p99_error"] *= 4
        results.write_text("".join(json.dumps(row) + "\n" for row in rows))
        vecino("check", run, "--baseline", baseline, "--junit", report, code=2)
        cases, failed = cases_of(report)
        assert [case.get("name") for case in failed] == [f"{AWKWARD}.mean.f2.w3 p99_error mean"], failed
        assert failed[0].find("failure").get("type") == "mean"
        assert "tolerance" in failed[0].find("failure").text


main()
