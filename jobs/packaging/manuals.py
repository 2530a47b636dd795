#!/usr/bin/env python3
"""Writes the manual pages, the shell completions and the schema of case files.

Usage: manuals.py DIRECTORY VERSION PROGRAM...

All is made of what the programs print: --help, and the --schema of the first. DIRECTORY gets, as below a prefix:
share/man, share/bash-completion/completions, share/zsh/site-functions, share/impinge/impinge.schema.json.
A program that cannot print its --help, as a Python program whose packages are missing, is told and left out.
"""

import gzip
import json
import os
import pathlib
import re
import subprocess
import sys

HEADINGS = ("positionals:", "options:", "positional arguments:")


class Option:
    """A row of a program's --help: ("-h", "--help"), the name of its value or "", and what it does."""

    def __init__(self, left):
        left = re.sub(r" (Excludes|Needs|REQUIRED)\b.*", "", left)
        words = re.split(r",\s*|\s+", left)
        self.names = [word for word in words if word.startswith("-")]
        values = [word for word in words if not word.startswith("-")]
        self.value = values[-1] if values else ""
        self.doc = ""

    @property
    def choices(self):
        """The words that the value can be, if the help lists them: a|b, {a,b}."""
        parts = re.split(r"[|,]", self.value.strip("{}"))
        return parts if len(parts) > 1 else []

    @property
    def kind(self):
        """What its value is, for the completions: words, a case, a directory, a file, a setting, or none of these."""
        if self.choices:
            return "words"
        if self.value.endswith(".toml"):
            return "case"
        return {"DIR": "directory", "directory": "directory", "FILE": "file", "KEY=VALUE": "setting"}.get(self.value)


class Help:
    """What a program's --help says."""

    def __init__(self, text):
        self.before, self.usage, self.options, self.after = [], [], [], []
        state = self.before
        for line in text.splitlines():
            if line.lower().startswith("usage: "):
                state = self.usage
                line = line[len("usage: ") :]
            elif line.lower() in HEADINGS:
                state = self.options
                continue
            elif state is self.usage and not line:
                state = self.before
            elif state is self.options and line and not line.startswith(" "):
                state = self.after
            if state is not self.options:
                state.append(line)
            elif line.startswith("   "):
                state[-1].doc = (state[-1].doc + " " + line.strip()).strip()
            elif line:
                left, _, doc = line.strip().partition("  ")
                state.append(Option(left))
                state[-1].doc = doc.strip()

    @property
    def summary(self):
        text = re.split(r"[.:](?:\s|$)", " ".join(self.before).strip())[0]
        return text.removeprefix("Impinge ")


def keys_of(schema, name=""):
    """The keys of a schema by full name: "time.end", "[[wall]].points"."""
    for part, own in schema.get("properties", {}).items():
        full = f"{name}.{part}" if name else part
        if "properties" in own:
            yield from keys_of(own, full)
        elif "properties" in own.get("items", {}):
            yield f"[[{full}]]", own
            yield from keys_of(own["items"], f"[[{full}]]")
        else:
            yield full, own


# ----------------------------------------------------------------------------------------------------------------------
# Manual pages.


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return re.sub(r"^\.", "\\&.", text)


def roff_text(lines):
    """Paragraphs; what is indented stays as it is."""
    done, literal = [], False
    for line in lines:
        if line.startswith(" ") != literal:
            literal = not literal
            done.append(".PP\n.EX" if literal else ".EE\n.PP")
        done.append(roff(line) if line else ".PP")
    return re.sub(r"(\.PP\n)+", ".PP\n", "\n".join(done + [".EE"] * literal).strip()) + "\n"


def page_of_program(name, version, found, names):
    page = f'.TH {name.upper()} 1 "" "Impinge {version}" "User Commands"\n'
    page += f".SH NAME\n{name} \\- {roff(found.summary[0].lower() + found.summary[1:])}\n"
    page += ".SH SYNOPSIS\n.B " + roff(" ".join(" ".join(found.usage).split())) + "\n"
    page += ".SH DESCRIPTION\n" + roff_text(found.before)
    page += ".SH OPTIONS\n"
    for option in found.options:
        title = " ".join(f"\\fB{roff(part)}\\fR" for part in option.names)
        title += f" \\fI{roff('WORD' if option.choices else option.value)}\\fR" if option.value else ""
        doc = ": ".join([option.doc, *[", ".join(option.choices)] * bool(option.choices)])
        page += f".TP\n{title.strip()}\n{roff(doc)}\n"
    notes = "\n".join(found.after).split("Exit codes: ")
    if notes[0].strip():
        page += ".SH NOTES\n" + roff_text(notes[0].splitlines())
    if len(notes) > 1:
        page += ".SH EXIT STATUS\n" + roff_text(notes[1].splitlines())
    others = [f".BR {roff(other)} (1)" for other in names if other != name] + [".BR impinge\\-case (5)"]
    return page + ".SH SEE ALSO\n" + ",\n".join(others) + "\n"


def page_of_cases(version, keys):
    page = f'.TH IMPINGE\\-CASE 5 "" "Impinge {version}" "File Formats"\n'
    page += ".SH NAME\nimpinge\\-case \\- case files of impinge\n"
    page += ".SH DESCRIPTION\nA case file is TOML. It has these keys.\n"
    table = None
    for name, key in keys:
        own, _, local = ("", "", name) if "." not in name else name.rpartition(".")
        if name.startswith("[["):
            own, _, local = name.partition("]]")
            own, local = own + "]]", local.removeprefix(".")
        elif own:
            own = f"[{own}]"
        if own != table:
            page += f'.SS "{roff(own) or "At the top of the file"}"\n'
            table = own
        doc = "\n.br\n".join(roff(part) for part in key["description"].split("\n\n"))
        page += f".TP\n.B {roff(local)}\n{doc}\n" if local else doc + "\n"
    return page + ".SH SEE ALSO\n.BR impinge (1)\n"


