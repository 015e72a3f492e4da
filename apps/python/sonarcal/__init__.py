"""Makes a simulated imaging sonar agree with a real one.

    import sonarcal

    scene = sonarcal.environment("tank")
    recording = sonarcal.simulate(scene, "p900-45", sonarcal.environment_parameters(), sonarcal.viewpoints("tank"))
    recording[0].image.value                       # NumPy array, range bins x beams

Everything here is thin: what it does is done by the commands of `sonarcal`, whose options are keyword arguments of
the same name ("-" as "_"), unit and default; `sonarcal simulate --help` tells them. Angles are in degrees and
levels in dB, as their names say; arrays named `_rad` are in radians.

Images and axes are read-only views of the library's memory, kept alive by the array: copy one to change it. Long
calls let other threads of Python run, call `progress(what, done, total)` where one is given (`total` 0: unknown),
and end by KeyboardInterrupt on Ctrl-C. What a user should not miss goes to the logger "sonarcal", once in a session.

A wrong file or value is a DataError, a wrong option a UsageError, both ValueErrors, in the sentence of the command.
"""

from __future__ import annotations

import dataclasses
import json
import logging
import os
import tempfile
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from . import _sonarcal
from ._options import words as _words
from ._sonarcal import (
    DataError,
    FanImage,
    Frame,
    FrameResiduals,
    Image,
    PolarAxes,
    Pose,
    Recording,
    ResidualView,
    Scene,
    Sonar,
    UsageError,
    __version__,
    environment,
    environments,
    open_recording,
    read_poses,
    sonar,
    sonar_presets,
    viewpoints,
    write_poses,
)

__all__ = [
    "DataError", "FanImage", "FitResult", "Frame", "FrameResiduals", "Image", "PolarAxes", "Pose", "Recording",
    "ResidualView", "Scene", "Sonar", "TankReproduction", "UsageError", "__version__", "compare", "compare_images", "environment",
    "environment_parameters", "environments", "fit", "known_bomb", "open_recording", "read_parameters", "read_poses",
    "read_scene", "recording", "reproduce_tank", "residual_view", "resolve_parameters", "segment", "simulate", "sonar",
    "sonar_presets", "viewpoints", "write_parameters", "write_poses",
]

Path = Union[str, "os.PathLike[str]"]
Parameters = Union[Mapping[str, Any], Path]  # params.json as a dict, or its file
Progress = Callable[[str, int, int], object]  # (what is done, steps done, steps in all or 0)
Size = Union[str, Sequence[float]]  # (range bins, beams), or "RxC"
Interval = Union[str, Sequence[float]]  # (low, high), or "A:B"

_log = logging.getLogger("sonarcal")
_warned: set[str] = set()


def _say(sentence: str) -> None:
    """A caution is said once in a session, what is being done each time."""
    caution = sentence.removeprefix("warning: ")
    if caution == sentence:
        _log.info(sentence)
    elif caution not in _warned:
        _warned.add(caution)
        _log.warning(caution)


def _plain(value: Any) -> Any:
    """What json does not know: NumPy's numbers and arrays."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no JSON value")


def _params_text(params: Parameters) -> str:
    if isinstance(params, Mapping):
        return json.dumps(params, default=_plain, indent=1)
    return _sonarcal._read_parameters(params)


def _scene(scene: Union[Scene, Path]) -> tuple[Scene, str]:
    """The scene, and the path it came from or nothing."""
    return (scene, "") if isinstance(scene, Scene) else (read_scene(scene), os.fspath(scene))


def _recording(source: Union[Recording, Path]) -> Recording:
    return source if isinstance(source, Recording) else open_recording(source)


def read_scene(file: Path, *, scene_unit: Optional[str] = None, scene_up: Optional[str] = None) -> Scene:
    """A scene from glTF, OBJ or STL. For OBJ and STL: scene_unit "m", "cm", "mm", "in" or "ft", scene_up "y" or "z"."""
    return _sonarcal._read_scene(file, _words({"scene_unit": scene_unit, "scene_up": scene_up}))


def read_parameters(file: Path) -> dict[str, Any]:
    """params.json as a dict, every group of it with its defaults."""
    return json.loads(_sonarcal._read_parameters(file))


def resolve_parameters(params: Mapping[str, Any]) -> dict[str, Any]:
    """The same parameters with every default filled in. DataError names the key of what is wrong."""
    return json.loads(_sonarcal._parse_parameters(_params_text(params), "the parameters given"))


def write_parameters(params: Mapping[str, Any], file: Path) -> None:
    """Writes params.json, whole or not at all."""
    _sonarcal._write_parameters(file, _params_text(params))


def environment_parameters() -> dict[str, Any]:
    """Parameters of the paper's model for every scene of environments(): its Table 4."""
    return json.loads(_sonarcal._environment_parameters())


