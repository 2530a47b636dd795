#!/usr/bin/python3
"""Prints one table of the runs ROOT/<case>/<run> against their references, and makes a page of tables and pictures.

Calls the compare.py of each case. A page below docs/ gets its pictures as the figures of the cases' folders, another one
beside it. The parts of the page that are about other cases stay.
Usage: jobs/experiments.py ROOT PAGE CASE/RUN..."""

import json
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, "src/programs")
import impinge_compare  # noqa: E402

INTRODUCTION = """# Measured against exact solutions and experiments

    jobs/experiments.sh --fine

runs these cases and makes this page. Without `--fine` it takes ten minutes on two cores, and the coarse runs alone.
`jobs/experiments.sh CASE` runs one case. `input/CASE/compare.py RUN` compares any run of a case.

- An error is measured less reference, over the reference; where that is 0, over the scale that the metric names. Beside a
  measured band it is 0 inside of the band.
- The figure to beat is the best one that we know of another program.
- CPU time is that of one core. The consistent scheme runs with its defaults.
"""


def compared(case, runs, figure):
    """What compare.py says of runs: their list, each with its CPU time; draws the figure."""
    words = [f"input/{case}/compare.py", *map(str, runs), "--json", "--figure", str(figure)]
    results = json.loads(subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True).stdout)
    for result in results:
        result["cpu"] = float(pathlib.Path(result["run"], "cpu_seconds").read_text(encoding="utf-8"))
    return [result for k, result in enumerate(results) if not is_in_medians(result, results[k + 1 :])]


def is_in_medians(result, later):
    """Whether a later run has the medians of its figures and those of this run."""
    return any(other["resolution"] == result["resolution"] and any(row["metric"].startswith("median of") for row in other["rows"])
               for other in later)


def lines_of(results):
    """The cells of all rows: resolution and CPU time stand in the first row of a run."""
    for result in results:
        head, cost = result["resolution"], f"{result['cpu']:.0f}"
        if not result["rows"]:
            yield [head, f"run {result['status']} at t = {result['time']:.4g} s", *[""] * 5, cost]
        for row in result["rows"]:
            yield [head, *impinge_compare.cells(row), cost]
            head = cost = ""


def section(case, results, picture):
    """The part of the page about a case: title, first sentences of the README, picture and table."""
    title, *blocks = pathlib.Path(f"input/{case}/README.md").read_text(encoding="utf-8").split("\n\n")
    text = next(block for block in blocks if not block.startswith(("!", "    ", "|", "-")))
    heads = ["resolution", *impinge_compare.HEADS, "CPU s"]
    table = ["| " + " | ".join(line) + " |" for line in (heads, ["-"] * len(heads), *lines_of(results))]
    return "\n".join([f"## {title.removeprefix('# ')}", "", text.strip(), "", f"![{title.removeprefix('# ')}]({picture})", "",
                      *table, ""])


def main():
    root, page, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
    runs, parts, table = {}, {}, []
    for name in names:
        case, _, _ = name.partition("/")
        runs.setdefault(case, []).append(root / name)
    if page.exists():
        _, *old = re.split(r"^(?=## )", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
        parts = {part.splitlines()[0]: part.rstrip() + "\n" for part in old}
    for case, directories in runs.items():
        figure = pathlib.Path("input", case, "figure.png") if page.parts[0] == "docs" else root / case / "figure.png"
        results = compared(case, directories, figure)
        part = section(case, results, os.path.relpath(figure, page.parent))
        parts[part.splitlines()[0]] = part
        table += [[case if k == 0 else "", *line] for k, line in enumerate(lines_of(results))]
    page.write_text("\n".join([INTRODUCTION, *parts.values()]), encoding="utf-8")
    impinge_compare.print_table(["case", "resolution", *impinge_compare.HEADS, "CPU s"], table)
    print(f"page       {page}")


if __name__ == "__main__":
    main()
