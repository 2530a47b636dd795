#!/usr/bin/python3
"""The JSON schema of case files. Usage: schema_test.py BIN_DIRECTORY UNIT_TESTS [unittest options]

The unit tests note each case that they read and the mistakes that the program finds in it. The schema must agree: it
refuses a case that has a mistake of a kind that a schema can find, and no other.
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

import jsonschema

sys.setrecursionlimit(50_000)  # for tables nested by the thousand

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN, UNIT_TESTS = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
NOTING = "Case.*:Scene*:FluidRegion.*:ObserverKeys.*"

# What a schema can find, as the program tells it.
CAN_FIND = re.compile(
    r": unknown key"
    r"|: not (a|an) [a-z ]+; allowed"
    r"|: out of range; allowed"
    r"|: unknown word; allowed"
    r"|: empty; allowed"
    r"|: has a control character; allowed"
    r"|: required key is missing"
    r"|: a key of \w+ \""
    r"|has \d+ numbers, but the dimension is"
    r"|tables; allowed: at most"
)
# JSON has no such numbers, and takes 2.0 for an integer: cases that are left out.
NOT_JSON = re.compile(r"= \[?[^a-z]*(inf|nan)\b|= \d+\.0: not an integer")


@functools.cache
def schema():
    return json.loads(subprocess.run([BIN / "impinge", "--schema"], capture_output=True, check=True).stdout)


@functools.cache
def validator():
    return jsonschema.Draft7Validator(schema())


def errors_in(case):
    return [f"{'.'.join(map(str, error.absolute_path))}: {error.message}" for error in validator().iter_errors(case)]


def over(case, defaults):
    """A case over one that it includes."""
    if not (isinstance(case, dict) and isinstance(defaults, dict)):
        return case
    return defaults | {name: over(value, defaults[name]) if name in defaults else value for name, value in case.items()}


def read(path):
    """A case file with those that it includes."""
    case = tomllib.loads(path.read_text())
    included = case.pop("include", None)
    return over(case, read(path.parent / included)) if included else case


@functools.cache
def noted_cases():
    """Each case that is TOML and has a counterpart in JSON, with its files and mistakes."""
    with tempfile.TemporaryDirectory() as directory:
        path = pathlib.Path(directory, "cases")
        environment = os.environ | {"IMPINGE_NOTED_CASES": str(path)}
        subprocess.run([UNIT_TESTS, f"--gtest_filter={NOTING}"], env=environment, capture_output=True, check=True)
        lines = [json.loads(line) for line in path.read_text().splitlines()]
    cases = []
    for line in lines:
        if not any("not TOML" in text or NOT_JSON.search(text) for text in line["mistakes"]):
            tables = [tomllib.loads(text) for text in line["files"]]
            cases.append((functools.reduce(over, tables), line["files"], line["mistakes"]))
    return cases


class Schema(unittest.TestCase):
    def test_is_a_schema(self):
        jsonschema.Draft7Validator.check_schema(schema())

    def test_shipped_cases_fulfil_it(self):
        paths = [path for path in sorted(ROOT.glob("input/**/*.toml")) if path.parent.name != "common"]
        self.assertGreaterEqual(len(paths), 19)
        for path in paths:
            self.assertEqual(errors_in(tomllib.loads(path.read_text())), [], path)
            self.assertEqual(errors_in(read(path)), [], path)

    def test_agrees_with_the_program(self):
        sound = refused = 0
        differences = []
        for case, files, mistakes in noted_cases():
            found = errors_in(case)
            expected = [text for text in mistakes if CAN_FIND.search(text)]
            if bool(found) != bool(expected):
                differences.append(f"{files}\nprogram: {mistakes}\nschema: {found}"[:1000])
            sound += not mistakes
            refused += bool(expected)
        self.assertEqual(differences, [], "\n\n".join(differences))
        self.assertGreater(sound, 20)
        self.assertGreater(refused, 50)

    def test_names_the_key_of_each_mistake(self):
        for text, part in (
            ("time.dt = -1", "time.dt: "),
            ("time = {dt = 1, dt2 = 1}", "'dt2'"),
            ('[[wall]]\nname = "a"\nshape = "arc"', "'center'"),
            ('[[wall]]\nname = "a"\nshape = "box"\nlow = [0, 0]\nhigh = [1, 1]\nradius = 1', "wall.0.radius"),
        ):
            found = errors_in(tomllib.loads(f'include = "a.toml"\ngeometry = "scene"\n{text}'))
            self.assertTrue(any(part in error for error in found), found)

    def test_has_what_an_editor_shows(self):
        keys = schema()["properties"]
        spacing = keys["particles"]["properties"]["spacing"]
        self.assertEqual(spacing["exclusiveMinimum"], 0)
        self.assertIn("> 0 (m)", spacing["description"])
        self.assertEqual(keys["fluid"]["properties"]["density"]["default"], 1000)
        self.assertEqual(keys["kernel"]["properties"]["type"]["enum"], ["non_singular", "singular"])
        self.assertIn("points", keys["wall"]["items"]["properties"])


if __name__ == "__main__":
    unittest.main()
