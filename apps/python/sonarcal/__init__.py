"""Makes a simulated imaging sonar agree with a real one.

    import sonarcal

    scene = sonarcal.environment("tank")
    recording = sonarcal.simulate(scene, "p900-45", sonarcal.environment_parameters(), sonarcal.viewpoints("tank"))
    recording[0].image.value                       # NumPy array, range bins x beams

simulate(), compare(), calibrate(), fit(), judge_noise(), locate() and explain() do what the commands of `sonarcal` do. Their options are keyword arguments
with the names, units and defaults of the commands ("-" as "_"); help(sonarcal.fit) lists them. They also take an
options object such as FitOptions, or a dict. Angles are in degrees and levels in dB; arrays named `_rad` are in
radians.

Images and axes are read-only views of the library's memory, kept alive by the array: copy one to change it. Long
calls let other threads of Python run, call `progress(what, done, total)` if one is given (`total` 0: unknown), and
end with KeyboardInterrupt on Ctrl-C. Warnings go to the logger "sonarcal", once in a session.

A wrong file or value is a DataError, a wrong argument a UsageError. Both are ValueErrors.
"""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from . import _sonarcal
from ._results import Calibration, Comparison, Explanation, FitResult, Location, NoiseJudgement, TankReproduction
from ._signature import give_signature as _give_signature
from ._signature import takes as _takes
from ._sonarcal import (
    CalibrateOptions,
    CauseMap,
    ComparedFrame,
    CompareOptions,
    ComparisonOptions,
    DataError,
    ExplainOptions,
    FanImage,
    FitOptions,
    Frame,
    FrameResiduals,
    Image,
    JudgeNoiseOptions,
    LocateOptions,
    Parameters,
    PolarAxes,
    Pose,
    RayOptions,
    Recording,
    ResidualView,
    Scene,
    SimulateOptions,
    Sonar,
    UsageError,
    __version__,
    environment,
    environment_parameters,
    environments,
    open_recording,
    read_poses,
    read_scene,
    sonar,
    sonar_presets,
    viewpoints,
    write_poses,
)

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import (
        CalibrateKeywords,
        CompareKeywords,
        ComparisonKeywords,
        ExplainKeywords,
        FitKeywords,
        JudgeNoiseKeywords,
        LocateKeywords,
        RayKeywords,
        SimulateKeywords,
    )

__all__ = [
    "CalibrateOptions", "Calibration", "CauseMap", "CompareOptions", "ComparedFrame", "Comparison",
    "ComparisonOptions", "DataError", "ExplainOptions", "Explanation", "FanImage", "FitOptions", "FitResult", "Frame",
    "FrameResiduals", "Image", "JudgeNoiseOptions", "LocateOptions", "Location", "NoiseJudgement", "Parameters",
    "PolarAxes", "Pose", "RayOptions", "Recording", "ResidualView", "Scene", "SimulateOptions", "Sonar",
    "TankReproduction", "UsageError", "__version__", "calibrate", "compare", "compare_images", "environment",
    "environment_parameters", "environments", "explain", "fit", "judge_noise", "known_bomb", "locate",
    "open_recording", "read_parameters", "read_poses", "read_scene", "recording", "reproduce_tank", "residual_view",
    "resolve_parameters", "segment", "simulate", "sonar", "sonar_presets", "viewpoints", "write_parameters",
    "write_poses",
]

_Path = Union[str, "os.PathLike[str]"]
_Params = Union[Parameters, Mapping[str, Any], _Path]  # params.json as an object, a dict or a file
_Progress = Callable[[str, int, int], object]  # (what is done, steps done, steps in all or 0)
_Options = Mapping[str, Any]

_log = logging.getLogger("sonarcal")
_warned: set[str] = set()

for _options_class in (
        CalibrateOptions, CompareOptions, ComparisonOptions, ExplainOptions, FitOptions, JudgeNoiseOptions,
        LocateOptions, RayOptions, SimulateOptions):
    _give_signature(_options_class)
del _options_class


def _say(sentence: str) -> None:
    """Logs a warning once in a session, and what is being done each time."""
    warning = sentence.removeprefix("warning: ")
    if warning == sentence:
        _log.info(sentence)
    elif warning not in _warned:
        _warned.add(warning)
        _log.warning(warning)


