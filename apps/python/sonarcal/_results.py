"""Results of the long calls: attributes, tables for notebooks, pictures with matplotlib."""

from __future__ import annotations

import dataclasses
import html
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Optional, Sequence

import numpy as np

from ._sonarcal import CauseMap, ComparedFrame, Image, Pose, Recording, Scene, Sonar

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._sonarcal import _ComparedRecordings

# Figures of a summary table: (label, path in metrics.json).
_FIGURES = [
    ("Ns/Nr", ("ns_over_nr",)),
    ("Na/Ns", ("na_over_ns",)),
    ("Na/Nr", ("na_over_nr",)),
    ("IoU", ("iou",)),
    ("intensity error, polar", ("intensity_error", "polar")),
    ("intensity error, fan", ("intensity_error", "fan")),
    ("mean |difference|, whole image", ("intensity", "whole", "mean_absolute")),
]


# Detectors of a transfer: key in transfer.json, label.
_DETECTORS = {
    "trained_on_training": "trained on training recordings",
    "trained_on_test_blocks": "trained on other test frames",
}


def _at(figures: Mapping[str, Any], path: Sequence[str]) -> Any:
    for key in path:
        figures = figures[key]
    return figures


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    return "-" if value is None else html.escape(str(value))


def _table(header: Iterable[str], rows: Iterable[Sequence[Any]]) -> str:
    lines = "".join("<tr>" + "".join(f"<td>{_cell(value)}</td>" for value in row) + "</tr>" for row in rows)
    return "<table><tr>" + "".join(f"<th>{_cell(name)}</th>" for name in header) + f"</tr>{lines}</table>"


def _interval(interval: Optional[Sequence[float]]) -> Optional[str]:
    return f"{interval[0]:.4g} to {interval[1]:.4g}" if interval else None


def _paragraphs(sentences: Iterable[str], label: str) -> str:
    return "".join(f"<p><b>{label}:</b> {html.escape(sentence)}</p>" for sentence in sentences)


def _figure_rows(*summaries: Mapping[str, Any]) -> list[list[Any]]:
    return [[label, *(_at(summary, path) for summary in summaries)] for label, path in _FIGURES]


def _show(panel: Any, image: Image, title: str, value: Optional[np.ndarray] = None, **how: Any) -> Any:
    """An image over azimuth (degrees, positive to the right) and range (metres, far is up)."""
    axes = image.axes
    extent = (*np.degrees(axes.beam_edges_rad[[0, -1]]), axes.range_min_m, axes.range_max_m)
    how = {"cmap": "gray", "vmin": 0, "vmax": image.full_scale, **how}
    shown = panel.imshow(image.value if value is None else value, extent=extent, origin="lower", aspect="auto",
                         interpolation="nearest", **how)
    panel.set(title=title, xlabel="azimuth, degrees", ylabel="range, m")
    return shown


def _outline(panel: Any, image: Image, mask: np.ndarray, color: str) -> None:
    if mask.any():
        panel.contour(np.degrees(image.axes.beam_azimuth_rad), image.axes.range_centres_m, mask, levels=[0.5],
                      colors=color, linewidths=0.8)


def _panels(count: int) -> tuple[Figure, Any]:
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, count, figsize=(4.4 * count, 4.2), squeeze=False)
    return figure, panels[0]


def _show_pair(panels: Any, pair: ComparedFrame, names: tuple[str, str]) -> None:
    """Two images and their difference, with the outlines of the objects."""
    real, simulated = pair.real, pair.simulated
    _show(panels[0], real, f"frame {pair.index}: {names[0]}")
    _outline(panels[0], real, pair.real_object, "tab:green")
    _show(panels[1], simulated, f"frame {pair.index}: {names[1]}")
    _outline(panels[1], simulated, pair.simulated_object, "tab:orange")
    difference = simulated.value / simulated.full_scale - real.value / real.full_scale
    shown = _show(panels[2], real, f"{names[1]} - {names[0]}", difference, cmap="RdBu_r", vmin=-1, vmax=1)
    panels[2].figure.colorbar(shown, ax=panels[2], label="of full scale")


