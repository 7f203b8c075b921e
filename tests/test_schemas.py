# SPDX-License-Identifier: Apache-2.0
"""Holds the schemas that `vecino schema` prints against documents, with a JSON Schema validator: every scene and matrix
of the repository passes, and of the faulty documents those fail that a schema can tell.

Usage: test_schemas.py VECINO SOURCE_DIR. Exits with 125, skipped, where the validator is not installed.
"""

import copy
import json
import pathlib
import subprocess
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: the Python package jsonschema (python3-jsonschema) is not installed")
    sys.exit(125)

PROGRAM, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])


def changed(document, fault):
    """The document with fault["put"] at the place of the JSON pointer, or without what stands there."""
    if not fault["at"]:
        return fault["put"]
    document = copy.deepcopy(document)
    *path, last = [part.replace("~1", "/").replace("~0", "~") for part in fault["at"].split("/")[1:]]
    parent = document
    for part in path:
        parent = parent[int(part) if isinstance(parent, list) else part]
    if "put" not in fault:
        del parent[int(last) if isinstance(parent, list) else last]
    elif isinstance(parent, list):
        parent[int(last) : int(last) + 1] = [fault["put"]]
    else:
        parent[last] = fault["put"]
    return document


def check(kind, files, faulty):
    """The number of documents judged rightly, and what was judged wrongly."""
    schema = json.loads(subprocess.run([PROGRAM, "schema", kind], capture_output=True, check=True).stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    table = json.loads((SOURCE / "tests/data" / faulty).read_text())
    others = ["*.schema.json"] + ([] if kind == "failure" else ["*.failure.json"])
    paths = [path for path in sorted(SOURCE.glob(files)) if not any(path.match(other) for other in others)]
    documents = [(str(path), json.loads(path.read_text()), True) for path in paths]
    documents.append((f"{faulty}: sound", table["sound"], True))
    for fault in table["faults"]:
        documents.append((f"{faulty}: {fault['error']}", changed(table["sound"], fault), not fault["schema"]))
    wrong = [name for name, document, valid in documents if validator.is_valid(document) != valid]
    return len(documents) - len(wrong), wrong


def main():
    failed = False
    for kind, files, faulty in (
        ("scene", "scenes/**/*.json", "faulty_scenes.json"),
        ("matrix", "configs/*.json", "faulty_matrices.json"),
        ("failure", "scenes/failures/*.failure.json", "faulty_failures.json"),
    ):
        right, wrong = check(kind, files, faulty)
        print(f"{kind}: {right} documents judged rightly, {len(wrong)} wrongly")
        for name in wrong:
            print(f"  wrong: {name}")
        failed = failed or wrong or right == 0
    return 1 if failed else 0


sys.exit(main())
