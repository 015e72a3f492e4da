"""Makes a simulated imaging sonar agree with a real one. For example::

    import sonarcal

    scene = sonarcal.environment("tank")
    recording = sonarcal.simulate(scene, "p900-45", sonarcal.environment_parameters(), sonarcal.viewpoints("tank"))
    recording[0].image.value                       # NumPy array, range bins x beams

simulate(), compare(), calibrate(), fit(), judge_noise(), locate(), explain() and transfer() do what the commands of
`sonarcal` do. Their options are keyword arguments with the names, units and defaults of the commands ("-" as "_");
help(sonarcal.fit) lists them. They also take an options object such as FitOptions, or a dict. Angles are in degrees
and levels in dB; arrays named `_rad` are in radians.

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
from ._results import (
    Calibration,
    Comparison,
    Explanation,
    FitResult,
    Location,
    NoiseJudgement,
    TankReproduction,
    TransferResult,
)
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
    TransferOptions,
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
        TransferKeywords,
    )

__all__ = [
    "CalibrateOptions", "Calibration", "CauseMap", "CompareOptions", "ComparedFrame", "Comparison",
    "ComparisonOptions", "DataError", "ExplainOptions", "Explanation", "FanImage", "FitOptions", "FitResult", "Frame",
    "FrameResiduals", "Image", "JudgeNoiseOptions", "LocateOptions", "Location", "NoiseJudgement", "Parameters",
    "PolarAxes", "Pose", "RayOptions", "Recording", "ResidualView", "Scene", "SimulateOptions", "Sonar",
    "TankReproduction", "TransferOptions", "TransferResult", "UsageError", "__version__", "calibrate", "compare",
    "compare_images", "environment", "environment_parameters", "environments", "explain", "fit", "judge_noise",
    "known_bomb", "locate", "open_recording", "read_parameters", "read_poses", "read_scene", "recording",
    "reproduce_tank", "residual_view", "resolve_parameters", "segment", "simulate", "sonar", "sonar_presets",
    "transfer", "viewpoints", "write_parameters", "write_poses",
]

_Path = Union[str, "os.PathLike[str]"]
_Params = Union[Parameters, Mapping[str, Any], _Path]  # params.json as an object, a dict or a file
_Progress = Callable[[str, int, int], object]  # (what is done, steps done, steps in all or 0)
_Options = Mapping[str, Any]
_Recordings = Union[Recording, _Path, Sequence[Union[Recording, _Path]]]

_log = logging.getLogger("sonarcal")
_warned: set[str] = set()

for _options_class in (
        CalibrateOptions, CompareOptions, ComparisonOptions, ExplainOptions, FitOptions, JudgeNoiseOptions,
        LocateOptions, RayOptions, SimulateOptions, TransferOptions):
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


def _recordings(source: _Recordings) -> list[Recording]:
    """One recording or several."""
    alone = isinstance(source, (Recording, str, os.PathLike))
    return [_recording(each) for each in ([source] if alone else source)]


def read_parameters(file: _Path) -> dict[str, Any]:
    """Reads params.json.

    Parameters
    ----------
    file : path
        The file.

    Returns
    -------
    dict
        Every group of parameters, with its defaults.
    """
    return Parameters(file).to_dict()


def resolve_parameters(params: _Params) -> dict[str, Any]:
    """Fills in every default of the parameters.

    Parameters
    ----------
    params : Parameters, dict or path
        The parameters.

    Returns
    -------
    dict
        Every group of parameters, with its defaults.

    Raises
    ------
    DataError
        Names the key of anything wrong.
    """
    return _params(params).to_dict()


def write_parameters(params: _Params, file: _Path) -> None:
    """Writes params.json, whole or not at all.

    Parameters
    ----------
    params : Parameters, dict or path
        The parameters.
    file : path
        The file to write.
    """
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
    """Makes a recording of images from any source: another simulator, or a model of your own.

    Parameters
    ----------
    images : array or sequence of arrays
        Shape (frames, range_bins, beams), or a sequence of (range_bins, beams). Grey values 0 .. full_scale, row 0
        nearest, column 0 leftmost. They are copied.
    sonar_or_axes : Sonar, PolarAxes or str
        The sonar, the name of a preset, or the axes of the images.
    poses : sequence of Pose, optional
        One pose per frame.
    times_s : sequence of float, optional
        One time per frame, in s.
    full_scale : float, optional
        Grey value that counts as full scale.
    db_min, db_max : float, optional
        Levels that are shown as 0 and as full_scale, in dB.
    valid : array, optional
        Shape (range_bins, beams), 0 where a sample holds no measurement.
    source : str, optional
        Name of the source.
    synthetic : bool, optional
        Whether the images are simulated.

    Returns
    -------
    Recording
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
    """Simulates what the sonar sees of the scene from each pose.

    Parameters
    ----------
    scene : Scene or path
        The scene: glTF, OBJ, STL or PLY.
    sonar : Sonar, Recording, path or str
        The sonar, that of a recording, a file, or the name of a preset.
    params : Parameters, dict or path
        The parameters, which name the image model.
    poses : Recording, path, Pose or iterable of Pose
        One pose per frame, or a recording or a file that has them, with its times and the motion of the sonar.
    options : SimulateOptions or dict, optional
        Options. The keywords below override them.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    Recording
        A recording in memory, with grey values 0 .. 2^bits - 1.
    """
    settings = SimulateOptions(options, **keywords)
    mesh, scene_path = _scene(scene)
    if isinstance(sonar, Recording):
        sonar = sonar.sonar
    elif not isinstance(sonar, Sonar):
        sonar = _sonarcal.sonar(os.fspath(sonar))
    if isinstance(poses, Pose):
        poses = [poses]
    elif not isinstance(poses, (Recording, str, os.PathLike)):
        poses = list(poses)
    return _sonarcal._simulate(mesh, sonar, _params(params), poses, scene_path, settings, progress, _say)


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

    Parameters
    ----------
    real, simulated : Recording or path
        The recordings.
    options : CompareOptions or dict, optional
        Options. The keywords below override them.
    frames : str or sequence of int, optional
        Frames to compare, the same in both, such as range(2, 5) or "2:5". Default: all.
    scene : Scene or path, optional
        For residuals by incidence angle and material, and for `object`. Default for `object`: the scene that a
        recording names.
    scene_unit, scene_up : str, optional
        Unit and upward axis of an OBJ, STL or PLY file, as for read_scene.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    Comparison
        metrics.json as a dict (docs/reference/metrics.md), with plot().
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
    chosen = [] if frames is None else list(frames)
    compared = _sonarcal._compare(*pair, settings, chosen, mesh, scene is not None, progress)
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
    """Compares two polar images from any source, as compare does.

    Parameters
    ----------
    real, simulated : array
        Shape (range_bins, beams), grey values 0 .. full_scale, row 0 nearest, column 0 leftmost.
    options : CompareOptions or dict, optional
        Options. The keywords below override them.
    range_edges_m : sequence of float
        range_bins + 1 edges in m, evenly spaced.
    beam_azimuth_deg : sequence of float
        Centres of the beams in degrees, rising, positive to the right.
    full_scale : float, optional
        Grey value that counts as full scale.
    db_min, db_max : float, optional
        Levels that are shown as 0 and as full_scale, in dB.
    valid : array, optional
        Shape (range_bins, beams), 0 where a sample holds no measurement.

    Returns
    -------
    Comparison
        metrics.json as a dict (docs/reference/metrics.md), with plot().
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
    """Finds the object in an image.

    Parameters
    ----------
    image : Image
        A polar image.
    options : ComparisonOptions or dict, optional
        Options. The keywords below override them.

    Returns
    -------
    array
        Shape (range_bins, beams), uint8, 1 where the object is.
    """
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

    Parameters
    ----------
    recording : Recording or path
        The recording, with a pose for each frame.
    scene : Scene or path
        The scene that was recorded: glTF, OBJ, STL or PLY.
    params : Parameters, dict or path
        Parameters to start from, which name the model. In a dict or a file, a material may have a prior and no curve.
    options : FitOptions or dict, optional
        Options. The keywords below override them.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    FitResult
        The fitted parameters and the report (fit.json), with plot().
    """
    settings = FitOptions(options, **keywords)
    return FitResult(*_sonarcal._fit(_recording(recording), _scene(scene)[0], params, settings, progress, _say))


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
    """Calibrates a simulator in stages, and decides what to fit.

    Parameters
    ----------
    recording : Recording or path
        The recording, with rough poses.
    scene : Scene or path
        The scene that was recorded: glTF, OBJ, STL or PLY.
    options : CalibrateOptions or dict, optional
        Options. The keywords below override them.
    background : Recording or path, optional
        Pings without targets, for the noise law.
    plan : dict or path, optional
        Decisions to take as they are: plan.json of an earlier run, whole or in part.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    Calibration
        The fit to all frames, the one that did not use the held-out frames, the decisions with their reasons, and the
        calibrated sonar, with plot().
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

    Parameters
    ----------
    recording : Recording or path
        The pings.
    params : Parameters, dict or path
        The law: params.json of `sonarcal fit --noise-only`. Beside a file, fit.json gives window and speckle.
    options : JudgeNoiseOptions or dict, optional
        Options. The keywords below override them.
    frames : str or sequence of int, optional
        Pings to evaluate, such as range(60, 80) or "60:80". Default: all.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    NoiseJudgement
        judgement.json as a dict (docs/guide/noise.md), with plot().
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

    Parameters
    ----------
    recording : Recording or path
        The recording. It needs no poses.
    target : Scene or path
        The mesh of the target.
    options : LocateOptions or dict, optional
        Options. The keywords below override them.
    frame : int or sequence of int, optional
        One frame or several.
    poses : sequence of Pose, optional
        Start poses, one per frame or one for all, that are refined without a search.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    Location
        The recording with poses, the scene, parameters to start a fit from, and all candidate poses (poses.json).
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

    Parameters
    ----------
    recording : Recording or path
        The recording: two frames or more, each with a pose.
    scene : Scene or path
        The scene that was recorded: glTF, OBJ, STL or PLY.
    params : Parameters, dict or path
        Parameters of the acoustic model to start from.
    options : ExplainOptions or dict, optional
        Options. The keywords below override them.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    Explanation
        The steps with their figures, and the main cause of each pixel, with plot().
    """
    settings = ExplainOptions(options, **keywords)
    return Explanation(
        *_sonarcal._explain(_recording(recording), _scene(scene)[0], _params(params), settings, progress, _say))


