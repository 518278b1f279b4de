"""README's commands run as they stand, from top to bottom, in a fresh copy of the repository; so do the tour and the links of the docs.

Blocks marked `sh` and `python` run; those marked `console` need the network or administration and do not. `cargo` is a stand-in, so that
the build of the other tests runs and nothing is built again.
"""

import os
import re
import shutil
import subprocess
import sys

import pytest
from support import ROOT

CARGO = """#!/bin/sh
case "$*" in
    "run --release -p fric-cli -- "*) shift 5; exec fric-cli "$@" ;;
    "install --path crates/fric-cli") test -f crates/fric-cli/Cargo.toml ;;
    *) echo "not a command that the test knows: cargo $*" >&2; exit 1 ;;
esac
"""
PAGES = ["README.md", "ARCHITECTURE.md", "ASSURANCE.md", "CONTRIBUTING.md", *sorted(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md"))]


def blocks(page):
    """The language and the text of each block."""
    return re.findall(r"^```(\S*).*?\n(.*?)^```$", (ROOT / page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """What a clone has, with what is not committed yet."""
    folder = tmp_path_factory.mktemp("clone")
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z", "README.md", "examples", "docs", "crates/fric-cli"]
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
    return {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}


def run(command, clone, environment):
    done = subprocess.run(command, cwd=clone, env=environment, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def test_readme_s_commands_run_from_top_to_bottom(clone, environment):
    commands = 0
    for language, text in blocks("README.md"):
        if language == "sh":
            for line in text.splitlines():
                run(["sh", "-euc", line], clone, environment)
                commands += 1
        elif language == "python":
            run([sys.executable, "-c", text], clone, environment)
            commands += 1
    assert commands > 10
    assert "cargo run --release -p fric-cli -- replay examples/mini-ipanema.mcap" in (ROOT / "README.md").read_text(encoding="utf-8")


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
        assert not anchor or anchor in anchors(path), target