def _params(source: _Params) -> Parameters:
    return source if isinstance(source, Parameters) else Parameters(source)


def _scene(scene: Union[Scene, _Path]) -> tuple[Scene, str]:
    """The scene, and the path it came from or nothing."""
    return (scene, "") if isinstance(scene, Scene) else (read_scene(scene), os.fspath(scene))


def _recording(source: Union[Recording, _Path]) -> Recording:
    return source if isinstance(source, Recording) else open_recording(source)


def read_parameters(file: _Path) -> dict[str, Any]:
    """params.json as a dict, every group of it with its defaults."""
    return Parameters(file).to_dict()


def resolve_parameters(params: _Params) -> dict[str, Any]:
    """The same parameters with every default filled in. DataError names the key of anything wrong."""
    return _params(params).to_dict()


def write_parameters(params: _Params, file: _Path) -> None:
    """Writes params.json, whole or not at all."""
    _params(params).save(file)


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
    """A recording of images from any source: another simulator, or a model of your own.

    images: shape (frames, range_bins, beams) or a sequence of (range_bins, beams), grey values 0 .. full_scale,
    row 0 nearest, column 0 leftmost; copied. db_min and db_max: levels shown as 0 and as full_scale, if known.
    valid: shape (range_bins, beams), 0 where a sample holds no measurement. synthetic: the images are simulated.
    """
    known = sonar(sonar_or_axes) if isinstance(sonar_or_axes, str) else sonar_or_axes
    if isinstance(known, PolarAxes):
        known = _sonarcal._sonar_of_axes(known)
    if isinstance(images, np.ndarray) and images.ndim == 2:
        images = [images]
    return _sonarcal._recording_from_images(
        list(images), known, list(poses), list(times_s), full_scale, db_min, db_max, valid, source, synthetic)


@_takes(SimulateOptions)
def simulate(
    scene: Union[Scene, _Path],
    sonar: Union[Sonar, Recording, _Path],
    params: _Params,
    poses: Union[Recording, _Path, Pose, Iterable[Pose]],
    options: Union[SimulateOptions, _Options, None] = None,
    *,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[SimulateKeywords],
) -> Recording:
    """Simulates what the sonar sees of the scene from each pose: a recording in memory.

    sonar: a Sonar, the name of a preset, a recording, or a file. params: Parameters, a dict or a file. poses: Pose
    objects, or a recording that has them, or a file. Frames are images of 2^bits - 1 grey levels.
    """
    settings = SimulateOptions(options, **keywords)
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
    return _sonarcal._simulate(mesh, sonar, _params(params), list(poses), times_s, scene_path, settings, progress, _say)


def _scene_of_object(real: Recording, simulated: Recording) -> Optional[Scene]:
    """The scene that a recording names, the simulated one first."""
    path = simulated.scene_path or real.scene_path
    return read_scene(path) if path else None


@_takes(CompareOptions)
def compare(
    real: Union[Recording, _Path],
    simulated: Union[Recording, _Path],
    options: Union[CompareOptions, _Options, None] = None,
    *,
    frames: Optional[Union[str, Sequence[int]]] = None,
    scene: Optional[Union[Scene, _Path]] = None,
    scene_unit: Optional[str] = None,
    scene_up: Optional[str] = None,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[CompareKeywords],
) -> Comparison:
    """Measures how well a simulated recording agrees with a real one.

    The result is metrics.json as a dict (docs/reference/metrics.md), with _repr_html_ and plot().

    frames: numbers of the frames to compare, the same in both, such as range(2, 5) or "2:5" (default: all).
    scene: for residuals by incidence angle and material, and for `object`; a Scene or a file (default for `object`:
    the scene that a recording names). scene_unit, scene_up: of an OBJ or STL file, as read_scene() takes them.
    """
    settings = CompareOptions(options, **keywords)
    pair = _recording(real), _recording(simulated)
    if isinstance(frames, str):
        frames = _sonarcal._frames(frames, min(map(len, pair)))
    if scene is not None and not isinstance(scene, Scene):
        scene = read_scene(scene, scene_unit=scene_unit, scene_up=scene_up)
    mesh = scene
    if mesh is None and settings.object:
        mesh = _scene_of_object(*pair)
    compared = _sonarcal._compare(*pair, settings, list(frames or ()), mesh, scene is not None, progress)
    return Comparison(compared.metrics(), compared)


