"""Figures, drawn with matplotlib (`pip install fric[plot]`).

Each function draws into the axes given as `ax`, else into a figure of its own, and returns the axes. Colours are told
apart by colour-blind readers too, and in grey.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ._errors import ConfigError, ShapeError
from ._fric import FitResult

if TYPE_CHECKING:
    # Whoever checks types without matplotlib takes axes as they come.
    from matplotlib.axes import Axes as _Axes  # type: ignore[import-not-found, unused-ignore]

    from ._fric import Compensation, Log, ReplayResult

__all__ = ["forces", "friction_loop", "parameters", "residuals"]

_MEASURED, _MODEL, _REFERENCE, _BAND = "#d55e00", "#0072b2", "#9a9a9a", "#c6dbef"
# Two-sided 95 % of a normal distribution.
_SIGMAS = 1.96


class FittedCable(Protocol):
    """What `parameters` wants to know of a cable: values and standard errors by the robot file's keys."""

    @property
    def name(self) -> str: ...
    @property
    def values(self) -> dict[str, float]: ...
    @property
    def standard_errors(self) -> dict[str, float]: ...


class Fitted(Protocol):
    """What `parameters` wants to know of a fit."""

    @property
    def cables(self) -> Sequence[FittedCable]: ...


def forces(log: Log, result: ReplayResult | Compensation, cable: str, *, ax: _Axes | None = None) -> _Axes:
    """Draws a cable's force over time: as the sensor has it, compensated, and the reference where there is one."""
    column = _column(log, result, cable)
    if ax is None:
        ax = _figure(1, (9.0, 4.0))[0]
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
    """Draws a cable's friction over its displacement, the hysteresis loop: measured (reference less what the sensor
    would show without friction) and the model's, the offset included in both."""
    column = _column(log, result, cable)
    if ax is None:
        ax = _figure(1, (6.5, 4.5))[0]
    displacement_mm = 1e3 * (log.length_m[:, column] - log.length_m[0, column])
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
    """Draws what the compensation leaves of a cable's error, into two axes: its distribution beside the normal one of
    the same width, and its autocorrelation with the band in which that of white noise stays (95 %).
    The result of a fit has all the residuals of its logs in it."""
    if isinstance(result, FitResult):
        left_n = result.cable(cable).residuals_n
    else:
        column = _column(log, result, cable)
        left_n = result.force_at_platform_n[:, column] - log.reference_force_n[:, column]
    left_n = left_n[np.isfinite(left_n)]
    if left_n.size <= lag_count:
        raise ShapeError(f"{cable} has a reference in {left_n.size} rows; more than lag_count = {lag_count} are needed")
    histogram, correlogram = _figure(2, (11.0, 4.0)) if ax is None else ax
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
    """Draws fitted parameters with their 95 % intervals, one of `ax` for each parameter, a line for each cable. A value
    without a standard error has an open mark."""
    cables = fit_result.cables
    keys = list(dict.fromkeys(key for cable in cables for key in cable.values))
    panels = _figure(len(keys), (2.9 * len(keys), 1.2 + 0.32 * len(cables))) if ax is None else ax
    if len(panels) != len(keys):
        raise ShapeError(f"`ax` has {len(panels)} axes for {len(keys)} parameters: {', '.join(keys)}")
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


def _autocorrelation(signal: NDArray[np.float64], lag_count: int) -> NDArray[np.float64]:
    """The autocorrelation at lags 1 to `lag_count`; zeros for a signal that is zero."""
    spectrum = np.fft.rfft(signal, 2 * signal.size)
    covariance = np.fft.irfft(np.abs(spectrum) ** 2)[: lag_count + 1]
    return covariance[1:] / covariance[0] if covariance[0] > 0 else np.zeros(lag_count)


def _column(log: Log, result: ReplayResult | Compensation, cable: str) -> int:
    if cable not in log.cable_names:
        raise ConfigError(f"the log has no cable `{cable}`; it has {', '.join(log.cable_names)}")
    if result.frictionless_n.shape != log.sensor_force_n.shape:
        shapes = f"{result.frictionless_n.shape} and {log.sensor_force_n.shape}"
        raise ShapeError(f"result and log are not of the same run: their forces are of shape {shapes}")
    return log.cable_names.index(cable)


def _figure(count: int, size: tuple[float, float]) -> Sequence[Any]:
    """A figure with axes side by side."""
    try:
        pyplot = import_module("matplotlib.pyplot")
    except ImportError as error:
        raise ImportError("fric.plot needs matplotlib; install it with `pip install fric[plot]`") from error
    figure, axes = pyplot.subplots(1, count, figsize=size, layout="constrained", squeeze=False)
    return list(axes[0])


def _dress(ax: _Axes, cable: str) -> None:
    """The legend above the data, the cable's name beside it."""
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3, frameon=False, borderaxespad=0.2)
    ax.set_title(cable, loc="right", fontsize="medium")
    ax.grid(color="#e6e6e6", linewidth=0.8)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