def recording(
    images: Union[np.ndarray, Sequence[np.ndarray]],
    sonar_or_axes: Union[Sonar, PolarAxes, str],
    *,
    poses: Sequence[Pose] = (),
    times_s: Sequence[float] = (),
    full_scale: float = 255.0,
    db_min: Optional[float] = None,
    db_max: Optional[float] = None,
    valid: Optional[np.ndarray] = None,
    source: str = "NumPy",
    synthetic: bool = False,
) -> Recording:
    """A recording of images that came from anywhere: another simulator, a model of one's own.

    images: shape (frames, range_bins, beams) or a sequence of (range_bins, beams), grey values 0 .. full_scale,
    row 0 nearest, column 0 leftmost; copied. db_min and db_max: levels shown as 0 and as full_scale, where known.
    valid: shape (range_bins, beams), 0 where a sample holds no measurement. Say `synthetic` of what is simulated.
    """
    known = sonar(sonar_or_axes) if isinstance(sonar_or_axes, str) else sonar_or_axes
    if isinstance(known, PolarAxes):
        known = _sonarcal._sonar_of_axes(known)
    if isinstance(images, np.ndarray) and images.ndim == 2:
        images = [images]
    return _sonarcal._recording_from_images(
        list(images), known, list(poses), list(times_s), full_scale, db_min, db_max, valid, source, synthetic)


