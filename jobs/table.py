#!/usr/bin/python3
"""Prints the validation metrics of all runs below a directory as one table. Usage: table.py DIR"""

import json
import pathlib
import sys


def cell(value):
    return "-" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def main():
    reports = sorted(pathlib.Path(sys.argv[1]).glob("*/validation/validation.json"))
    if not reports:
        sys.exit(f"{sys.argv[0]}: no validation.json below {sys.argv[1]}")
    rows = []
    for path in reports:
        report = json.loads(path.read_text())
        rows.append({"case": path.parent.parent.name, "status": report["status"], **report["metrics"]})
    columns = [column for column in rows[0] if any(row.get(column) is not None for row in rows)]
    table = [columns] + [[cell(row.get(column)) for column in columns] for row in rows]
    widths = [max(len(line[k]) for line in table) for k in range(len(columns))]
    for line in table:
        print("  ".join(text.ljust(width) for text, width in zip(line, widths)).rstrip())


if __name__ == "__main__":
    main()