@_takes(TransferOptions)
def transfer(
    train: _Recordings,
    test: _Recordings,
    test_masks: _Recordings,
    options: Union[TransferOptions, _Options, None] = None,
    *,
    train_masks: _Recordings = (),
    progress: Optional[_Progress] = None,
    **keywords: Unpack[TransferKeywords],
) -> TransferResult:
    """Measures how well simulated frames train a detector for recorded ones.

    Parameters
    ----------
    train : Recording, path or sequence of these
        Recordings to train on, such as simulated ones.
    test : Recording, path or sequence of these
        Recordings to test on. A reference is trained on them too.
    test_masks : Recording, path or sequence of these
        Masks of the test recordings: bright where the object is.
    options : TransferOptions or dict, optional
        Options. The keywords below override them.
    train_masks : Recording, path or sequence of these, optional
        Masks of the training recordings. Required without `object`.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    TransferResult
        transfer.json as a dict (docs/reference/transfer_json.md), with plot().
    """
    settings = TransferOptions(options, **keywords)
    return TransferResult(_sonarcal._transfer(
        _recordings(train), _recordings(train_masks), _recordings(test), _recordings(test_masks), settings, progress))


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
    """Shows the residual that a fit would minimise. Nothing is solved.

    Parameters
    ----------
    recording : Recording or path
        The recording, with a pose for each frame.
    scene : Scene or path
        The scene that was recorded: glTF, OBJ, STL or PLY.
    params : Parameters, dict or path
        The parameters, which name the image model.
    options : RayOptions or dict, optional
        Options. The keywords below override them.
    frames : sequence of int, optional
        Frames to trace. Default: all.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    ResidualView

    Notes
    -----
    With the acoustic model, every pixel counts in full. The weights that a fit gives to pixels that do not match the
    scene, and to repeated poses, are not applied.

    Examples
    --------
    >>> view = sonarcal.residual_view("river", "river.gltf", "params.json", frames=[0])
    >>> at = view.at(view.initial, 0, ["material.floor.gsab.C"])
    >>> at.expected.value, at.residual, at.jacobian[:, :, 0]
    """
    settings = RayOptions(options, **keywords)
    return _sonarcal._residual_view(
        _recording(recording), _scene(scene)[0], _params(params), list(frames), settings, progress)


def reproduce_tank(
    *, quick: bool = False, seed: int = 1, threads: int = 0, progress: Optional[_Progress] = None
) -> TankReproduction:
    """Reproduces Park 2024, Section 6, on a SYNTHETIC recording, as `sonarcal reproduce` does.

    Parameters
    ----------
    quick : bool, optional
        Few rays, one start and no search for other curves: to try the way, not for figures.
    seed : int, optional
        Seed of the noise of the recording.
    threads : int, optional
        Number of threads, 0 for all.
    progress : callable, optional
        Called with what is done, the steps done and the steps in all (0: unknown). An exception ends the call.

    Returns
    -------
    TankReproduction
    """
    return TankReproduction(*_sonarcal._reproduce_tank(quick, seed, threads, progress, _say))


def known_bomb(folder: _Path) -> tuple[Recording, Scene, dict[str, Any]]:
    """Two frames of a bomb that an ARIS 3000 recorded, with pose and outline (docs/studies/bomb.md).

    Parameters
    ----------
    folder : path
        aris3000_uxo of the real recordings.

    Returns
    -------
    Recording
    Scene
    dict
        Parameters of the acoustic model to start a fit from.
    """
    return _sonarcal._known_bomb(folder)