@_takes(CompareOptions)
def compare_images(
    real: np.ndarray,
    simulated: np.ndarray,
    options: Union[CompareOptions, _Options, None] = None,
    *,
    range_edges_m: Sequence[float],
    beam_azimuth_deg: Sequence[float],
    full_scale: float = 255.0,
    db_min: Optional[float] = None,
    db_max: Optional[float] = None,
    valid: Optional[np.ndarray] = None,
    **keywords: Unpack[CompareKeywords],
) -> Comparison:
    """Compares two polar images from any source, as compare() does.

    real, simulated: shape (range_bins, beams), grey values 0 .. full_scale, row 0 nearest, column 0 leftmost.
    range_edges_m: range_bins + 1 edges, evenly spaced; beam_azimuth_deg: centres of the beams, rising, positive to
    the right. valid: 0 where a sample holds no measurement.
    """
    axes = PolarAxes.from_edges(range_edges_m, beam_azimuth_deg)
    pair = [
        recording([image], axes, full_scale=full_scale, db_min=db_min, db_max=db_max, valid=valid, source=name)
        for name, image in (("real image", real), ("simulated image", simulated))
    ]
    return compare(pair[0], pair[1], options, **keywords)


@_takes(ComparisonOptions)
def segment(
    image: Image, options: Union[ComparisonOptions, _Options, None] = None, **keywords: Unpack[ComparisonKeywords]
) -> np.ndarray:
    """Finds the object: an array of shape (range_bins, beams), uint8, 1 where it is."""
    return _sonarcal._segment(image, ComparisonOptions(options, **keywords))


@_takes(FitOptions)
def fit(
    recording: Union[Recording, _Path],
    scene: Union[Scene, _Path],
    params: _Params,
    options: Union[FitOptions, _Options, None] = None,
    *,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[FitKeywords],
) -> FitResult:
    """Fits the parameters of an image model to a recording with poses.

    params: parameters to start from, which name the model: Parameters, a dict or a file. The result has the fitted
    parameters, the report (fit.json), _repr_html_ and plot().
    """
    settings = FitOptions(options, **keywords)
    return FitResult(*_sonarcal._fit(_recording(recording), _scene(scene)[0], _params(params), settings, progress, _say))


@_takes(CalibrateOptions)
def calibrate(
    recording: Union[Recording, _Path],
    scene: Union[Scene, _Path],
    options: Union[CalibrateOptions, _Options, None] = None,
    *,
    background: Optional[Union[Recording, _Path]] = None,
    plan: Optional[Union[Mapping[str, Any], _Path]] = None,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[CalibrateKeywords],
) -> Calibration:
    """Calibrates a simulator to a recording with rough poses and a scene: decides in stages what to fit, and fits it.

    background: pings without targets, for the noise law. plan: decisions to take as they are, plan.json of an earlier
    run as a dict or a file, whole or in part. The result has the fit to all frames, the one that did not see the
    held-out frames, the decisions with their reasons, the calibrated sonar, _repr_html_ and plot().
    """
    settings = CalibrateOptions(options, **keywords)
    pings = None if background is None else _recording(background)
    fit_, evaluation, decisions, sonar_, moved, open_ = _sonarcal._calibrate(
        _recording(recording), _scene(scene)[0], settings, pings, plan, progress, _say)
    return Calibration(FitResult(*fit_), FitResult(*evaluation), decisions, sonar_, moved, open_)


@_takes(JudgeNoiseOptions)
def judge_noise(
    recording: Union[Recording, _Path],
    params: _Params,
    options: Union[JudgeNoiseOptions, _Options, None] = None,
    *,
    frames: Optional[Union[str, Sequence[int]]] = None,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[JudgeNoiseKeywords],
) -> NoiseJudgement:
    """Measures how well a noise law describes pings without targets, without fitting it again.

    params: the law, params.json of `sonarcal fit --noise-only`. Of a file, the fit.json beside it gives window and
    speckle. frames: pings to judge, such as range(60, 80) or "60:80" (default: all). The result is judgement.json as
    a dict (docs/guide/noise.md), with _repr_html_ and plot().
    """
    settings = JudgeNoiseOptions(options, **keywords)
    pings = _recording(recording)
    if isinstance(frames, str):
        frames = _sonarcal._frames(frames, len(pings))
    file = os.fspath(params) if isinstance(params, (str, os.PathLike)) else ""
    return NoiseJudgement(_sonarcal._judge_noise(
        pings, _params(params), [] if frames is None else list(frames), settings, file, progress, _say))


