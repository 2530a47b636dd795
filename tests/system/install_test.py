#!/usr/bin/python3
"""What `cmake --install` gives. Usage: install_test.py BUILD_DIRECTORY [unittest options]"""

import gzip
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # else no program could leave any


def output_of(*words, cwd=None):
    return subprocess.run([*map(str, words)], cwd=cwd, capture_output=True, text=True, check=True, timeout=300).stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        directory = pathlib.Path(temporary.name)
        output_of("cmake", "--install", BUILD, "--prefix", directory / "first")
        cls.prefix = (directory / "first").rename(directory / "moved prefix")
        cls.programs = sorted(cls.prefix.glob("bin/*"))
        cls.folder = directory / "empty"
        cls.folder.mkdir()

    def program(self, name):
        return self.prefix / "bin" / name

    def page(self, place):
        return gzip.decompress((self.prefix / "share/man" / f"{place}.gz").read_bytes()).decode().replace("\\-", "-")

    def completions(self, *words):
        script = """source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
            _${1//-/_} 2>/dev/null; printf '%s\\n' "${COMPREPLY[@]}" """
        file = self.prefix / "share/bash-completion/completions" / words[0]
        return output_of("bash", "-c", script, "bash", file, *words, cwd=self.folder).split()

    def test_runs_from_a_moved_prefix(self):
        text = output_of(self.program("impinge"), "--new", "jet")
        schema = re.match("#:schema (.+)\n", text)[1]
        self.assertEqual(pathlib.Path(schema), self.prefix / "share/impinge/impinge.schema.json")
        self.assertEqual(pathlib.Path(schema).read_text(), output_of(self.program("impinge"), "--schema"))
        (self.folder / "my.toml").write_text(text)
        coarse = ("--set", "particles.spacing=0.04", "--set", "time.dt=6e-3", "--set", "time.end=0.1")
        output_of("mpirun", "--oversubscribe", "-n", "2", self.program("impinge"), "my.toml", *coarse, cwd=self.folder)
        output_of(self.program("impinge-validate"), "output/my", cwd=self.folder)
        self.assertTrue((self.folder / "output/my/my_figures/pressure.png").exists())
        output_of(self.program("impinge-report"), "output/my", cwd=self.folder)
        self.assertTrue((self.folder / "output/my/my_report.html").exists())
        self.assertEqual(list(self.prefix.rglob("__pycache__")), [])

    def test_links_of_the_documents_lead_somewhere(self):
        pages = [*self.prefix.rglob("*.md")]
        self.assertGreater(len(pages), 20)
        for page in pages:
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text()):
                with self.subTest(page=page.name, link=link):
                    self.assertTrue((page.parent / link).exists())

    def test_each_program_has_a_page_and_completions_with_its_options(self):
        self.assertGreaterEqual(len(self.programs), 4)
        for program in self.programs:
            page = self.page(f"man1/{program.name}.1")
            help_text = output_of(program, "--help")
            options = re.findall(r"^  .*?(--[a-z][a-z-]+)", help_text, re.MULTILINE)
            self.assertIn("--help", options)
            for option in options:
                self.assertIn(f"\\fB{option}\\fR", page)
            self.assertLessEqual(set(options), set(self.completions(program.name, "-")))
            zsh = (self.prefix / f"share/zsh/site-functions/_{program.name}").read_text()
            for option in options:
                self.assertIn(f"{option}[", zsh)

    def test_the_page_of_case_files_has_every_key(self):
        page = self.page("man5/impinge-case.5")
        keys = re.findall(r"^  ([a-z_]+(?:\.[a-z_]+)*) +an? ", output_of(self.program("impinge"), "--describe"), re.MULTILINE)
        self.assertGreater(len(keys), 100)
        for key in keys:
            self.assertRegex(page, rf"\n\.B {key.rpartition('.')[2]}\n")

    def test_bash_completes(self):
        (self.folder / "case.toml").touch()
        (self.folder / "other.txt").touch()
        self.assertEqual(self.completions("impinge", "--pl"), ["--plan"])
        self.assertEqual(self.completions("impinge", "--new", "dam"), ["dam-break", "dam-break-box"])
        self.assertEqual(self.completions("impinge", "c"), ["case.toml"])
        self.assertEqual(self.completions("impinge", "o"), ["output"] if (self.folder / "output").exists() else [])
        self.assertEqual(self.completions("impinge", "--set", "kernel.ty"), ["kernel.type="])
        self.assertEqual(self.completions("impinge", "--set", "kernel.type", "="), ["non_singular", "singular"])
        self.assertEqual(self.completions("impinge", "--set", "kernel.type", "=", "s"), ["singular"])
        self.assertEqual(self.completions("impinge", "--set", "pressure.packing", "=", "t"), ["true"])
        self.assertEqual(self.completions("impinge", "--set", "time.dt", "="), [])
        self.assertEqual(self.completions("impinge-validate", "--fr"), ["--from"])


if __name__ == "__main__":
    unittest.main()
