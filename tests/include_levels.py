"""Checks that every file includes only files of its own level or a lower one.

Usage: include_levels.py ROOT. A file that stands in no level, and a name that stands for no file, are mistakes too.
"""

import pathlib
import re
import sys

LEVELS = [
    ["types", "kernel", "lattice", "output_error", "stop_signals"],
    ["petsc"],
    ["parallel"],
    ["analytic_jet", "particles"],
    ["checkpoint", "config"],
    ["cell_grid", "partition", "pressure_matrix"],
    ["domain", "geometry", "jet_geometry", "neighbours"],
    ["free_surface", "operators", "pressure", "snapshot"],
    ["two_level"],
    ["simulation"],
    ["output", "plan", "progress"],
    ["command_line", "run"],
    ["main"],
    ["post/jet_comparison"],
    ["post/validation"],
    ["post/validate_main"],
]


def find_mistakes(root):
    level_of = {name: level for level, names in enumerate(LEVELS) for name in names}
    include = re.compile(r'^\s*#\s*include\s*"impinge/(.+)\.hpp"', re.MULTILINE)
    seen = set()
    mistakes = []
    for folder, ending in ((root / "include" / "impinge", ".hpp"), (root / "src", ".cpp")):
        for path in sorted(folder.rglob("*" + ending)):
            name = path.relative_to(folder).with_suffix("").as_posix()
            seen.add(name)
            if name not in level_of:
                mistakes.append(f"{path.relative_to(root)} stands in no level of {__file__}")
                continue
            for other in include.findall(path.read_text()):
                if other not in level_of or level_of[other] > level_of[name]:
                    mistakes.append(
                        f"{path.relative_to(root)} (level {level_of[name]}) includes impinge/{other}.hpp "
                        f"(level {level_of.get(other, 'unknown')})"
                    )
    return mistakes + [f"{name} stands in a level, but there is no such file" for name in sorted(level_of.keys() - seen)]


if __name__ == "__main__":
    found = find_mistakes(pathlib.Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
