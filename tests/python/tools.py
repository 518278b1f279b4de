"""What the tests need of the system beyond Rust, Python, make and a C compiler.

`make tools` runs this: apt-get installs what is missing, and what it cannot install is named.
"""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec

# Debian's packages, and the programs of which one does.
PROGRAMS = {
    "chromium": [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    ],
}
# The C and C++ interface is installed, and instructions are counted, on Linux only.
if sys.platform == "linux":
    PROGRAMS |= {"g++": ["c++"], "clang": ["clang"], "cmake": ["cmake"], "pkg-config": ["pkg-config"], "valgrind": ["valgrind"]}
# Without it Debian's Python makes no virtual environment.
VENV = "python3-venv"
# Without a browser the tests of the pages are skipped, without clang those of the headers with it; without any of the others tests fail.
DISPENSABLE = {"chromium", "clang"}


def program(package):
    """The program that a package is needed for, wherever it comes from, or None."""
    return next(filter(None, map(shutil.which, PROGRAMS[package])), None)


def missing():
    """Packages that are needed here."""
    packages = [package for package in PROGRAMS if program(package) is None]
    return packages if find_spec("ensurepip") else [*packages, VENV]


def hint(packages):
    """What to do about packages that are missing."""
    names = " ".join(packages)
    return f"missing for the tests: {names} (on Debian, as root: apt-get install {names}; CONTRIBUTING.md has Fedora's and macOS's names)"


def install(packages):
    """Without asking for a password, and each by itself: one that cannot be had keeps no other back."""
    as_root = [] if os.geteuid() == 0 else ["sudo", "-n"]
    if not all(map(shutil.which, ["apt-get", *as_root[:1]])):
        return
    if subprocess.run([*as_root, "true"], check=False, stderr=subprocess.DEVNULL).returncode != 0:
        return
    print("installing", *packages, flush=True)
    apt_get = [*as_root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq"]
    subprocess.run([*apt_get, "update"], check=False)
    for package in packages:
        subprocess.run([*apt_get, "install", "-y", "--no-install-recommends", package], check=False, stdout=subprocess.DEVNULL)


def main():
    if packages := missing():
        install(packages)
    if packages := missing():
        print(hint(packages), file=sys.stderr)
    return int(any(package not in DISPENSABLE for package in packages))


if __name__ == "__main__":
    sys.exit(main())
