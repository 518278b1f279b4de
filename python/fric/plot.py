"""Figures, drawn with matplotlib (`pip install matplotlib`).

Each function draws into the axes given as `ax`, or into a new figure if none are given, and returns the axes. The colours can be distinguished by
colour-blind readers and in grey.
"""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from ._arguments import must_be, refusal
from ._errors import ConfigError, FitError, ShapeError
from ._fric import Log
from ._results import Compensation, DiscoverResult, FitResult, ReplayResult, ShapeResult
from .fleet import Trend

if TYPE_CHECKING:
    # Type checks without matplotlib accept any axes.
    from matplotlib.axes import Axes as _Axes  # type: ignore[import-not-found, unused-ignore]

    from ._results import CableDiscovery

__all__ = ["candidates", "forces", "friction_loop", "gap_ladder", "parameters", "residuals", "tendon_friction", "tendon_shape", "trend", "where"]

_WAYS = {"none": "#9a9a9a", "coulomb": "#d55e00", "measured": "#009e73", "history": "#0072b2"}
_MEASURED, _MODEL, _REFERENCE, _BAND = "#d55e00", "#0072b2", "#9a9a9a", "#c6dbef"
# Two-sided 95 % quantile of the normal distribution.
_SIGMAS = 1.96


@runtime_checkable
class FittedCable(Protocol):
    """Cable of a fit that `parameters` can draw: values and standard errors by the keys of the robot file."""

    @property
    def name(self) -> str: ...
    @property
    def values(self) -> dict[str, float]: ...
    @property
    def standard_errors(self) -> dict[str, float]: ...


@runtime_checkable
class Fitted(Protocol):
    """Fit that `parameters` can draw."""

    @property
    def cables(self) -> Sequence[FittedCable]: ...


