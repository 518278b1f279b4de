"""What a release needs: metadata of the crates, the scripts of `packaging/`, what they refuse."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest
from support import ROOT

USERS_NEED = ["fric-core", "fric-log", "fric-lab", "fric-tendon", "fric-tendon-lab", "fric-work", "fric-cli"]
RELEASE = ROOT / "packaging" / "release.sh"


@pytest.fixture(scope="module")
def crates():
    listed = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--frozen"]
    metadata = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return {crate["name"]: crate for crate in json.loads(metadata)["packages"]}


@pytest.mark.parametrize("name", USERS_NEED)
def test_a_crate_for_users_can_be_published(crates, name):
    crate = crates[name]
    assert crate["publish"] is None
    for key in ("description", "license", "readme", "keywords", "categories"):
        assert crate[key], key
    # crates.io takes no more than five of each.
    assert len(crate["keywords"]) <= 5 and len(crate["categories"]) <= 5
    for dependency in crate["dependencies"]:
        if dependency["name"] in crates:
            assert dependency["req"] == f"^{crate['version']}", dependency["name"]


def test_what_is_released_is_what_users_need(crates):
    assert re.search(r"^crates=\((.*)\)$", RELEASE.read_text(encoding="utf-8"), re.MULTILINE)[1].split() == USERS_NEED
    assert {name for name, crate in crates.items() if crate["publish"] is None} == set(USERS_NEED)


@pytest.fixture
def tree(tmp_path):
    """A repository with what `make release` looks at before it builds anything."""
    (tmp_path / "packaging").mkdir()
    (tmp_path / "packaging" / "release.sh").write_bytes(RELEASE.read_bytes())
    (tmp_path / "Cargo.toml").write_text('[workspace.package]\nversion = "1.2.3"\n\n[workspace.dependencies]\nversion = "9"\n', encoding="utf-8")
    (tmp_path / "CHANGELOG.md").write_text("# Changelog\n\n## [Unreleased]\n\n## [1.2.3] - 2026-01-31\n", encoding="utf-8")
    # A cargo that ends the script where it would begin to build.
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "cargo").write_text('#!/bin/sh\necho "builds: $*"\nexit 7\n', encoding="utf-8")
    (tmp_path / "bin" / "cargo").chmod(0o755)
    git(tmp_path, "init", "--quiet")
    commit(tmp_path)
    return tmp_path


def git(tree, *arguments):
    identity = ["-c", "user.name=t", "-c", "user.email=t@localhost"]
    subprocess.run(["git", *identity, *arguments], cwd=tree, capture_output=True, check=True)


def commit(tree):
    git(tree, "add", "--all")
    git(tree, "commit", "--quiet", "--message", "change")


def release(tree):
    environment = {**os.environ, "PATH": f"{tree / 'bin'}{os.pathsep}{os.environ['PATH']}"}
    return subprocess.run(["bash", "packaging/release.sh"], cwd=tree, env=environment, capture_output=True, text=True, check=False)


def test_a_release_begins_with_the_packages(tree):
    done = release(tree)
    assert done.returncode == 7
    assert "builds: package --quiet -p fric-core -p fric-log -p fric-lab -p fric-tendon -p fric-tendon-lab -p fric-work -p fric-cli" in done.stdout


def test_a_tree_with_changes_is_not_released(tree):
    (tree / "new.txt").write_text("new", encoding="utf-8")
    done = release(tree)
    assert done.returncode == 1
    assert "no release: there is what is not committed" in done.stderr and "new.txt" in done.stderr


def test_a_version_without_its_changes_is_not_released(tree):
    (tree / "CHANGELOG.md").write_text("# Changelog\n\n## [Unreleased]\n\n## [1.2.30] - 2026-01-31\n", encoding="utf-8")
    commit(tree)
    done = release(tree)
    assert done.returncode == 1
    assert 'CHANGELOG.md has no section for this version; write "## [1.2.3] - ' in done.stderr


def test_a_version_is_released_once(tree):
    git(tree, "tag", "v1.2.3")
    done = release(tree)
    assert done.returncode == 1
    assert "the tag v1.2.3 exists; raise the version in Cargo.toml" in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="paths of Linux")
def test_a_platform_without_its_tools_is_named_as_not_checked(tmp_path):
    for program in ("bash", "dirname", "mktemp", "rm", "uname"):
        (tmp_path / program).symlink_to(shutil.which(program))
    command = ["bash", ROOT / "packaging" / "platforms.sh"]
    done = subprocess.run(command, env={"PATH": str(tmp_path)}, capture_output=True, text=True, check=True)
    aarch64, windows = done.stdout.splitlines()
    assert aarch64.startswith("not checked: the bits of a replay on aarch64; ")
    assert windows == "not checked: the command line for Windows; x86_64-w64-mingw32-gcc is missing"


@pytest.mark.skipif(sys.platform != "linux", reason="paths of Linux")
def test_the_command_line_is_installed_with_manual_pages_and_completions(tmp_path):
    target = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
    environment = {**os.environ, "PREFIX": "/usr", "DESTDIR": str(tmp_path)}
    command = [ROOT / "packaging" / "install-cli.sh", target / "debug" / "fric-cli"]
    subprocess.run(command, env=environment, capture_output=True, check=True)
    assert os.access(tmp_path / "usr/bin/fric-cli", os.X_OK)
    share = tmp_path / "usr" / "share"
    assert "discover" in (share / "bash-completion/completions/fric-cli").read_text(encoding="utf-8")
    assert (share / "zsh/site-functions/_fric-cli").is_file() and (share / "fish/vendor_completions.d/fric-cli.fish").is_file()
    assert (share / "man/man1/fric-cli-replay.1").is_file()
    environment["PREFIX"] = "dist"
    refused = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert refused.returncode == 2 and "it must be an absolute path" in refused.stderr
