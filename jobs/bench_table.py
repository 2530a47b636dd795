#!/usr/bin/python3
"""Prints the results of step_bench as one table, a column for each file. Usage: bench_table.py FILE.json..."""

import json
import pathlib
import sys


def rows_of(result, prefix=""):
    for key, value in result.items():
        if isinstance(value, dict):
            yield from rows_of(value, f"{key}: ")
        else:
            yield prefix + key, f"{value:.4g}" if isinstance(value, float) else str(value)


def main():
    paths = [pathlib.Path(name) for name in sys.argv[1:]]
    columns = [dict(rows_of(json.loads(path.read_text()))) for path in paths]
    table = [[""] + [path.stem.partition("-")[2] for path in paths]]
    table += [[key] + [column[key] for column in columns] for key in columns[0]]
    widths = [max(len(line[k]) for line in table) for k in range(len(table[0]))]
    for line in table:
        print(line[0].ljust(widths[0]), *(text.rjust(width) for text, width in zip(line[1:], widths[1:])), sep="  ")


if __name__ == "__main__":
    main()
