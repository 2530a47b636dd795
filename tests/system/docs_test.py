#!/usr/bin/python3
"""What the documents show: links, paths, keys, cases and commands. Usage: docs_test.py BIN_DIRECTORY [unittest options]

Calls of the programs are run, for some steps. Of other commands it is checked that scripts and presets exist. Words in
capitals, as in `impinge-validate DIR`, stand for something: such calls are left out.
"""

import functools
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest
import urllib.parse

import jsonschema
import markdown_it

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/**/*.md")),
             ROOT / "tests/README.md", *sorted(ROOT.glob("input/**/*.md"))]
HISTORY = ("docs/notebook/",)  # may name what is no more

PLACE = re.compile(r"(docs|include|input|jobs|src|tests)/[\w./-]+")
KEY = re.compile(r"([a-z_]+(?:\.[a-z_]+)+)( = .*)?")
FILE_ENDINGS = ("cpp", "csv", "hpp", "md", "png", "py", "sh", "toml", "vtkhdf", "xmf")
CALL = re.compile(r"(?:mpirun .*?)?(?:build/release/bin/)?impinge(-[a-z]+)?(?= )")
SCRIPT = re.compile(r"(?:[A-Z_]+=\S+ )*((?:jobs|tests)/\S+\.(?:sh|py))\b")
PRESET = re.compile(r"--preset (\w+)")
PLACEHOLDER = re.compile(r"(?<![\w.=/])[A-Z][A-Z/.a-z]*\b|\.\.\.|<|\[")
FEW_STEPS = "--set time.end=4e-3 --set output.average_start=0"


@functools.cache
def tokens(document):
    return markdown_it.MarkdownIt().enable("table").parse(document.read_text())


def blocks(document):
    """The texts of code blocks."""
    return [token.content for token in tokens(document) if token.type in ("fence", "code_block")]


def inline(document):
    return [part for token in tokens(document) if token.type == "inline" for part in token.children]


def anchors(document):
    headings = [text.content for head, text in zip(tokens(document), tokens(document)[1:]) if head.type == "heading_open"]
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def case_in(block):
    """The TOML of a block with keys of a case; None for other blocks."""
    try:
        table = tomllib.loads(block)
    except tomllib.TOMLDecodeError:
        return None
    return table if set(table) & set(schema()["properties"]) else None


def cases(document):
    """The case files that a document shows: name and text. The text before a block may name it: "as `NAME.toml`"."""
    name = None
    for token in tokens(document):
        if token.type == "inline":
            name = re.search(r"as `(\S+\.toml)`", token.content)
        elif token.type in ("fence", "code_block") and "geometry" in (case_in(token.content) or {}):
            yield name[1] if name else "shown.toml", token.content


def commands(document):
    for block in blocks(document):
        for line in [] if case_in(block) else block.splitlines():
            yield re.sub(r"\s+# .*", "", line).strip()


@functools.cache
def schema():
    return json.loads(subprocess.run([BIN / "impinge", "--schema"], capture_output=True, check=True).stdout)


def has_key(name):
    own = schema()
    for part in name.split("."):
        own = own.get("items", own).get("properties", {}).get(part)
        if own is None:
            return False
    return True