def simulate(
    scene: Union[Scene, Path],
    sonar: Union[Sonar, Recording, Path],
    params: Parameters,
    poses: Union[Recording, Path, Pose, Iterable[Pose]],
    *,
    model: Optional[str] = None,
    sampling: Optional[str] = None,
    rays: Optional[Union[str, Sequence[int]]] = None,
    ray_weight: Optional[str] = None,
    normals: Optional[str] = None,
    absorption: Optional[str] = None,
    threads: Optional[int] = None,
    bits: Optional[int] = None,
    noise: bool = False,
    expected: bool = False,
    frozen_speckle: bool = False,
    ghost_order: Optional[int] = None,
    margin: Optional[float] = None,
    seed: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> Recording:
    """What the sonar would see of the scene from each pose, as `sonarcal simulate` does: a recording in memory.

    sonar: a Sonar, the name of a preset, a recording, or a file. poses: Pose objects, or a recording that has them,
    or a file. model: "paper", "acoustic" or "coherent" (default: that of the parameters). rays: (columns, rows).
    margin: azimuth cast beyond the outer beams, degrees. expected: the mean over noise and speckle. Frames are images of 2^bits - 1 grey levels.
    """
    options = {
        "model": model, "sampling": sampling, "rays": rays, "ray_weight": ray_weight, "normals": normals,
        "absorption": absorption, "threads": threads, "bits": bits, "noise": noise,
        "expected": expected, "frozen_speckle": frozen_speckle, "ghost_order": ghost_order, "margin": margin, "seed": seed,
    }
    mesh, scene_path = _scene(scene)
    if isinstance(sonar, Recording):
        sonar = sonar.sonar
    elif not isinstance(sonar, Sonar):
        sonar = _sonarcal.sonar(os.fspath(sonar))
    times_s: Sequence[Optional[float]] = []
    if isinstance(poses, Pose):
        poses = [poses]
    elif isinstance(poses, Recording):
        times_s, poses = poses.times_s(), poses.poses()
    elif isinstance(poses, (str, os.PathLike)):
        poses = read_poses(poses)
    return _sonarcal._simulate(
        mesh, sonar, _params_text(params), list(poses), times_s, scene_path, _words(options), progress, _say)


def compare(
    real: Union[Recording, Path],
    simulated: Union[Recording, Path],
    *,
    frames: Optional[Union[str, range]] = None,
    segmentation: Optional[str] = None,
    sigma_count: Optional[float] = None,
    threshold: Optional[float] = None,
    contrast: Optional[float] = None,
    contrast_db: Optional[float] = None,
    false_alarm_rate: Optional[float] = None,
    cell: Optional[Size] = None,
    guard: Optional[Size] = None,
    training: Optional[Size] = None,
    looks: Optional[float] = None,
    os_quantile: Optional[float] = None,
    cfar_domain: Optional[str] = None,
    background_params: Optional[Path] = None,
    blur: Optional[Size] = None,
    opening: Optional[Size] = None,
    closing: Optional[Size] = None,
    min_area: Optional[int] = None,
    max_size: Optional[Size] = None,
    all_components: bool = False,
    largest_component: bool = False,
    fill: Optional[str] = None,
    object: Optional[str] = None,
    object_margin: Optional[Size] = None,
    region: Optional[Path] = None,
    region_range: Optional[Interval] = None,
    region_azimuth: Optional[Interval] = None,
    region_polygon: Optional[Union[str, Sequence[tuple[float, float]]]] = None,
    region_margin: Optional[float] = None,
    simulated_object: Optional[str] = None,
    echo_level: Optional[float] = None,
    intensity_domain: Optional[str] = None,
    sweep_steps: Optional[int] = None,
    sweep_range: Optional[Interval] = None,
    as_displayed: bool = False,
    against: Optional[Path] = None,
    scene: Optional[Path] = None,
    scene_unit: Optional[str] = None,
    scene_up: Optional[str] = None,
    params: Optional[Path] = None,
    progress: Optional[Progress] = None,
) -> dict[str, Any]:
    """metrics.json of the two recordings as a dict, as `sonarcal compare` makes it (docs/reference/metrics.md).

    frames: range(A, B), "A:B" or "A:B,C:D" of both. cell, guard, training, blur, opening, closing, max_size: (range bins,
    beams). region_range in metres, region_azimuth in degrees, region_margin in metres, contrast_db in dB.
    object: material of the scene, in a box around which the object is searched; object_margin: (range bins, beams).
    """
    options = {name: value for name, value in locals().items() if name not in ("real", "simulated", "progress")}
    return json.loads(_sonarcal._compare(_recording(real), _recording(simulated), _words(options), progress))


def compare_images(
    real: np.ndarray,
    simulated: np.ndarray,
    *,
    range_edges_m: Sequence[float],
    beam_azimuth_deg: Sequence[float],
    full_scale: float = 255.0,
    db_min: Optional[float] = None,
    db_max: Optional[float] = None,
    valid: Optional[np.ndarray] = None,
    **options: Any,
) -> dict[str, Any]:
    """Every figure of two polar images from any source: metrics.json of this one pair as a dict.

    real, simulated: shape (range_bins, beams), grey values 0 .. full_scale, row 0 nearest, column 0 leftmost.
    range_edges_m: range_bins + 1 edges, evenly spaced; beam_azimuth_deg: centres of the beams, rising, positive to
    the right. valid: 0 where a sample holds no measurement. options: those of compare().
    """
    axes = PolarAxes.from_edges(range_edges_m, beam_azimuth_deg)
    pair = [
        recording([image], axes, full_scale=full_scale, db_min=db_min, db_max=db_max, valid=valid, source=name)
        for name, image in (("real image", real), ("simulated image", simulated))
    ]
    return compare(*pair, **options)


def segment(image: Image, **options: Any) -> np.ndarray:
    """Where the object is: shape (range_bins, beams), uint8, 1 for yes. options: those of compare() that say how."""
    return _sonarcal._segment(image, _words(options))


@dataclasses.dataclass(frozen=True)
class FitResult:
    """What a fit found. `report` is fit.json; `parameters` is params.json, None where the fit is not usable."""

    usable: bool
    report: dict[str, Any]
    parameters: Optional[dict[str, Any]]
    poses: list[Pose]  # of every frame, where the fit moved poses; else empty

    def __getitem__(self, name: str) -> dict[str, Any]:
        """The entry of fit.json of a parameter: value, sigma, unit, initial, lower, upper, status, truth."""
        for parameter in self.report["parameters"]:
            if parameter["name"] == name:
                return parameter
        raise KeyError(name)


def fit(
    recording: Union[Recording, Path],
    scene: Union[Scene, Path],
    params: Parameters,
    *,
    config: Optional[Union[Path, Mapping[str, Any]]] = None,
    held_out: Optional[Sequence[int]] = None,
    free: Optional[Sequence[str]] = None,
    fixed: Optional[Sequence[str]] = None,
    choose: Optional[Sequence[str]] = None,
    trust_all: bool = False,
    sampling: Optional[str] = None,
    rays: Optional[Union[str, Sequence[int]]] = None,
    ray_weight: Optional[str] = None,
    normals: Optional[str] = None,
    absorption: Optional[str] = None,
    threads: Optional[int] = None,
    max_iterations: Optional[int] = None,
    starts: Optional[int] = None,
    segmentation: Optional[str] = None,
    sigma_count: Optional[float] = None,
    threshold: Optional[float] = None,
    contrast: Optional[float] = None,
    contrast_db: Optional[float] = None,
    false_alarm_rate: Optional[float] = None,
    cell: Optional[Size] = None,
    guard: Optional[Size] = None,
    training: Optional[Size] = None,
    looks: Optional[float] = None,
    os_quantile: Optional[float] = None,
    cfar_domain: Optional[str] = None,
    background_params: Optional[Path] = None,
    blur: Optional[Size] = None,
    opening: Optional[Size] = None,
    closing: Optional[Size] = None,
    min_area: Optional[int] = None,
    max_size: Optional[Size] = None,
    all_components: bool = False,
    largest_component: bool = False,
    fill: Optional[str] = None,
    object: Optional[str] = None,
    object_margin: Optional[Size] = None,
    region: Optional[Path] = None,
    region_range: Optional[Interval] = None,
    region_azimuth: Optional[Interval] = None,
    region_polygon: Optional[Union[str, Sequence[tuple[float, float]]]] = None,
    region_margin: Optional[float] = None,
    simulated_object: Optional[str] = None,
    echo_level: Optional[float] = None,
    intensity_domain: Optional[str] = None,
    progress: Optional[Progress] = None,
) -> FitResult:
    """Fits the parameters of the model that `params` names to a recording with poses, as `sonarcal fit` does.

    config: the file of --config, or what it holds as a dict. held_out: frames that the fit does not see and is
    judged on (default: the last third). free, fixed: names of parameters, with "*" for any text. object and the
    options after it: those of compare().
    """
    options = {name: value for name, value in locals().items()
               if name not in ("recording", "scene", "params", "config", "progress")}
    mesh, _ = _scene(scene)
    source = _recording(recording)
    text = _params_text(params)
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(config, Mapping):
            file = os.path.join(folder, "config.json")
            with open(file, "w", encoding="utf-8") as out:
                json.dump(config, out, default=_plain, indent=1)
            config = file
        found = _sonarcal._fit(source, mesh, text, _words({**options, "config": config}), progress, _say)
    usable, report, parameters, poses = found
    return FitResult(usable, json.loads(report), json.loads(parameters) if usable else None, poses)


def residual_view(
    recording: Union[Recording, Path],
    scene: Union[Scene, Path],
    params: Parameters,
    *,
    frames: Sequence[int] = (),
    sampling: Optional[str] = None,
    rays: Optional[Union[str, Sequence[int]]] = None,
    ray_weight: Optional[str] = None,
    normals: Optional[str] = None,
    absorption: Optional[str] = None,
    threads: Optional[int] = None,
    progress: Optional[Progress] = None,
) -> ResidualView:
    """The residual that a fit would minimise, to be looked at from Python: for inspection, nothing is solved.

        view = sonarcal.residual_view("river", "river.gltf", "params.json", frames=[0])
        at = view.at(view.initial, 0, ["material.floor.gsab.C"])
        at.expected.value, at.residual, at.jacobian[:, :, 0]

    frames: those of the recording to trace (default: all). Of the acoustic model, every pixel counts in full here:
    what a fit does about unexplained pixels and repeated poses comes after.
    """
    options = {"sampling": sampling, "rays": rays, "ray_weight": ray_weight, "normals": normals,
               "absorption": absorption, "threads": threads}
    mesh, _ = _scene(scene)
    return _sonarcal._residual_view(
        _recording(recording), mesh, _params_text(params), list(frames), _words(options), progress)


@dataclasses.dataclass(frozen=True)
class TankReproduction:
    """The paper's tank comparison. The recording is SYNTHETIC, made by the coherent model."""

    metrics: dict[str, Any]  # metrics.json of `sonarcal reproduce`, without the recorded sonars
    recording: Recording
    scene: Scene
    paper_parameters: dict[str, Any]  # params.json of the paper's model, fitted
    acoustic_parameters: dict[str, Any]  # and of the acoustic one


def reproduce_tank(
    *, quick: bool = False, seed: int = 1, threads: int = 0, progress: Optional[Progress] = None
) -> TankReproduction:
    """Park 2024, Section 6, start to end on a SYNTHETIC recording, as `sonarcal reproduce` does.

    quick: few rays and one start, to try the way, not for figures. seed: of the recording's noise.
    """
    metrics, recorded, scene, paper, acoustic = _sonarcal._reproduce_tank(quick, seed, threads, progress, _say)
    return TankReproduction(json.loads(metrics), recorded, scene, json.loads(paper), json.loads(acoustic))


def known_bomb(folder: Path) -> tuple[Recording, Scene, dict[str, Any]]:
    """Two frames of a bomb that an ARIS 3000 recorded, with the pose and outline found beforehand (docs/studies/bomb.md).

    folder: aris3000_uxo of the real recordings. Returns the recording, the scene, and the acoustic model's
    parameters to start a fit from.
    """
    recorded, scene, params = _sonarcal._known_bomb(folder)
    return recorded, scene, json.loads(params)
