#!/usr/bin/python3
"""Prints the counts of all series below a directory as Markdown tables. Usage: scaling.py DIR

Messages, bytes, reductions and other collective operations: sent per rank and step, mean over the ranks (largest of a
rank in parentheses), of the runs' own MPI calls; hypre's messages are those that PETSc's -log_view does not count. Per
step: the second run's count less the first's, over the steps that it has more. Iterations: mean (largest) over these
steps; of the first, cold step. Halo: copies over owned particles, mean (worst rank). Neighbours: mean (most).
"""

import csv
import pathlib
import re
import sys

PARTS = ("first", "second")


def read_csv(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def read_row(directory, ranks):
    plan = (directory / "plan.txt").read_text()

    def planned(pattern):
        return [float(number) for number in re.search(pattern, plan).groups()]

    iterations = []
    for part in PARTS:
        (history,) = (directory / f"run-{part}").glob("*_history.csv")
        iterations.append([int(row["iterations"]) for row in read_csv(history)])
    counted = iterations[1][len(iterations[0]) :]
    if len(counted) < 5:
        sys.exit(f"{sys.argv[0]}: the second run in {directory} has only {len(counted)} steps more than the first")
    first, last = (read_csv(directory / f"counts-{part}.csv") for part in PARTS)

    def per_step(name, scale=1.0):
        of_rank = [(float(b[name]) - float(a[name])) / len(counted) / scale for a, b in zip(first, last)]
        return sum(of_rank) / ranks, max(of_rank)

    def petsc_messages(part):
        text = (directory / f"petsc-{part}.txt").read_text()
        return float(re.search(r"MPI Msg Count: .* (\S+)\n", text).group(1))

    messages = per_step("messages")
    hypre = messages[0] - (petsc_messages(PARTS[1]) - petsc_messages(PARTS[0])) / len(counted) / ranks

    def both(values, digits):
        return "{:.{d}f} ({:.{d}f})".format(*values, d=digits)

    particles = planned(r"mean ([\d.]+), most \d+, (\d+) in all")
    return {
        "ranks": str(ranks),
        "particles": f"{particles[1]:.0f}",
        "a rank": f"{particles[0]:.0f}",
        "imbalance": f"{planned(r'imbalance +([0-9.]+)')[0]:.3f}",
        "halo": both(planned(r"over owned: mean ([\d.]+), worst ([\d.]+)"), 3),
        "neighbours": both(planned(r"neighbours +mean ([\d.]+), most (\d+)"), 1),
        "iterations": both((sum(counted) / len(counted), max(counted)), 1),
        "cold": str(iterations[1][0]),
        "messages": both(messages, 0),
        "of these hypre": f"{hypre:.0f}",
        "kB": both(per_step("bytes", 1e3), 0),
        "reductions": f"{per_step('reductions')[1]:.1f}",
        "other collectives": f"{per_step('other_collectives')[1]:.1f}",
    }


def main():
    series = {}
    for directory in pathlib.Path(sys.argv[1]).glob("*-*/"):
        name, ranks = directory.name.rsplit("-", 1)
        if (directory / f"counts-{PARTS[1]}.csv").exists():
            series.setdefault(name, []).append(int(ranks))
    if not series:
        sys.exit(f"{sys.argv[0]}: no counts below {sys.argv[1]}")
    for name, all_ranks in sorted(series.items()):
        rows = [read_row(pathlib.Path(sys.argv[1]) / f"{name}-{ranks}", ranks) for ranks in sorted(all_ranks)]
        print(f"\n{name}\n")
        print("| " + " | ".join(rows[0]) + " |")
        print("|" + "---|" * len(rows[0]))
        for row in rows:
            print("| " + " | ".join(row.values()) + " |")


if __name__ == "__main__":
    main()
