# SPDX-License-Identifier: Apache-2.0
"""Sets the table of `vecino report DIR -o FILE.tex` with pdflatex, for a run whose names hold every special character.

Usage: test_latex.py VECINO SOURCE_DIR. Exits with 125, skipped, where pdflatex or its package booktabs is not installed.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

PROGRAM, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
SPECIAL = "a_b%c$d&e#f{g}h~i^j--k'l`m"

if not shutil.which("pdflatex") or subprocess.run(["kpsewhich", "booktabs.sty"], stdout=subprocess.DEVNULL).returncode:
    print("skipped: pdflatex with booktabs (texlive-latex-recommended) is not installed")
    sys.exit(125)

DOCUMENT = r"""\documentclass{article}
\usepackage{booktabs}
\usepackage{longtable}
\begin{document}
\input{table}
\end{document}
"""


def set_table(folder, windows):
    """Runs a matrix, and sets its table; returns the log."""
    matrix = {
        "name": SPECIAL + '"<|>\\',
        "axes": {"scene": [f"{SPECIAL}.json"], "scheme": ["nearest", "mean"], "reduction": [2], "window": windows},
        "fixed": {"size": [12, 8], "spp": 2},
        "reference": {"spp": 16},
    }
    (folder / "matrix.json").write_text(json.dumps(matrix))
    shutil.copy(SOURCE / "scenes/cornell.json", folder / f"{SPECIAL}.json")
    subprocess.run([PROGRAM, "run", "matrix.json", "-o", "run"], cwd=folder, check=True, capture_output=True)
    subprocess.run([PROGRAM, "report", "run", "-o", "table.tex"], cwd=folder, check=True, capture_output=True)
    (folder / "document.tex").write_text(DOCUMENT)
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "document.tex"]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace")
    assert result.returncode == 0, result.stdout[-2000:]
    assert (folder / "document.pdf").stat().st_size > 1000
    return (folder / "table.tex").read_text()


def main():
    for windows, environment in (([3, 5], "tabular"), (list(range(3, 103, 2)), "longtable")):
        with tempfile.TemporaryDirectory() as name:
            assert f"\\begin{{{environment}}}" in set_table(pathlib.Path(name), windows)
    print("pdflatex sets both forms of the table")


main()