def forces(log: Log, result: ReplayResult | Compensation, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws a cable's force over time: the sensor's force, the compensated force, and the reference if there is one."""
    column = _column(log, result, cable)
    ax = _one(ax, (9.0, 4.0))
    reference_n = log.reference_force_n[:, column]
    if np.isfinite(reference_n).any():
        ax.plot(log.time_s, reference_n, color=_REFERENCE, linewidth=2.4, label="reference")
    ax.plot(log.time_s, result.frictionless_n[:, column], color=_MEASURED, linewidth=0.9, label="measured")
    ax.plot(log.time_s, result.force_at_platform_n[:, column], color=_MODEL, linewidth=0.9, label="compensated")
    ax.set(xlabel="time [s]", ylabel="force at the platform [N]")
    ax.margins(x=0)
    _dress(ax, cable)
    return ax


def friction_loop(log: Log, result: ReplayResult | Compensation, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws a cable's friction over its displacement (the hysteresis loop): the measured friction, which is the reference minus the sensor force
    expected without friction, and that of the model. Both include the offset."""
    column = _column(log, result, cable)
    ax = _one(ax, (6.5, 4.5))
    displacement_mm = 1e3 * (log.length_m[:, column] - log.length_m[:1, column])
    frictionless_n = result.frictionless_n[:, column]
    measured_n = log.reference_force_n[:, column] - frictionless_n
    if np.isfinite(measured_n).any():
        ax.plot(displacement_mm, measured_n, color=_MEASURED, linewidth=0.6, alpha=0.7, label="measured")
    model_n = result.force_at_platform_n[:, column] - frictionless_n
    ax.plot(displacement_mm, model_n, color=_MODEL, linewidth=1.2, label="model")
    ax.set(xlabel="cable paid out [mm]", ylabel="friction [N]")
    _dress(ax, cable)
    return ax


def residuals(
    log: Log,
    result: ReplayResult | Compensation | FitResult,
    cable: str,
    *,
    ax: Sequence[_Axes] | None = None,
    lag_count: int = 200,
) -> tuple[_Axes, _Axes]:
    """Draws the residual error of a cable after compensation into two axes: its distribution with the normal distribution of the same width, and its
    autocorrelation with the 95 % band of white noise. The result of a fit holds all the residuals of its logs."""
    must_be("result", result, "a ReplayResult, a Compensation or a FitResult", ReplayResult, Compensation, FitResult)
    must_be("cable", cable, "a text", str)
    must_be("lag_count", lag_count, "a whole number", int, np.integer)
    if lag_count < 1:
        raise ConfigError(f"`lag_count` is {lag_count}; at least 1 lag is needed")
    if isinstance(result, FitResult):
        left_n = result.cable(cable).residuals_n
    else:
        column = _column(log, result, cable)
        left_n = result.force_at_platform_n[:, column] - log.reference_force_n[:, column]
    left_n = left_n[np.isfinite(left_n)]
    if left_n.size <= lag_count:
        raise ShapeError(f"{cable} has a reference in {left_n.size} rows; more than lag_count = {lag_count} are needed")
    histogram, correlogram = _several(ax, 2, (11.0, 4.0))
    mean_n, sigma_n = float(left_n.mean()), float(left_n.std())
    histogram.hist(left_n, bins=80, density=True, color=_BAND, label="residual")
    if sigma_n > 0:
        force_n = np.linspace(left_n.min(), left_n.max(), 400)
        density = np.exp(-0.5 * ((force_n - mean_n) / sigma_n) ** 2) / (sigma_n * np.sqrt(2 * np.pi))
        histogram.plot(force_n, density, color=_MODEL, linewidth=1.4, label=f"normal, {sigma_n:.2g} N")
    histogram.set(xlabel="compensated less reference [N]", ylabel="density [1/N]")
    _dress(histogram, cable)

    band = _SIGMAS / np.sqrt(left_n.size)
    lags = np.arange(1, lag_count + 1)
    correlogram.axhspan(-band, band, color=_BAND, label="white noise, 95 %")
    correlogram.plot(lags, _autocorrelation(left_n - mean_n, lag_count), color=_MODEL, linewidth=1.2, label="residual")
    correlogram.set(xlabel="lag [samples]", ylabel="autocorrelation [1]")
    correlogram.margins(x=0)
    _dress(correlogram, cable)
    return histogram, correlogram


def parameters(fit_result: Fitted, *, ax: Sequence[_Axes] | None = None) -> tuple[_Axes, ...]:
    """Draws fitted parameters with their 95 % intervals: one of `ax` for each parameter, one line for each cable. A value without a standard error
    has an open mark."""
    if not isinstance(fit_result, Fitted) or not all(isinstance(cable, FittedCable) for cable in fit_result.cables):
        raise refusal("the result of a fit", fit_result, "fit_result")
    cables = fit_result.cables
    keys = list(dict.fromkeys(key for cable in cables for key in cable.values))
    panels = _several(ax, len(keys), (2.9 * len(keys), 1.2 + 0.32 * len(cables)), f" for {', '.join(keys)}")
    places = np.arange(len(cables))
    for place, (panel, key) in enumerate(zip(panels, keys)):
        values = np.array([cable.values.get(key, np.nan) for cable in cables])
        errors = np.array([cable.standard_errors.get(key, np.nan) for cable in cables])
        known = np.isfinite(errors)
        panel.errorbar(
            values[known], places[known], xerr=_SIGMAS * errors[known], fmt="o", color=_MODEL, markersize=4, capsize=3
        )
        panel.plot(values[~known], places[~known], "o", color=_MODEL, markersize=5, markerfacecolor="none")
        panel.set(xlabel=key, ylim=(len(cables) - 0.5, -0.5))
        panel.set_yticks(places, [cable.name for cable in cables] if place == 0 else [""] * len(cables))
        panel.locator_params(axis="x", nbins=3)
        panel.margins(x=0.2)
        panel.grid(axis="x", color="#e6e6e6", linewidth=0.8)
        panel.set_axisbelow(True)
        panel.spines[["top", "right"]].set_visible(False)
    return tuple(panels)


def gap_ladder(result: DiscoverResult, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws how the error on the held-out samples falls towards the noise: a bar for the given model after a fit, and one for each effect found, with
    the fraction of the gap that it and the effects above it close."""
    found = _told(result, cable)
    ax = _one(ax, (7.0, 1.4 + 0.4 * (1 + len(found.effects))))
    steps: list[tuple[str, float | None, float | None]] = [
        ("given model", found.before.rms_n if found.before else None, None)
    ]
    for effect in found.effects:
        steps.append((f"+ {effect['kind']}", effect["evidence"]["held_out_rms_n"], effect["gap_closed"]))
    errors_n = [np.nan if error_n is None else error_n for _, error_n, _ in steps]
    bars = ax.barh(range(len(steps)), errors_n, color=[_MEASURED] + [_MODEL] * len(found.effects), height=0.62)
    ends = [f"{error_n:.4f} N" for error_n in errors_n]
    closed = ["" if share is None else f", {100 * _share(share):.0f} % of the gap closed" for *_, share in steps]
    ax.bar_label(bars, [end + share for end, share in zip(ends, closed)], padding=4, fontsize="small")
    _noise(ax, found)
    _rows(ax, [name for name, *_ in steps], cable)
    # Leave room for the text to the right of the longest bar.
    ax.set_xlim(0, 1.6 * max(np.nanmax(errors_n), found.noise_floor_n or 0.0))
    ax.set_xlabel("rms on samples held out [N]")
    return ax


def where(result: DiscoverResult, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws where the given model disagrees, most significant first: the fraction of the error above the noise that lies in a range of a condition,
    beside the fraction of the samples there."""
    found = _told(result, cable)
    places = found.where
    ax = _one(ax, (7.0, 1.6 + 0.4 * max(1, len(places))))
    rows = np.arange(len(places))
    of_gap = [100 * _share(place["share_of_excess"]) for place in places]
    of_samples = [100 * _share(place["share_of_samples"]) for place in places]
    if places:
        ax.barh(rows - 0.19, of_gap, height=0.36, color=_MEASURED, label="of the gap")
        ax.barh(rows + 0.19, of_samples, height=0.36, color=_REFERENCE, label="of the samples")
    _rows(ax, found.where_in_words, cable, or_else="the model agrees to the noise")
    ax.set(xlabel="share [%]", xlim=(0, 100))
    return ax


def candidates(result: DiscoverResult, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws the effects that were tried, each added alone to the given model, best first: the error on the held-out samples, with the difference of
    the BIC (negative values favour the effect, -10 strongly). The effects found are darker. An effect may also be found for its contribution in
    addition to another."""
    found = _told(result, cable)
    tried = found.candidates
    ax = _one(ax, (7.0, 1.6 + 0.28 * max(1, len(tried))))
    kinds = {effect["kind"] for effect in found.effects}
    errors_n = [np.nan if of["held_out_rms_n"] is None else of["held_out_rms_n"] for of in tried]
    colors = [_MODEL if of["kind"] in kinds else _BAND for of in tried]
    ax.barh(range(len(tried)), errors_n, color=colors, height=0.7)
    for row, of in enumerate(tried):
        if of["delta_bic"] is not None:
            text = f"ΔBIC {of['delta_bic']:.0f}".replace("-", "−")
            ax.text(0.99, row, text, transform=ax.get_yaxis_transform(), ha="right", va="center", fontsize="small")
    limits_n = [error_n for error_n in errors_n if np.isfinite(error_n)]
    if found.before is not None:
        ax.axvline(found.before.rms_n, color=_MEASURED, linewidth=1.2, label="given model")
        limits_n.append(found.before.rms_n)
    _noise(ax, found)
    _rows(ax, [of["kind"] for of in tried], cable, or_else="nothing was tried")
    # Leave room for the evidence to the right of the longest bar.
    ax.set_xlim(0, 1.35 * max(limits_n))
    ax.set_xlabel("rms on samples held out [N]")
    return ax


def tendon_shape(result: ShapeResult, place: int = 0, *, ax: _Axes | None = None) -> _Axes:
    """Draws one of the selected shapes to scale: the disks for each source of friction, and the markers."""
    shape = _picked(result, place)
    ax = _one(ax, (6.5, 5.0))
    for way in shape["ways"]:
        disks_m = np.vstack([[0.0, 0.0], way["disk_position_m"]])
        ax.plot(disks_m[:, 0], disks_m[:, 1], color=_WAYS[way["way"]], linewidth=1.4, label=way["way"])
    if shape["marker_m"]:
        marker_m = np.array(shape["marker_m"], dtype=float)
        ax.plot(marker_m[:, 0], marker_m[:, 1], "ko", markersize=4, fillstyle="none", label="markers")
    ax.set(xlabel="x [m]", ylabel="y [m]")
    ax.set_aspect("equal", adjustable="datalim")
    _dress(ax, f"{shape['time_s']:g} s")
    return ax


def tendon_friction(result: ShapeResult, place: int = 0, *, ax: _Axes | None = None) -> _Axes:
    """Draws the friction at every hole of one of the selected shapes, as signed bars for each source of friction; positive if the tension on the base
    side is greater."""
    shape = _picked(result, place)
    ax = _one(ax, (8.0, 4.0))
    ways = [way for way in shape["ways"] if way["way"] != "none"]
    width = 0.8 / len(ways) if ways else 0.8
    for index, way in enumerate(ways):
        holes = np.arange(1, len(way["friction_n"]) + 1) + (index - 0.5 * (len(ways) - 1)) * width
        friction_n = np.array(way["friction_n"], dtype=float)
        ax.bar(holes, friction_n, width=0.9 * width, color=_WAYS[way["way"]], label=way["way"])
    ax.axhline(0.0, color="black", linewidth=0.8)
    ax.set(xlabel="hole", ylabel="friction [N]")
    _dress(ax, f"{shape['time_s']:g} s")
    return ax


def trend(result: Trend, robot: str, cable: str, parameter: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws a parameter over the dates of the logs: values with their 95 % intervals, the line fitted to them, the date of each change with its
    interval, and limits. A value without a standard error has no bar."""
    must_be("result", result, "a Trend", Trend)
    series = result.of(robot, cable, parameter)
    ax = _one(ax, (9.0, 4.0))
    bars = _SIGMAS * np.where(np.isfinite(series.standard_errors), series.standard_errors, 0.0)
    ax.errorbar(series.date, series.values, yerr=bars, fmt="o", color=_MEASURED, markersize=3, linewidth=0.8, label="logs")
    steps = [int(np.searchsorted(series.date, _utc(change.date))) for change in series.changes if change.kind == "step"]
    for begin, end in zip([0, *steps], [*steps, len(series.date)]):
        label = "" if begin else "level and slope"
        ax.plot(series.date[begin:end], series.fitted[begin:end], color=_MODEL, linewidth=1.6, label=label)
    for place, change in enumerate(series.changes):
        ax.axvspan(_utc(change.earliest), _utc(change.latest), color=_BAND, alpha=0.7, linewidth=0)
        ax.axvline(_utc(change.date), color="black", linewidth=1.0, linestyle="--", label="" if place else "change")
    for place, bound in enumerate(one for one in series.limits if one is not None):
        ax.axhline(bound, color=_REFERENCE, linestyle=":", linewidth=1.4, label="" if place else "limit")
    ax.set(ylabel=parameter)
    _dress(ax, f"{robot}, {cable}")
    ax.tick_params(axis="x", rotation=20)
    return ax


def _utc(date: datetime) -> Any:
    """Converts a date to the form of the dates of a series."""
    return np.datetime64(date.replace(tzinfo=None), "ns")


def _picked(result: ShapeResult, place: int) -> dict[str, Any]:
    must_be("result", result, "a ShapeResult", ShapeResult)
    must_be("place", place, "a whole number", int, np.integer)
    shapes = result.shapes
    if not -len(shapes) <= place < len(shapes):
        raise ConfigError(f"there is no shape {place}, as `place` says; the result has {len(shapes)}")
    return shapes[place]


def _discovery(result: DiscoverResult, cable: str) -> Any:
    """Draws the figure of `DiscoverResult.plot`."""
    found = _told(result, cable)
    heights = [1.4 + 0.4 * len(found.effects), 1.2 + 0.4 * len(found.where), 1.2 + 0.24 * len(found.candidates)]
    axes = _figure(3, (7.5, 0.6 + sum(heights)), heights=heights)
    for draw, ax in zip((gap_ladder, where, candidates), axes):
        draw(result, cable, ax=ax)
    return axes[0].figure


def _told(result: DiscoverResult, cable: str) -> CableDiscovery:
    """Returns the findings for a cable. Raises an error if no verdict is possible."""
    must_be("result", result, "a DiscoverResult", DiscoverResult)
    must_be("cable", cable, "a text", str)
    found = result.cable(cable)
    if found.missing is not None:
        raise FitError(f"nothing can be told of {cable}: {found.missing['cause']}. {found.missing['advice']}")
    return found


def _share(share: float | None) -> float:
    """Limits a fraction to the range 0 to 1; returns 0 if it is not known."""
    return 0.0 if share is None else max(0.0, min(1.0, share))


def _noise(ax: _Axes, found: CableDiscovery) -> None:
    """Draws the noise as a line that no model can fall below."""
    if found.noise_floor_n is not None:
        ax.axvline(found.noise_floor_n, color="black", linestyle=":", linewidth=1.2, label="noise")


def _rows(ax: _Axes, names: Sequence[str], cable: str, *, or_else: str = "") -> None:
    """Labels the rows of bars, the first on top; shows a word in the middle if there are none."""
    _dress(ax, cable)
    ax.grid(axis="y", visible=False)
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(max(1, len(names)) - 0.5, -0.5)
    if not names:
        ax.text(0.5, 0.5, or_else, transform=ax.transAxes, ha="center", va="center")


def _autocorrelation(signal: NDArray[np.float64], lag_count: int) -> NDArray[np.float64]:
    """Returns the autocorrelation at lags 1 to `lag_count`, or zeros for a signal that is zero."""
    spectrum = np.fft.rfft(signal, 2 * signal.size)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2)[: lag_count + 1]
    return covariance[1:] / covariance[0] if covariance[0] > 0 else np.zeros(lag_count)


def _column(log: Log, result: ReplayResult | Compensation, cable: str) -> int:
    must_be("log", log, "a Log", Log)
    must_be("result", result, "a ReplayResult or a Compensation", ReplayResult, Compensation)
    must_be("cable", cable, "a text", str)
    if cable not in log.cable_names:
        raise ConfigError(f"the log has no cable `{cable}`; it has {', '.join(log.cable_names)}")
    if result.frictionless_n.shape != log.sensor_force_n.shape:
        shapes = f"{result.frictionless_n.shape} and {log.sensor_force_n.shape}"
        raise ShapeError(f"result and log are not of the same run: their forces are of shape {shapes}")
    return log.cable_names.index(cable)


def _one(ax: _Axes | None, size: tuple[float, float]) -> _Axes:
    """Returns the given axes, or those of a new figure."""
    if ax is None:
        (ax,) = _figure(1, size)
    _must_be_axes(ax)
    return ax


def _several(ax: Sequence[_Axes] | None, count: int, size: tuple[float, float], purpose: str = "") -> Sequence[_Axes]:
    """Returns the given axes, or those of a new figure."""
    if ax is None:
        return _figure(count, size)
    if not hasattr(ax, "__len__") or isinstance(ax, (str, bytes)):
        raise refusal(f"{count} axes of matplotlib", ax, "ax")
    if len(ax) != count:
        raise ShapeError(f"`ax` has {len(ax)} axes; {count} are needed{purpose}")
    for one in ax:
        _must_be_axes(one)
    return ax


def _must_be_axes(ax: Any) -> None:
    if not hasattr(ax, "get_legend_handles_labels"):
        raise refusal("axes of matplotlib", ax, "ax")


def _figure(count: int, size: tuple[float, float], *, heights: Sequence[float] | None = None) -> Sequence[Any]:
    """Creates a figure with axes side by side, or one below the other with these heights."""
    try:
        pyplot = import_module("matplotlib.pyplot")
    except ImportError as error:
        raise ImportError("fric.plot needs matplotlib; install it with `pip install matplotlib`") from error
    if heights is None:
        _, axes = pyplot.subplots(1, count, figsize=size, layout="constrained", squeeze=False)
    else:
        ratios = {"height_ratios": heights}
        _, axes = pyplot.subplots(count, 1, figsize=size, layout="constrained", squeeze=False, gridspec_kw=ratios)
    return list(axes.flat)


def _dress(ax: _Axes, cable: str) -> None:
    """Places the legend above the data, beside the cable's name."""
    if ax.get_legend_handles_labels()[0]:
        ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False, borderaxespad=0.2)
    ax.set_title(cable, loc="right", fontsize="medium")
    ax.grid(color="#e6e6e6", linewidth=0.8)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
