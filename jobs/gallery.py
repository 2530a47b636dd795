#!/usr/bin/env python3
"""Makes one page, ROOT/index.html, of the pictures of the runs ROOT/<case>, with a line of text each.

The page holds its pictures. The text is the first sentence of the case's README, or of the comment in its file.
Usage: jobs/gallery.py ROOT CASE..."""

import base64
import html
import io
import pathlib
import re
import sys

from PIL import Image  # Matplotlib brings it

STYLE = """body { font: 16px/1.4 sans-serif; max-width: 1280px; margin: 2em auto; padding: 0 1em; }
div { display: flex; flex-wrap: wrap; gap: 8px; align-items: center; }
img { max-width: 620px; width: 100%; height: auto; }"""
PICTURES = ("pressure", "speed", "history", "probes", "gauges", "sections", "forces")


def described(case):
    """Title and line of text of a case."""
    readme = pathlib.Path(f"input/{case}/README.md")
    if readme.exists():
        blocks = readme.read_text(encoding="utf-8").split("\n\n")
        title = blocks[0].removeprefix("# ").strip()
        text = next(block for block in blocks[1:] if not block.startswith(("!", "    ")))
    else:
        title = case
        lines = pathlib.Path(f"input/{case}.toml").read_text(encoding="utf-8").splitlines()
        count = next(k for k, line in enumerate(lines) if not line.startswith("#"))
        text = " ".join(line.lstrip("# ") for line in lines[:count])
    return title, re.split(r"(?<=[.:]) (?=[A-Z])", " ".join(text.split()), maxsplit=1)[0]


def picture(path, title):
    """An image of the page, with 255 colours, which are a third of the bytes."""
    data = io.BytesIO()
    Image.open(path).convert("RGB").quantize(255).save(data, "png", optimize=True)
    return f'<img alt="{html.escape(title)}" src="data:image/png;base64,{base64.b64encode(data.getvalue()).decode()}">'


def part(root, case):
    title, text = described(case)
    status = (root / case / "status").read_text(encoding="utf-8").strip()
    note = "" if status == "finished" else f" <b>The run {status}.</b>"
    lines = [f"<h2>{html.escape(title)}</h2>", f"<p>{html.escape(text)}{note}</p>", "<div>"]
    for name in PICTURES:
        path = root / case / f"{case}_figures/{name}.png"
        if path.exists():
            lines.append(picture(path, f"{title}: {name}"))
    return "\n".join(lines + ["</div>"])


def main():
    root, cases = pathlib.Path(sys.argv[1]), sys.argv[2:]
    page = ["<!doctype html>", '<html lang="en">', '<meta charset="utf-8">', "<title>Impinge: gallery</title>"]
    page += [f"<style>{STYLE}</style>", "<h1>Impinge: gallery</h1>"]
    page += [part(root, case) for case in cases] + ["</html>"]
    path = root / "index.html"
    path.write_text("\n".join(page) + "\n", encoding="utf-8")
    print(f"page       {path}")


if __name__ == "__main__":
    main()