class Comparison(dict):
    """Agreement of two recordings: metrics.json as a dict (docs/reference/metrics.md), with pictures.

        comparison["macro"]["iou"], comparison.macro["iou"]   # mean of the frames
        comparison.plot()                                     # the frame in the middle of the intensity errors
    """

    def __init__(self, metrics: Mapping[str, Any], compared: Optional[_ComparedRecordings] = None) -> None:
        super().__init__(metrics)
        self._compared = compared

    def __reduce__(self) -> Any:
        return (Comparison, (dict(self),))  # the recordings stay behind

    @property
    def macro(self) -> dict[str, Any]:
        """Means over frames, each with its confidence interval ("..._ci")."""
        return self["macro"]

    @property
    def micro(self) -> dict[str, Any]:
        """Figures of all pixels pooled."""
        return self["micro"]

    @property
    def frames(self) -> list[dict[str, Any]]:
        """Figures of each frame."""
        return self["frames"]

    def pair(self, frame: int) -> ComparedFrame:
        """The images of a frame and the objects found in them. Needs the recordings of the comparison."""
        if self._compared is None:
            raise ValueError("a copied or stored comparison has no images")
        return self._compared.pair(frame)

    def plot(self, frame: Optional[int] = None) -> Figure:
        """Real image, simulated image and their difference (default: the frame with the median intensity error)."""
        if self._compared is None:
            raise ValueError("a copied or stored comparison has no images")
        if frame is None:
            telling = self._compared.telling_frames()
            frame = telling[len(telling) // 2]
        figure, panels = _panels(3)
        _show_pair(panels, self.pair(frame), ("real", "simulated"))
        figure.tight_layout()
        return figure

    def _repr_html_(self) -> str:
        title = f"<p>{html.escape(self['simulated'])} against {html.escape(self['real'])}, {len(self.frames)} frames</p>"
        return title + _table(["", "mean of frames", "pixels pooled"], _figure_rows(self.macro, self.micro))


@dataclasses.dataclass(frozen=True, repr=False)
class FitResult:
    """Result of a fit. `report` is fit.json; `parameters` is params.json, None if the fit is not usable."""

    usable: bool
    report: dict[str, Any]
    parameters: Optional[dict[str, Any]]
    poses: list[Pose]  # of every frame, if the fit moved poses; else empty
    frames_before: list[ComparedFrame] = dataclasses.field(default_factory=list, compare=False)
    frames_after: list[ComparedFrame] = dataclasses.field(default_factory=list, compare=False)

    def __reduce__(self) -> Any:
        return (FitResult, (self.usable, self.report, self.parameters, self.poses))  # without images

    def __getitem__(self, name: str) -> dict[str, Any]:
        """The entry of fit.json of a parameter: value, sigma, unit, initial, lower, upper, status, truth."""
        for parameter in self.report["parameters"]:
            if parameter["name"] == name:
                return parameter
        raise KeyError(name)

    @property
    def metrics_before(self) -> Optional[Comparison]:
        """Expected images by the initial parameters against the recording. None if the fit is not usable."""
        return Comparison(self.report["metrics_before"]) if self.usable else None

    @property
    def metrics_after(self) -> Optional[Comparison]:
        """The same by the fitted parameters, on the held-out frames if there are any."""
        return Comparison(self.report["metrics_after"]) if self.usable else None

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the fit, one sentence each."""
        return self.report["warnings"]

    @property
    def free(self) -> list[dict[str, Any]]:
        """Entries of the parameters that were fitted."""
        return [parameter for parameter in self.report["parameters"] if parameter["status"] != "fixed"]

    def __repr__(self) -> str:
        if not self.usable:
            return f"FitResult(not usable: {self.report['termination']})"
        return f"FitResult({len(self.free)} parameters fitted, frames {self.report['frames_used']})"

    def plot(self, frame: Optional[int] = None) -> Figure:
        """Recorded image, expected image by the fitted parameters and their difference.

        frame: one of those kept in frames_after (default: the first).
        """
        kept = {pair.index: pair for pair in self.frames_after}
        if not kept:
            raise ValueError("no images: the fit is not usable, or the result was copied or stored")
        if frame is not None and frame not in kept:
            raise ValueError(f"frame {frame} is not kept, expected one of {sorted(kept)}")
        figure, panels = _panels(3)
        _show_pair(panels, kept[min(kept) if frame is None else frame], ("recorded", "fitted"))
        figure.tight_layout()
        return figure

    def _repr_html_(self) -> str:
        text = _paragraphs(self.warnings, "Warning")
        if not self.usable:
            return text + _paragraphs([self.report["termination"]], "Not usable")
        text += _table(["", "before", "after"], _figure_rows(self.report["metrics_before"]["macro"],
                                                             self.report["metrics_after"]["macro"]))
        return text + _table(["parameter", "initial", "fitted", "standard error", "unit", "status"],
                             [[p["name"], p["initial"], p["value"], p["sigma"], p["unit"], p["status"]]
                              for p in self.free])


@dataclasses.dataclass(frozen=True, repr=False)
class Calibration:
    """A calibrated simulator, by calibrate()."""

    fit: FitResult  # to all frames used
    evaluation: FitResult  # did not see the held-out frames; the same as `fit` if none is held out
    plan: dict[str, Any]  # plan.json: the decisions, and what the last fit started from
    sonar: Sonar  # the calibrated sonar: Recording.with_sonar() takes it, and save() writes it
    scene: Optional[Scene]  # the scene with objects where they were found; None if none moved
    open: list[str]  # what the recording could not determine, one sentence each

    @property
    def parameters(self) -> Optional[dict[str, Any]]:
        """params.json of the fit to all frames."""
        return self.fit.parameters

    @property
    def report(self) -> dict[str, Any]:
        """fit.json of the fit to all frames."""
        return self.fit.report

    @property
    def poses(self) -> list[Pose]:
        """Pose of every frame."""
        return self.fit.poses

    @property
    def decisions(self) -> list[dict[str, str]]:
        """What each stage decided: stage, choice and reason."""
        return self.plan["decided"]

    @property
    def metrics_before(self) -> Optional[Comparison]:
        """Images by the start values against the held-out frames."""
        return self.evaluation.metrics_before

    @property
    def metrics_after(self) -> Optional[Comparison]:
        """Images by the values of the evaluation against the held-out frames, which it did not see."""
        return self.evaluation.metrics_after

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the fit, one sentence each."""
        return self.fit.warnings

    def __getitem__(self, name: str) -> dict[str, Any]:
        """The entry of fit.json of a parameter."""
        return self.fit[name]

    def __repr__(self) -> str:
        decisions = ", ".join(each["stage"] + ": " + each["choice"] for each in self.decisions)
        return f"Calibration({decisions})"

    def plot(self, frame: Optional[int] = None) -> Figure:
        """A held-out frame: recorded image, expected image and their difference (FitResult.plot)."""
        return self.evaluation.plot(frame)

    def _repr_html_(self) -> str:
        decisions = _table(["stage", "decision", "reason"],
                           [[each["stage"], each["choice"], each["reason"]] for each in self.decisions])
        return decisions + _paragraphs(self.open, "Open") + self.fit._repr_html_()


class NoiseJudgement(dict):
    """A noise law on pings without targets, by judge_noise(): judgement.json as a dict (docs/guide/noise.md)."""

    @property
    def agreement(self) -> dict[str, Any]:
        """Figures of all pings together."""
        return self["agreement"]

    @property
    def pings(self) -> list[dict[str, Any]]:
        """Figures of each ping."""
        return self["pings"]

    @property
    def cells(self) -> list[dict[str, Any]]:
        """Figures of each cell of range bins and beams."""
        return self["cells"]

    @property
    def drift(self) -> Optional[dict[str, Any]]:
        """Level of the pings over time."""
        return self["drift"]

    @property
    def false_alarms(self) -> list[dict[str, Any]]:
        """Stated and realised rate of each segmentation method; empty without the option."""
        return self.get("false_alarms", [])

    def __repr__(self) -> str:
        return f"NoiseJudgement({len(self.pings)} pings, KS {self.agreement['ks']:.4f})"

    def plot(self) -> Figure:
        """KS and level of each ping."""
        figure, panels = _panels(2)
        frames = [ping["frame"] for ping in self.pings]
        panels[0].plot(frames, [ping["ks"] for ping in self.pings], ".", label="ping")
        panels[0].plot(frames, [ping["chance_ks"] for ping in self.pings], "-", color="gray", label="chance")
        panels[0].set(xlabel="frame", ylabel="KS")
        panels[0].legend()
        panels[1].plot(frames, [ping["level_db"] for ping in self.pings], ".")
        panels[1].set(xlabel="frame", ylabel="level relative to the law, dB")
        figure.tight_layout()
        return figure

    def _repr_html_(self) -> str:
        rows = [["pings", len(self.pings)], ["pings beyond chance", self["pings_beyond_chance"]],
                ["cells", len(self.cells)], ["cells beyond chance", self["cells_beyond_chance"]],
                ["KS", self.agreement["ks"]], ["Wasserstein-1, grey", self.agreement["wasserstein_1_grey"]]]
        return _table(["", "value"], rows)


@dataclasses.dataclass(frozen=True)
class Location:
    """Poses of a target found by locate()."""

    report: dict[str, Any]  # poses.json: the pose of each frame, its candidates, and what is open
    recording: Recording  # the located frames with their best poses
    scene: Scene  # the target, and the floor if there is one
    params: dict[str, Any]  # parameters of the search with the gain found

    @property
    def poses(self) -> list[dict[str, Any]]:
        """One entry per frame: world_from_sonar, candidates, open."""
        return list(self.report["poses"])

    def _repr_html_(self) -> str:
        rows = [[pose["frame"], found["what"], found["rms_difference"], found["worse_by_nats"],
                 found["worse_by_sigmas"], "yes" if found["explains_as_well"] else "no"]
                for pose in self.poses for found in pose["candidates"]]
        open_questions = [sentence for pose in self.poses for sentence in pose["open"]]
        return (_table(["frame", "pose", "rms difference", "worse by, nats", "worse by, sigmas", "explains as well"], rows)
                + _paragraphs(open_questions, "open"))


@dataclasses.dataclass(frozen=True, repr=False)
class Explanation:
    """Ablation study of the acoustic model. `report` is explain.json; `parameters` are those of the last step."""

    report: dict[str, Any]
    parameters: dict[str, Any]
    maps: list[CauseMap] = dataclasses.field(default_factory=list, compare=False)  # of the held-out frames

    def __reduce__(self) -> Any:
        return (Explanation, (self.report, self.parameters))  # without maps

    def __getitem__(self, part: str) -> dict[str, Any]:
        """The step that adds this part: "start", "response", "elevation", "noise", ..."""
        for step in self.steps:
            if step["part"] == part:
                return step
        raise KeyError(part)

    @property
    def steps(self) -> list[dict[str, Any]]:
        """Steps in their order, each with its figures on the held-out frames and its verdict."""
        return self.report["steps"]

    @property
    def cause_names(self) -> list[str]:
        """Meaning of the values of CauseMap.cause."""
        return self.report["causes"]["names"]

    @property
    def warnings(self) -> list[str]:
        """Reasons to doubt the explanation, one sentence each."""
        return self.report["warnings"]

    def __repr__(self) -> str:
        return f"Explanation({', '.join(step['part'] for step in self.steps)})"

    def plot(self, frame: Optional[int] = None) -> Figure:
        """Error of the expected image after each step, the recorded image and the main cause of its pixels.

        frame: a held-out frame (default: the first).
        """
        figure, panels = _panels(3 if self.maps else 1)
        names = [step["part"] for step in self.steps]
        panels[0].barh(names, [step["intensity_error"] or 0.0 for step in self.steps], color="tab:blue")
        panels[0].invert_yaxis()
        panels[0].set(title="held-out frames", xlabel="mean |difference|, of full scale")
        if self.maps:
            maps = {each.index: each for each in self.maps}
            if frame is not None and frame not in maps:
                raise ValueError(f"frame {frame} is not held out, expected one of {sorted(maps)}")
            self._plot_causes(panels[1:], maps[min(maps) if frame is None else frame])
        figure.tight_layout()
        return figure

    def _plot_causes(self, panels: Any, causes: CauseMap) -> None:
        _show(panels[0], causes.recorded, f"frame {causes.index}: recorded")
        names = self.cause_names
        shown = _show(panels[1], causes.recorded, "main cause", causes.cause, cmap="tab20", vmin=-0.5,
                      vmax=len(names) - 0.5)
        present = np.unique(causes.cause)
        bar = panels[1].figure.colorbar(shown, ax=panels[1], ticks=present)
        bar.ax.set_yticklabels([names[i] for i in present])

    def _repr_html_(self) -> str:
        rows = [[step["part"], step["intensity_error"], step["iou"], step["gain_nats_per_pixel"], step["bic_change"],
                 step["verdict"]] for step in self.steps]
        header = ["part", "intensity error", "IoU", "gain, nats per pixel", "change of BIC", "verdict"]
        return (_paragraphs(self.warnings, "Warning") + _table(header, rows)
                + f"<p>{html.escape(self.report['causes']['words'])}</p>")


class TransferResult(dict):
    """Simulated frames as training data, by transfer(): transfer.json as a dict."""

    @property
    def trained_on_training(self) -> dict[str, Any]:
        """Figures of the detector that was trained on the training recordings."""
        return self["trained_on_training"]

    @property
    def trained_on_test_blocks(self) -> dict[str, Any]:
        """Figures of the detectors that were trained on other test frames."""
        return self["trained_on_test_blocks"]

    @property
    def difference(self) -> dict[str, Any]:
        """The first minus the second."""
        return self["difference"]

    def __repr__(self) -> str:
        value = self.difference["average_precision"]["value"]
        return f"TransferResult({self['test_frames']} test frames, difference in average precision {_cell(value)})"

    def plot(self) -> Figure:
        """Precision-recall curves of both detectors, and guessing."""
        figure, panels = _panels(1)
        for key, label in _DETECTORS.items():
            curve = self["curves"][key]
            panels[0].plot(curve["recall"], curve["precision"], label=label)
        panels[0].axhline(self["object_share"], linestyle="--", color="gray", label="guessing")
        panels[0].set(xlabel="recall", ylabel="precision", xlim=(0, 1), ylim=(0, 1))
        panels[0].legend()
        figure.tight_layout()
        return figure

    def _repr_html_(self) -> str:
        rows = []
        for name in self.difference:
            figures = (self.trained_on_training[name], self.trained_on_test_blocks[name], self.difference[name])
            rows.append([name, *(cell for figure in figures for cell in (figure["value"], _interval(figure["ci"])))])
        header = ["", *(cell for label in (*_DETECTORS.values(), "difference") for cell in (label, "95 %"))]
        return _table(header, rows)


@dataclasses.dataclass(frozen=True)
class TankReproduction:
    """The paper's tank comparison. The recording is SYNTHETIC, made by the coherent model."""

    metrics: dict[str, Any]  # metrics.json of `sonarcal reproduce`, without the recorded sonars
    recording: Recording
    scene: Scene
    paper_parameters: dict[str, Any]  # params.json of the paper's model, fitted
    acoustic_parameters: dict[str, Any]  # the same of the acoustic model
