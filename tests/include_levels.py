"""Checks the folders of src/ and include/impinge/.

Usage: include_levels.py ROOT. Prints the mistakes; exit 1 if there are any.

A file includes only files of its own folder and of folders below it. Headers do not include each other in a circle. Every
file stands in a folder of FOLDERS. src/ and include/impinge/ have the same folders.
"""

import pathlib
import re
import sys

# From bottom to top; method/pressure belongs to method.
FOLDERS = (
    "core config geometry particles parallel boundaries method scenes observe io cases validation programs"
).split()

INCLUDE = re.compile(r'^\s*#\s*include\s*"(.+)"', re.MULTILINE)


def circles(headers):
    """The first circle found from each header that is in one, as a list of names; headers: includes by name."""
    done, found = set(), []

    def visit(name, path):
        if name in path:
            found.append(path[path.index(name) :] + [name])
        elif name not in done:
            for other in headers.get(name, []):
                visit(other, path + [name])
            done.add(name)

    for name in sorted(headers):
        visit(name, [])
    return found


def find_mistakes(root):
    level = {folder: k for k, folder in enumerate(FOLDERS)}
    roots = {"src": root / "src", "include/impinge": root / "include" / "impinge"}
    folders = {where: set() for where in roots}
    headers, mistakes = {}, []
    for where, directory in roots.items():
        for path in sorted(directory.rglob("*.[ch]pp")):
            name = path.relative_to(directory).as_posix()
            folder = name.split("/")[0]
            if folder not in level or "/" not in name:
                mistakes.append(f"{where}/{name} stands in no folder of FOLDERS")
                continue
            folders[where].add(path.parent.relative_to(directory).as_posix())
            included = INCLUDE.findall(path.read_text())
            for other in included:
                if not other.startswith("impinge/"):
                    mistakes.append(f'{where}/{name} includes "{other}", which does not begin with impinge/')
                    continue
                other = other.removeprefix("impinge/")
                other_folder = other.split("/")[0]
                if level.get(other_folder, len(FOLDERS)) <= level[folder]:
                    continue
                mistakes.append(f"{where}/{name} includes impinge/{other}: {other_folder} is not below {folder}")
            if where != "src":
                headers[name] = [other.removeprefix("impinge/") for other in included]
    mistakes += [f"headers include each other in a circle: {' -> '.join(circle)}" for circle in circles(headers)]
    half = folders["src"] ^ folders["include/impinge"]
    mistakes += [f"{folder} stands in only one of src/ and include/impinge/" for folder in sorted(half)]
    return mistakes


if __name__ == "__main__":
    found = find_mistakes(pathlib.Path(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)
