"""Arrays: no copies where they share, read-only there, alive as long as they are held; closed forms of axes."""

import gc
import json

import numpy as np
import pytest

import sonarcal
from conftest import PARAMETERS, SONAR


def address(array):
    return array.__array_interface__["data"][0]


def churn():
    """Memory that would overwrite what was freed."""
    gc.collect()
    return [np.full(60 * 24, -1.0, dtype=np.float32) for _ in range(2000)]


def test_an_image_is_seen_where_it_lies(recorded):
    frame = sonarcal.open_recording(recorded)[0]
    first, second = frame.image.value, frame.image.value
    assert address(first) == address(second) and np.shares_memory(first, second)
    assert first.dtype == np.float32 and first.shape == (60, 24) and first.flags.c_contiguous
    assert not first.flags.owndata
    axes = frame.image.axes
    assert address(axes.beam_azimuth_rad) == address(frame.image.axes.beam_azimuth_rad)


def test_a_scene_is_seen_where_it_lies(world):
    scene = world.scene
    for name, shape, kind in (("vertices_m", (24, 3), np.float32), ("triangles", (12, 3), np.int32),
                              ("triangle_material", (12,), np.uint16)):
        view = getattr(scene, name)
        assert view.shape == shape and view.dtype == kind and not view.flags.owndata
        assert address(view) == address(getattr(scene, name))


@pytest.mark.parametrize("view", [
    lambda world: world.scene.vertices_m,
    lambda world: world.scene.triangles,
    lambda world: world.sonar.axes.beam_azimuth_rad,
    lambda world: world.simulate()[0].image.value,
    lambda world: world.simulate()[0].image.fan().value,
    lambda world: sonarcal.segment(world.simulate()[0].image),
])
def test_what_is_shared_is_read_only(world, view):
    array = view(world)
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 0
    with pytest.raises(ValueError):
        array.setflags(write=True)
    changed = array.copy()
    changed[...] = 0  # a copy is one's own


def test_arrays_outlive_what_they_are_of(world):
    recording = world.simulate(noise=True)
    expected = [np.array(frame.image.value) for frame in recording]
    azimuth = recording[0].image.axes.beam_azimuth_rad
    values = [frame.image.value for frame in recording]
    fan = recording[1].image.fan().value
    kept_fan = np.array(fan)
    mask = sonarcal.segment(recording[1].image)
    kept_mask = np.array(mask)
    vertices = sonarcal.environment("mockup").vertices_m
    kept_vertices = np.array(vertices)
    del recording
    noise = churn()
    for value, kept in zip(values, expected):
        np.testing.assert_array_equal(value, kept)
    np.testing.assert_allclose(np.degrees(azimuth), SONAR["sonar"]["beam_azimuth_deg"], atol=1e-12)
    np.testing.assert_array_equal(fan, kept_fan)
    np.testing.assert_array_equal(mask, kept_mask)
    np.testing.assert_array_equal(vertices, kept_vertices)
    assert len(noise) == 2000


def test_what_comes_in_is_copied(world):
    images = np.full((1, 60, 24), 7.0, dtype=np.float32)
    recording = sonarcal.recording(images, world.sonar)
    images[...] = 9.0
    assert np.all(recording[0].image.value == 7.0)


def test_any_layout_and_type_comes_in_whole(world):
    value = np.arange(60 * 24, dtype=np.uint16).reshape(60, 24)
    for image in (value, value.astype(float), np.asfortranarray(value), value[::-1][::-1], value.tolist()):
        recording = sonarcal.recording([image], world.sonar, full_scale=65535)
        np.testing.assert_array_equal(recording[0].image.value, value)


def test_axes_in_closed_form():
    axes = sonarcal.PolarAxes(1.0, 3.0, 4, [-10.0, 0.0, 20.0])
    np.testing.assert_allclose(axes.range_edges_m, [1.0, 1.5, 2.0, 2.5, 3.0])
    np.testing.assert_allclose(axes.range_centres_m, [1.25, 1.75, 2.25, 2.75])
    np.testing.assert_allclose(np.degrees(axes.beam_azimuth_rad), [-10.0, 0.0, 20.0])
    np.testing.assert_allclose(np.degrees(axes.beam_edges_rad), [-15.0, -5.0, 10.0, 30.0])
    assert (axes.range_bins, axes.beam_count, axes.range_bin_m) == (4, 3, 0.5)
    assert sonarcal.PolarAxes.from_edges(axes.range_edges_m, [-10.0, 0.0, 20.0]).matches(axes)
    assert not sonarcal.PolarAxes(1.0, 3.1, 4, [-10.0, 0.0, 20.0]).matches(axes)


