"""The commands and programs of README and of the book run as they stand, page by page, in a fresh copy of the repository.

Blocks marked `sh` run from the top of a page to its end, then all blocks marked `python` as one program; a block marked `text` behind them shows
lines that they have printed. `toml` and `json` are read. `console` is for what needs the network, administration or a minute (the help's
examples have those, and run in tests/cli/help.rs), `python,ignore` for what needs more than
one machine; C, C++ and Rust are compiled by other tests. `cargo` is a stand-in, so that the build of the other tests runs and nothing is built again.
"""

import json
import os
import re
import shutil
import subprocess
import sys

import fric
import pytest
from support import HANG_S, ROOT

CARGO = """#!/bin/sh
case "$*" in
    "run --release -p fric-cli -- "*) shift 5; exec fric-cli "$@" ;;
    "install --locked --path crates/fric-cli") test -f crates/fric-cli/Cargo.toml ;;
    # Sweeps of hours: that there is such a program is all that is looked at.
    "run --release -p fric-"*"lab --example "*) grep -q "name = \\"$6\\"" "crates/$4/Cargo.toml" ;;
    *) echo "not a command that the test knows: cargo $*" >&2; exit 1 ;;
esac
"""
DOCS = sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))
PAGES = ["README.md", "ARCHITECTURE.md", "ASSURANCE.md", "CONTRIBUTING.md", *DOCS]
# Pages whose commands run in one clone, one after the other; each other page has a clone of its own.
TOGETHER = [["docs/tutorial-test.md", "docs/reading.md"]]
RUN = [*TOGETHER, *([page] for page in ["README.md", *DOCS] if not any(page in pages for pages in TOGETHER))]
# Languages of blocks that this test runs or reads, and of those that it leaves to others or to the reader.
KNOWN = {"sh", "python", "text", "toml", "json", "console", "python,ignore", "c", "cpp", "cmake", "rust", "rust,no_run"}
# Times of this computer.
UNSTEADY = re.compile(r"µs|real-time machine|^…$")


def blocks(page):
    """The language and the text of each block."""
    return re.findall(r"^```(\S*).*?\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.fixture
def clone(tmp_path_factory):
    """What a clone has, with what is not committed yet."""
    folder = tmp_path_factory.mktemp("clone")
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z", "README.md", "examples", "crates/fric-cli", "crates/fric-lab/Cargo.toml", "crates/fric-tendon-lab/Cargo.toml"]
    files = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
    for name in filter(None, files):
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """The program of the other tests and the stand-in on the path."""
    programs = tmp_path_factory.mktemp("programs")
    target = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
    (programs / "fric-cli").symlink_to(target / "debug" / "fric-cli")
    (programs / "cargo").write_text(CARGO, encoding="utf-8")
    (programs / "cargo").chmod(0o755)
    return {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}", "COLUMNS": "80", "MPLBACKEND": "Agg"}


def run(command, clone, environment):
    done = subprocess.run(command, cwd=clone, env=environment, capture_output=True, text=True, check=False, timeout=HANG_S)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


@pytest.mark.parametrize("pages", RUN, ids=" ".join)
def test_a_page_s_commands_run_from_top_to_bottom(pages, clone, environment):
    printed = program = ""
    for language, text in [block for page in pages for block in blocks(page)]:
        assert language in KNOWN, f"a block of {language!r}"
        if language == "sh":
            lines = re.sub(r"\\\n", "", text).splitlines()
            printed += "".join(run(["sh", "-euc", line], clone, environment) for line in lines)
        elif language == "python":
            program += text
        elif language == "text" and printed:
            told = {line.strip() for line in printed.splitlines()}
            shown = [line.strip() for line in text.splitlines()]
            assert [line for line in shown if line and line not in told and not UNSTEADY.search(line)] == [], printed
        elif language == "toml" and "format =" in text:
            fric.Robot.from_toml(text)
        elif language == "toml" and text.startswith("[log"):
            winch = (ROOT / "examples" / "winch.toml").read_text(encoding="utf-8")
            fric.Robot.from_toml(winch.replace('name = "cable"', 'name = "cable1"') + text)
        elif language == "json":
            json.loads(text)
    if program:
        run([sys.executable, "-c", program], clone, environment)


def test_readme_begins_with_the_command_of_the_two():
    assert "cargo run --release -p fric-cli -- replay examples/mini-ipanema.mcap" in next(text for language, text in blocks("README.md") if language == "sh")


def test_the_tour_finds_what_it_hides(clone, environment):
    told = run(["examples/tour.sh", "tour"], clone, environment)
    assert "The model lacks stribeck; with it, what is left is noise." in told
    rms_after = [float(row.split()[2]) for row in told.splitlines() if re.match(r" cable +\d\.\d{4} +\d\.\d{4} +[\d.]+ %", row)]
    assert len(rms_after) == 3
    # Given, fitted, extended: the noise of the simulated sensors is 0.01 N and, halved by the sensor pulley, 0.02 N.
    assert rms_after[0] > rms_after[1] > rms_after[2]
    assert rms_after[2] < 1.05 * (0.01**2 + (0.02 / 2) ** 2) ** 0.5
    assert (clone / "tour" / "discovery.html").is_file() and (clone / "tour" / "errors.html").is_file()


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    def anchors(path):
        heads = re.findall(r"^#+ (.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
        return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}

    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        path = (ROOT / page).parent / name if name else ROOT / page
        assert path.exists(), target
        # Sections that are generated are in the book alone; test_book.py checks what leads there.
        is_generated = path.suffix == ".md" and "<!-- generated:" in path.read_text(encoding="utf-8")
        assert not anchor or is_generated or anchor in anchors(path), target