class Documents(unittest.TestCase):
    def test_links_lead_somewhere(self):
        count = 0
        for document in DOCUMENTS:
            for part in inline(document):
                link = part.attrGet("href") or part.attrGet("src")
                if link is None or re.match(r"\w+:", link):
                    continue
                path, _, anchor = urllib.parse.unquote(link).partition("#")
                target = document.parent / path if path else document
                with self.subTest(document=document.relative_to(ROOT), link=link):
                    self.assertTrue(target.exists())
                    if anchor:
                        self.assertIn(anchor, anchors(target))
                count += 1
        self.assertGreater(count, 20)

    def test_the_version_is_everywhere_the_same(self):
        version = subprocess.run([BIN / "impinge", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
        self.assertIn(f"\n## {version}\n", (ROOT / "CHANGELOG.md").read_text())
        self.assertIn(f"\nversion: {version}\n", (ROOT / "jobs/packaging/CITATION.cff").read_text())

    def test_the_readme_is_short(self):
        text = (ROOT / "README.md").read_text()
        self.assertLessEqual(len(text.split()), 1000)
        self.assertLessEqual(len(text.splitlines()), 95)

    def test_files_and_keys_that_are_named_exist(self):
        for document in DOCUMENTS:
            name = document.relative_to(ROOT).as_posix()
            if name.startswith(HISTORY):
                continue
            for text in [part.content for part in inline(document) if part.type == "code_inline"]:
                with self.subTest(document=name, text=text):
                    if PLACE.fullmatch(text):
                        self.assertTrue((ROOT / text).exists())
                    found = KEY.fullmatch(text)
                    if found and found[1].split(".")[0] in schema()["properties"] and not found[1].endswith(FILE_ENDINGS):
                        self.assertTrue(has_key(found[1]))

    def test_scripts_and_presets_exist(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text())
        names = {preset["name"] for kind in presets if kind.endswith("Presets") for preset in presets[kind]}
        for document in DOCUMENTS:
            for line in commands(document):
                with self.subTest(document=document.relative_to(ROOT), line=line):
                    for script in SCRIPT.findall(line):
                        self.assertTrue((ROOT / script).exists())
                    self.assertLessEqual(set(PRESET.findall(line)), names)

    def test_programs_take_what_is_shown(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "input").symlink_to(ROOT / "input")
            (folder / "build").mkdir()
            (folder / "build/release").symlink_to(BIN.parent)
            environment = os.environ | {"PATH": f"{BIN}:{os.environ['PATH']}", "OMPI_MCA_rmaps_base_oversubscribe": "1"}

            def run(line):
                done = subprocess.run(["bash", "-c", line], cwd=folder, env=environment, capture_output=True, text=True,
                                      timeout=120, check=False)
                self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout[-500:]}\n{done.stderr[-2000:]}")

            # What jobs/quickstart.sh leaves.
            run(f"impinge input/jet60-quick.toml --set output.directory=output/jet60-quick {FEW_STEPS}")
            run("impinge-validate output/jet60-quick --no-figures")
            count = 0
            for document in DOCUMENTS:
                shown = document.relative_to(ROOT).as_posix()
                if shown.startswith(HISTORY):
                    continue
                for number, (name, text) in enumerate(cases(document)):
                    (folder / name).write_text(text)
                    with self.subTest(document=shown, case=text):
                        run(f"impinge {name} --set output.directory=shown-{number} {FEW_STEPS}")
                    count += 1
                for line in commands(document):
                    found = CALL.match(line)
                    if not found or PLACEHOLDER.search(line):
                        continue
                    runs = not found[1] and ".toml" in line and not re.search(r"--(check|plan|new|schema|describe)", line)
                    few = re.sub(r"(--restart .*time\.end=)\S+", r"\g<1>8e-3", line.replace("/tmp/", f"{folder}/"))
                    with self.subTest(document=shown, line=line):
                        run(few + f" {FEW_STEPS}" * runs)
                    count += 1
                for block in blocks(document):
                    if block.startswith("import "):
                        (folder / "shown.py").write_text(block)
                        with self.subTest(document=shown, block=block):
                            run("PYTHONPATH=build/release/share/impinge /usr/bin/python3 shown.py")
                    case = case_in(block)
                    if case is None or "geometry" in case:
                        continue
                    with self.subTest(document=shown, block=block):
                        errors = jsonschema.Draft7Validator(schema()).iter_errors(case | {"include": "rest.toml"})
                        self.assertEqual([error.message for error in errors], [])
                    count += 1
            self.assertGreater(count, 10)


if __name__ == "__main__":
    unittest.main()