def test_a_fan_is_laid_out_in_metres():
    # A single bright range bin: an arc of that radius about the sonar.
    axes = sonarcal.PolarAxes(0.0, 4.0, 400, np.linspace(-29.5, 29.5, 60))
    value = np.zeros((400, 60), dtype=np.float32)
    value[300] = 100.0
    fan = sonarcal.Image(value, axes).fan(pixel_m=0.01)
    left, right, bottom, top = fan.extent_m
    rows, cols = np.nonzero(fan.value > 50.0)
    assert rows.size > 100
    x = left + (cols + 0.5) * fan.pixel_m
    y = top - (rows + 0.5) * fan.pixel_m
    np.testing.assert_allclose(np.hypot(x, y), 3.005, atol=0.01)
    assert abs(np.degrees(np.arctan2(x, y)).max() - 30.0) < 0.5
    assert np.all(fan.value[fan.inside == 0] == 0.0)


def test_poses_in_closed_form():
    pose = sonarcal.Pose.from_angles([1.0, 2.0, 3.0], 90.0)
    # Turned to the left by a right angle: ahead (Y) is the world's -X.
    np.testing.assert_allclose(pose.matrix, [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-12)
    np.testing.assert_allclose((pose * pose.inverse()).matrix, np.eye(4), atol=1e-12)
    other = sonarcal.Pose.from_angles([0.5, -1.0, 2.0], 20.0, -30.0, 10.0)
    np.testing.assert_allclose((pose * other).matrix, pose.matrix @ other.matrix, atol=1e-12)
    np.testing.assert_allclose(other.angles_deg, [20.0, -30.0, 10.0], atol=1e-9)
    again = sonarcal.Pose(other.position_m, other.quaternion_wxyz)
    np.testing.assert_allclose(again.matrix, other.matrix, atol=1e-12)
    look = sonarcal.Pose.looking_at([0, 0, 2], [0, 2, 0])
    np.testing.assert_allclose(look.angles_deg, [0.0, -45.0, 0.0], atol=1e-9)


def test_a_recording_comes_back_from_its_folder(world, tmp_path):
    random = np.random.default_rng(4)
    images = random.integers(0, 4096, (3, 60, 24)).astype(np.float32)
    valid = random.integers(0, 2, (60, 24))
    recording = sonarcal.recording(images, world.sonar, poses=world.poses[:3], times_s=[0.0, 1.0, 2.5], full_scale=4095,
                                   db_min=10.0, db_max=90.0, valid=valid, synthetic=True)
    told = []
    recording.save(tmp_path / "saved", progress=lambda *step: told.append(step))
    assert told == [("Writing", done, 3) for done in (1, 2, 3)]
    again = sonarcal.open_recording(tmp_path / "saved")
    assert len(again) == 3 and again.synthetic and again.times_s() == [0.0, 1.0, 2.5]
    assert (again.full_scale, again.db_min, again.db_max) == (4095.0, 10.0, 90.0)
    np.testing.assert_array_equal(again.valid, valid)
    for index, frame in enumerate(again):
        np.testing.assert_array_equal(frame.image.value, images[index])
        np.testing.assert_allclose(frame.pose.matrix, world.poses[index].matrix, atol=1e-12)
    assert again[-1].time_s == 2.5
    with pytest.raises(IndexError):
        again[3]
    assert again.sonar.water == SONAR["water"] or again.sonar.water is None


def test_a_slice_of_a_recording_is_a_recording(world, recorded, tmp_path):
    recording = sonarcal.open_recording(recorded)
    for where, frames in ((slice(1, 3), [1, 2]), (slice(None, None, 2), [0, 2]), (slice(None, None, -1), [3, 2, 1, 0]),
                          (slice(-1, None), [3]), (slice(2, 2), [])):
        part = recording[where]
        assert isinstance(part, sonarcal.Recording) and len(part) == len(frames)
        assert [frame.name for frame in part] == [recording[i].name for i in frames]
        for frame, index in zip(part, frames):
            np.testing.assert_array_equal(frame.image.value, recording[index].image.value)
    middle = recording[1:3]
    np.testing.assert_array_equal(middle[-1].image.value, recording[2].image.value)
    np.testing.assert_array_equal(middle[1:][0].image.value, recording[2].image.value)
    np.testing.assert_allclose(middle.poses()[0].matrix, world.poses[1].matrix, atol=1e-12)
    middle.save(tmp_path / "middle")
    assert len(sonarcal.open_recording(tmp_path / "middle")) == 2
    assert sonarcal.compare(middle, middle)["macro"]["iou"] == 1.0
    with pytest.raises(TypeError):
        recording["first"]


def test_a_slice_keeps_its_recording_alive(world):
    part = world.simulate()[1:2]
    churn()
    assert part[0].image.value.shape == (60, 24)


def test_a_recording_takes_another_sonar(world, recorded, tmp_path):
    calibrated = {**SONAR, "sonar": {**SONAR["sonar"], "range_min_m": 0.45, "range_max_m": 4.4}}
    (tmp_path / "sonar.json").write_text(json.dumps(calibrated))
    recording = sonarcal.open_recording(recorded)
    corrected = recording.with_sonar(sonarcal.sonar(str(tmp_path / "sonar.json")))
    np.testing.assert_allclose(corrected.sonar.axes.range_edges_m[[0, -1]], [0.45, 4.4])
    np.testing.assert_allclose(corrected[0].image.axes.range_edges_m[[0, -1]], [0.45, 4.4])
    np.testing.assert_array_equal(corrected[1].image.value, recording[1].image.value)
    fewer = {**SONAR, "sonar": {**SONAR["sonar"], "range_bins": 59}}
    (tmp_path / "fewer.json").write_text(json.dumps(fewer))
    with pytest.raises(sonarcal.DataError, match="60 range bins and 24 beams, but the sonar 'tiny' has 59 and 24"):
        recording.with_sonar(sonarcal.sonar(str(tmp_path / "fewer.json")))


def test_an_image_is_an_array(world):
    image = world.simulate()[0].image
    array = np.asarray(image)
    assert np.shares_memory(array, image.value) and array.dtype == np.float32 and not array.flags.writeable
    np.testing.assert_array_equal(np.array(image, dtype=float), image.value.astype(float))
    own = np.array(image)
    own[...] = 0
    assert image.value.any()
    fan = image.fan()
    assert np.shares_memory(np.asarray(fan), fan.value)
    assert np.stack([image, image]).shape == (2, 60, 24)
    again = sonarcal.recording([image], world.sonar)
    np.testing.assert_array_equal(again[0].image, image)


def test_scenes_come_from_every_format(world, tmp_path):
    read = sonarcal.read_scene(world.scene_file)
    assert read.material_names == world.scene.material_names
    np.testing.assert_array_equal(read.bounds_m, [[-5, -5, 0], [5, 5, 1]])
    (tmp_path / "plate.obj").write_text("usemtl steel\nv 0 0 0\nv 200 0 0\nv 0 0 -300\nf 1 2 3\n")
    plate = sonarcal.read_scene(tmp_path / "plate.obj", scene_unit="cm")
    np.testing.assert_allclose(plate.bounds_m, [[0, 0, 0], [2, 3, 0]], atol=1e-6)
    assert plate.material_names == ["steel"]
    upright = sonarcal.read_scene(tmp_path / "plate.obj", scene_up="z")
    np.testing.assert_allclose(upright.bounds_m, [[0, 0, -300], [200, 0, 0]], atol=1e-3)
    (tmp_path / "one.stl").write_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                      "vertex 0 1 0\nendloop\nendfacet\nendsolid s\n")
    assert len(sonarcal.read_scene(tmp_path / "one.stl").triangles) == 1