@_takes(LocateOptions)
def locate(
    recording: Union[Recording, _Path],
    target: Union[Scene, _Path],
    options: Union[LocateOptions, _Options, None] = None,
    *,
    frame: Union[int, Sequence[int]] = 0,
    poses: Sequence[Pose] = (),
    progress: Optional[_Progress] = None,
    **keywords: Unpack[LocateKeywords],
) -> Location:
    """Finds the pose of a target in frames of a recording, from the mesh of the target.

    frame: one frame or several. poses: start poses, one per frame or one for all, that are refined without a
    search. The result has the posed recording, the scene, parameters to start a fit from, and all candidate poses (poses.json).
    """
    settings = LocateOptions(options, **keywords)
    frames = [frame] if isinstance(frame, int) else list(frame)
    return Location(*_sonarcal._locate(
        _recording(recording), _scene(target)[0], frames, settings, list(poses), progress, _say))


@_takes(ExplainOptions)
def explain(
    recording: Union[Recording, _Path],
    scene: Union[Scene, _Path],
    params: _Params,
    options: Union[ExplainOptions, _Options, None] = None,
    *,
    progress: Optional[_Progress] = None,
    **keywords: Unpack[ExplainKeywords],
) -> Explanation:
    """Ablation study: adds the parts of the acoustic model one by one and evaluates each on held-out frames.

    params: parameters of the acoustic model to start from: Parameters, a dict or a file. The recording needs two
    frames or more, each with a pose. The result has the steps with their figures, the main cause of each pixel,
    _repr_html_ and plot().
    """
    settings = ExplainOptions(options, **keywords)
    return Explanation(
        *_sonarcal._explain(_recording(recording), _scene(scene)[0], _params(params), settings, progress, _say))


@_takes(RayOptions)
def residual_view(
    recording: Union[Recording, _Path],
    scene: Union[Scene, _Path],
    params: _Params,
    options: Union[RayOptions, _Options, None] = None,
    *,
    frames: Sequence[int] = (),
    progress: Optional[_Progress] = None,
    **keywords: Unpack[RayKeywords],
) -> ResidualView:
    """The residual that a fit would minimise, for inspection from Python. Nothing is solved.

        view = sonarcal.residual_view("river", "river.gltf", "params.json", frames=[0])
        at = view.at(view.initial, 0, ["material.floor.gsab.C"])
        at.expected.value, at.residual, at.jacobian[:, :, 0]

    frames: those of the recording to trace (default: all). With the acoustic model, every pixel counts in full: the
    weights that a fit gives to unexplained pixels and repeated poses are not applied.
    """
    settings = RayOptions(options, **keywords)
    return _sonarcal._residual_view(
        _recording(recording), _scene(scene)[0], _params(params), list(frames), settings, progress)


def reproduce_tank(
    *, quick: bool = False, seed: int = 1, threads: int = 0, progress: Optional[_Progress] = None
) -> TankReproduction:
    """Park 2024, Section 6, start to end on a SYNTHETIC recording, as `sonarcal reproduce` does.

    quick: few rays, one start and no search for other curves, to try the way, not for figures. seed: of the recording's noise.
    """
    return TankReproduction(*_sonarcal._reproduce_tank(quick, seed, threads, progress, _say))


def known_bomb(folder: _Path) -> tuple[Recording, Scene, dict[str, Any]]:
    """Two frames of a bomb that an ARIS 3000 recorded, with the pose and outline found beforehand (docs/studies/bomb.md).

    folder: aris3000_uxo of the real recordings. Returns the recording, the scene, and the acoustic model's
    parameters to start a fit from.
    """
    return _sonarcal._known_bomb(folder)
