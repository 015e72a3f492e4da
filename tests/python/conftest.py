"""A world of a few beams, made through the module itself, and the command to set beside it."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

import sonarcal

BINARY = os.environ.get("SONARCAL_BINARY", "sonarcal")


def quad(corner, u, v):
    corner, u, v = (np.asarray(a, dtype=np.float32) for a in (corner, u, v))
    return [corner, corner + u, corner + u + v, corner + v]


def make_scene():
    x, y, z = np.eye(3, dtype=np.float32)
    corner = np.array([-0.5, -0.5, 0.0], dtype=np.float32)
    quads = [
        (0, quad([-5, -5, 0], 10 * x, 10 * y)),
        (1, quad(corner, x, z)),
        (1, quad(corner + x, y, z)),
        (1, quad(corner + x + y, -x, z)),
        (1, quad(corner + y, -y, z)),
        (1, quad(corner + z, x, y)),
    ]
    vertices = np.concatenate([corners for _, corners in quads])
    triangles = np.concatenate([[[4 * i, 4 * i + 1, 4 * i + 2], [4 * i, 4 * i + 2, 4 * i + 3]] for i in range(len(quads))])
    materials = np.repeat([material for material, _ in quads], 2)
    return sonarcal.Scene(vertices, triangles, materials, ["floor", "box"])


def make_poses():
    return [
        sonarcal.Pose.from_angles([0.0, -2.5, 1.2], 0.0, -25.0),
        sonarcal.Pose.from_angles([1.4, -2.2, 1.5], 30.0, -40.0),
        sonarcal.Pose.from_angles([-0.3, -1.2, 2.6], 0.0, -80.0),
        sonarcal.Pose.from_angles([0.3, 2.4, 0.6], 180.0, -5.0),
    ]


PARAMETERS = {
    "format": "sonar-parameters/1",
    "model": "paper",
    "display": {"db_min": 160.0, "db_max": 166.0},
    "materials": {
        "floor": {"gsab": {"A": 90, "B_deg": 4, "C": 0.5, "D": 1.5, "E": 8, "F_deg": 14}},
        "box": {"gsab": {"A": 40, "B_deg": 3, "C": 2, "D": 1, "E": 10, "F_deg": 12}},
    },
    "jitter": {"sigma_range_m": 0.06, "sigma_azimuth_deg": 1.2, "reference_range_m": 10},
}

# Levels at which the acoustic model shows the floor and the box on its display.
ACOUSTIC = {
    **PARAMETERS,
    "model": "acoustic",
    "display": {"db_min": 120.0, "db_max": 200.0},
    "receiver": {"noise_db": 140.0, "looks": 1.0},
}

SONAR = {
    "sonar": {
        "name": "tiny",
        "frequency_hz": 900000,
        "beam_azimuth_deg": [(beam - 11.5) * 1.2 for beam in range(24)],
        "azimuth_beam_width_deg": 1.2,
        "elevation_beam_width_deg": 40,
        "range_min_m": 0.5,
        "range_max_m": 4.5,
        "range_bins": 60,
        "sound_speed_m_per_s": 1480,
    },
    "water": {"temperature_c": 15, "salinity_ppt": 10, "ph": 8, "depth_m": 1},
}

RAYS = (96, 200)


class World:
    """Files for the command and objects for Python, of the same."""

    def __init__(self, folder: pathlib.Path):
        self.folder = folder
        self.scene = make_scene()
        self.poses = make_poses()
        self.scene_file = folder / "scene.gltf"
        self.scene.save(self.scene_file)
        self.sonar_file = folder / "sonar.json"
        self.sonar_file.write_text(json.dumps(SONAR))
        self.poses_file = folder / "poses.json"
        sonarcal.write_poses(self.poses_file, self.poses)
        self.params_file = folder / "params.json"
        sonarcal.write_parameters(PARAMETERS, self.params_file)
        self.acoustic_file = folder / "acoustic.json"
        sonarcal.write_parameters(ACOUSTIC, self.acoustic_file)
        self.sonar = sonarcal.sonar(str(self.sonar_file))

    def run(self, *words) -> subprocess.CompletedProcess:
        return subprocess.run([BINARY, *map(str, words)], capture_output=True, text=True, check=False)

    def command(self, *words) -> str:
        done = self.run(*words)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def simulate_command(self, name, *words, params=None, rays="96x200") -> pathlib.Path:
        out = self.folder / name
        self.command("simulate", "--scene", self.scene_file, "--sonar", self.sonar_file, "--params",
                     params or self.params_file, "--poses", self.poses_file, "--rays", rays, "--quiet", "--out",
                     out, *words)
        return out

    def simulate(self, params=None, **options) -> sonarcal.Recording:
        return sonarcal.simulate(self.scene_file, self.sonar, params or self.params_file, self.poses_file, rays=RAYS,
                                 **options)


@pytest.fixture(scope="session")
def world(tmp_path_factory) -> World:
    return World(tmp_path_factory.mktemp("world"))


@pytest.fixture(scope="session")
def recorded(world) -> pathlib.Path:
    """A noisy recording in a folder, made by the command."""
    return world.simulate_command("recorded", "--noise", "--bits", "12")


@pytest.fixture(scope="session")
def simulated(world) -> pathlib.Path:
    """The same without noise."""
    return world.simulate_command("simulated", "--bits", "12")