def test_environments_are_those_of_the_command(world, tmp_path):
    world.command("scenes", "--out", tmp_path / "scenes", "--only", "mockup", "--only", "tank", "--quiet")
    for name in ("mockup", "tank"):
        assert name in sonarcal.environments()
        mine = sonarcal.environment(name)
        theirs = sonarcal.read_scene(next((tmp_path / "scenes").rglob(f"{name}*.gltf")))
        np.testing.assert_array_equal(np.sort(mine.vertices_m, axis=0), np.sort(theirs.vertices_m, axis=0))
        assert set(theirs.material_names) <= set(mine.material_names)
        assert len(sonarcal.viewpoints(name)) >= 1
    assert set(sonarcal.environment("tank").material_names) <= set(sonarcal.environment_parameters()["materials"])


def test_parameters_come_back_whole(world, tmp_path):
    full = sonarcal.resolve_parameters(PARAMETERS)
    assert full == sonarcal.read_parameters(world.params_file)
    assert full["materials"]["box"]["gsab"]["A"] == 40.0 and full["pulse"] is not None
    assert sonarcal.resolve_parameters(full) == full
    exact = {**full, "source_level_db": np.float64(200.1) + np.float64(1e-13)}
    sonarcal.write_parameters(exact, tmp_path / "p.json")
    assert sonarcal.read_parameters(tmp_path / "p.json")["source_level_db"] == exact["source_level_db"]


def test_parameters_as_an_object(world, tmp_path):
    parameters = sonarcal.Parameters(PARAMETERS)
    assert parameters == sonarcal.Parameters(world.params_file) == sonarcal.Parameters(parameters)
    assert parameters != sonarcal.Parameters({**PARAMETERS, "source_level_db": 190})
    assert parameters.to_dict() == sonarcal.resolve_parameters(PARAMETERS) and parameters["model"] == "paper"
    assert repr(parameters) == "Parameters(paper model, materials box, floor)"
    parameters.save(tmp_path / "p.json")
    assert sonarcal.Parameters(tmp_path / "p.json") == parameters
    of_dict, of_object, of_file = (world.simulate(source) for source in (PARAMETERS, parameters, tmp_path / "p.json"))
    np.testing.assert_array_equal(of_object[0].image, of_dict[0].image)
    np.testing.assert_array_equal(of_file[0].image, of_dict[0].image)


def test_presets_are_named():
    assert "p900-45" in sonarcal.sonar_presets()
    sonar = sonarcal.sonar("p900-45")
    assert sonar.frequency_hz == 900e3 and sonar.water["temperature_c"] == 15.0
