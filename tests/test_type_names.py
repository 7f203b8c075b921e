#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No two types that have one name: python3 test_type_names.py SOURCE_DIR

Two headers that are never read together may each have a type vecino::Verdict, and everything compiles; the linker then takes one of
both for what the standard library does with either. Types without a linkage of their own (in an unnamed namespace) may share names.
"""
import collections
import pathlib
import re
import sys

NAMESPACE = re.compile(r"(?:inline )?namespace\s*([\w:]*)\s*\{")
TYPE = re.compile(r"(?:enum class|enum|struct|class) (?:alignas\(\w+\) )?(\w+)(?: final)?(?: : [\w: ]+)? ?\{")


def types_of(path):
    spaces = []
    for line in path.read_text().splitlines():
        if opened := NAMESPACE.match(line):
            spaces.append(opened[1])
        elif line.startswith("}  // namespace"):
            spaces.pop()
        elif (defined := TYPE.match(line)) and "" not in spaces:
            yield "::".join(spaces + [defined[1]])


def main():
    root = pathlib.Path(sys.argv[1])
    places = collections.defaultdict(list)
    for folder in ["core", "filters", "eval", "tests"]:
        for path in sorted([*(root / folder).rglob("*.h"), *(root / folder).rglob("*.cpp")]):
            for name in types_of(path):
                places[name].append(str(path.relative_to(root)))
    assert len(places) > 100, f"found {len(places)} types: are these the sources?"
    shared = {name: where for name, where in places.items() if len(where) > 1}
    for name, where in shared.items():
        print(f"{name}: found in {', '.join(where)}, allowed: one place")
    sys.exit(1 if shared else 0)


main()