# ----------------------------------------------------------------------------------------------------------------------
# Completions.


def function_of(program):
    return "_" + program.replace("-", "_")


def words_of(key):
    """The words that the value of a key can be, by its schema; none where it is no word."""
    return key.get("enum") or (["false", "true"] if key.get("type") == "boolean" else [])


def bash_values(option, keys):
    """What completes the value of an option."""
    return {
        "words": f'choices="{" ".join(option.choices)}"',
        "case": 'files=(-o plusdirs -f -X "!*.toml")',
        "directory": "files=(-d)",
        "file": "files=(-f)",
        "setting": f'compopt -o nospace; choices="{" ".join(name + "=" for name in keys)}"',
    }.get(option.kind, "return")


def bash_completion(program, found, keys):
    options = [option for option in found.options if option.names]
    text = f"""# bash completion of {program}
{function_of(program)}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} choices= key=
  local -a files=()
  COMPREPLY=()
"""
    if any(option.kind == "setting" for option in options):
        text += """  if [ "$word" = = ]; then
    key=$before word=
  elif [ "$before" = = ]; then
    key=${COMP_WORDS[COMP_CWORD-2]}
  fi
  case $key in
    "") ;;
"""
        words = ((name, words_of(key)) for name, key in keys.items())
        text += "".join(f'    {name}) choices="{" ".join(values)}" ;;\n' for name, values in words if values)
        text += "    *) return ;;\n  esac\n"
    text += '  [ -n "$key" ] || case $before in\n'
    for option in options:
        if option.value:
            text += f"    {'|'.join(option.names)}) {bash_values(option, keys)} ;;\n"
    text += f'    *) case $word in\n      -*) choices="{" ".join(name for option in options for name in option.names)}" ;;\n'
    places = [option for option in found.options if not option.names]
    text += f"      *) {bash_values(places[0], keys) if places else 'return'} ;;\n      esac ;;\n  esac\n"
    return text + f"""  if [ ${{#files[@]}} -gt 0 ]; then
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen "${{files[@]}}" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$word")
  fi
}}
complete -F {function_of(program)} {program}
"""


def zsh_action(program, option):
    return {
        "words": f"({' '.join(option.choices)})",
        "case": '_files -g "*.toml"',
        "directory": "_files -/",
        "file": "_files",
        "setting": f"{function_of(program)}_keys",
    }.get(option.kind, " ")


def zsh_completion(program, found, keys):
    def quoted(text):
        return text.replace("'", "'\\''")

    rows = []
    for option in found.options:
        name = option.value.replace("=", " ").split("|")[0] if not option.choices else "word"
        value = f":{name}:{zsh_action(program, option)}" if option.value else ""
        doc = re.sub(r"([\[\]:])", r"\\\1", option.doc)
        if not option.names:
            rows.append(quoted(f"*{value}"))
        for one in option.names:
            others = "*" if "may be repeated" in option.doc else f"({' '.join(option.names)})"
            rows.append(quoted(f"{others}{one}[{doc}]{value}"))
    text = f"#compdef {program}\n"
    if any(option.kind == "setting" for option in found.options):
        text += f"{function_of(program)}_keys() {{\n  if compset -P '*='; then\n    case ${{IPREFIX%=}} in\n"
        for name, key in keys.items():
            values = words_of(key)
            text += f"      {name}) compadd {' '.join(values)} ;;\n" if values else ""
        text += "    esac\n  else\n    compadd -q -S = " + " ".join(keys) + "\n  fi\n}\n"
    return text + "_arguments -S \\\n" + " \\\n".join(f"  '{row}'" for row in rows) + "\n"


# ----------------------------------------------------------------------------------------------------------------------


def main():
    root, version, programs = pathlib.Path(sys.argv[1]) / "share", sys.argv[2], sys.argv[3:]

    def write(path, content):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        data = content.encode()
        (root / path).write_bytes(gzip.compress(data, mtime=0) if path.endswith(".gz") else data)

    def output_of(*words):
        environment = os.environ | {"COLUMNS": "120"}
        return subprocess.run(words, capture_output=True, text=True, check=False, env=environment)

    schema = output_of(programs[0], "--schema")
    if schema.returncode != 0:
        sys.exit(f"manuals.py: {programs[0]} --schema: {schema.stderr}")
    write("impinge/impinge.schema.json", schema.stdout)
    every = dict(keys_of(json.loads(schema.stdout)))
    write("man/man5/impinge-case.5.gz", page_of_cases(version, every.items()))
    keys = {name: key for name, key in every.items() if not name.startswith("[[") and name != "include"}

    names = [pathlib.Path(program).name for program in programs]
    for name, program in zip(names, programs):
        done = output_of(program, "--help")
        if done.returncode != 0:
            print(f"manuals.py: no pages of {name}: {done.stderr.strip()}", file=sys.stderr)
            continue
        found = Help(done.stdout)
        write(f"man/man1/{name}.1.gz", page_of_program(name, version, found, names))
        write(f"bash-completion/completions/{name}", bash_completion(name, found, keys))
        write(f"zsh/site-functions/_{name}", zsh_completion(name, found, keys))


if __name__ == "__main__":
    main()
