"""The JSON files of the program against docs/reference/schemas, and the schemas against the program's readers.

    schema_test.py SONARCAL READ_DOCUMENTS [FOLDER]

Written files: quick commands run in a temporary folder (or in FOLDER, which stays). Each JSON file they write must be valid,
and each of its keys must be described by its schema. Each property of a schema must stand in backticks in its reference
page.

Read files: from a complete document of each format, every rule of its schema is broken once. Schema and reader must refuse
all of these documents. Both must accept the complete document, the same with all numbers at their limits or without what is
optional, and the documents of ACCEPTED. The reader alone must refuse what breaks a relation between values (RELATIONS),
because no schema can state it. READ_DOCUMENTS is tests/support/read_documents.cc.
"""

import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema

SONARCAL = pathlib.Path(sys.argv[1]).resolve()
READ_DOCUMENTS = pathlib.Path(sys.argv[2]).resolve()
REFERENCE = pathlib.Path(__file__).resolve().parent.parent / "docs" / "reference"
PAGES = {
    "params": "parameters.md",
    "recording": "recording.md",
    "poses": "poses_file.md",
    "fit_config": "fit_config.md",
    "metrics": "metrics_json.md",
    "fit": "fit_json.md",
    "materials": "materials.md",
    "transfer": "transfer_json.md",
}
SCHEMAS = {
    f"{name}.schema.json": json.loads((REFERENCE / "schemas" / f"{name}.schema.json").read_text(encoding="utf-8"))
    for name in PAGES
}
BY_FORMAT = {
    "sonar-parameters/1": "params",
    "sonar-recording/1": "recording",
    "sonar-poses/1": "poses",
    "sonar-fit-config/1": "fit_config",
    "sonar-metrics/1": "metrics",
    "sonar-fit/1": "fit",
    "sonar-materials/1": "materials",
    "sonar-transfer/1": "transfer",
}
WITHOUT_SCHEMA = {"sonarcal-provenance/1"}
REMOVED = object()

# Complete documents: every property of their schemas.
POSE = {"position_m": [4.8, 3.2, 0.75], "quaternion_wxyz": [1, 0, 0, 0]}
WATER = {"temperature_c": 15, "salinity_ppt": 0.5, "ph": 7, "depth_m": 1}
MOTION = {"velocity_m_per_s": [0.1, 0.2, -0.3], "turn_rate_deg_per_s": [0, -5, 30]}
SETTINGS = {"gain_db": 18, "pulse_length_us": 15, "time_varied_gain": True, "compression": "logarithm"}
GSAB = {"A": 0.1, "B_deg": 4, "C": 0.01, "D": 1, "E": 0.05, "F_deg": 10}
PARAMS = {
    "format": "sonar-parameters/1",
    "model": "acoustic",
    "source_level_db": 200,
    "source_level_sigma_db": 0.5,
    "noise_level_db": 0,
    "array_gain_db": 0,
    "display": {"db_min": 60, "db_max": 120, "law": "log", "soft_db": 0, "exponent": 1},
    "materials": {"default": {"gsab": GSAB, "prior": "silt"}},
    "mirror": {"wall": {"loss_db": 6}},
    "jitter": {
        "sigma_range_m": 0.01,
        "sigma_azimuth_deg": 0.5,
        "reference_range_m": 10,
        "reference_frequency_hz": 900000,
        "growth": "root",
    },
    "receiver": {
        "gain_db": 0,
        "time_varied_gain": "none",
        "noise_db": 75,
        "noise_slope_db_per_m": 0,
        "noise_taper_db": [0],
        "noise_after_gain_db": 60,
        "noise_after_gain_taper_db": [0],
        "looks": 1,
        "diffuse_share": 0,
    },
    "beam": {
        "azimuth_width_deg": 1,
        "elevation_width_deg": 20,
        "azimuth_pattern": "table",
        "azimuth_taper": 1,
        "azimuth_table_db": [-20, 0, -20],
        "elevation_pattern": "cosine",
        "elevation_taper": 1,
        "transmit_even_deg": 10,
        "transmit_end_deg": 30,
        "mirror_lobes": "all",
        "sensitivity_db": [0],
    },
    "pulse": {"length_m": 0.03},
    "water": WATER,
}
RECORDING = {
    "format": "sonar-recording/1",
    "sonar": {
        "name": "small",
        "frequency_hz": 900000,
        "beam_azimuth_deg": [-0.5, 0.5],
        "azimuth_beam_width_deg": 1,
        "elevation_beam_width_deg": 20,
        "range_min_m": 1,
        "range_max_m": 3,
        "range_bins": 100,
        "sound_speed_m_per_s": 1466,
        "beam_forming": "array",
        "azimuth_psf": [0.1, 0.8, 0.1],
        "beam_taper": [1, 1],
        "pings": {"of_beam": [0, 1], "period_s": 0.005, "first_s": 0},
    },
    "water": WATER,
    "image": {
        "layout": "polar",
        "bits": 8,
        "quantity": "grey",
        "full_scale": 255,
        "db_min": 0,
        "db_max": 80,
        "db_span": 80,
        "settings": SETTINGS,
        "display_gamma": 1,
        "valid": "valid.png",
    },
    "source_level_db": 200,
    "scene": "scene.gltf",
    "synthetic": False,
    "generator": "a simulation",
    "details": [["model", "paper"]],
    "notes": ["a sentence"],
    "frames": [{
        "file": "frame_0000.png", "time_s": 0, "world_from_sonar": POSE, "motion": MOTION, "settings": SETTINGS}],
}
CANDIDATE = {
    "what": "best", "world_from_sonar": POSE, "rms_difference": 0.01, "gain_db": -2.5, "worse_by_nats": 0,
    "worse_by_sigmas": 0, "explains_as_well": True,
}
POSES = {"format": "sonar-poses/1", "poses": [
    {"time_s": 0, "world_from_sonar": POSE, "motion": MOTION, "frame": 3, "candidates": [CANDIDATE], "open": ["roll"]}]}
FIT_CONFIG = {
    "format": "sonar-fit-config/1",
    "free": ["materials"],
    "fixed": ["material.wall.gsab.*"],
    "bounds": {"material.floor.gsab.D": [0.5, 3]},
    "priors": {"material.floor.gsab.B_deg": [4, 1], "noise": "none"},
    "pose_prior": {"position_m": 0.02, "angle_deg": 1},
    "start": {"material.floor.gsab.C": 0.004},
    "held_out": [3],
    "used": [0, 1, 2],
}
MATERIALS = {"format": "sonar-materials/1", "materials": {"tank floor": {
    "model": "acoustic",
    "frequency_hz": [700000, 900000],
    "level_db": 200,
    "gsab": {
        **{key: {"centre": centre, "factor": 1.2} for key, centre in GSAB.items()},
        "D": {"centre": 1.8, "sigma": 0.1},
    },
    "source": "fit to the recording tank",
    "comment": "a sentence",
    "origin": {"recording": "tank", "synthetic": True, "program": "sonarcal 0.1.0"},
}}}
COMPLETE = {
    "params": PARAMS, "recording": RECORDING, "poses": POSES, "fit_config": FIT_CONFIG, "materials": MATERIALS,
}

# Further documents that schema and reader accept: changes of the complete one.
ACCEPTED = {
    "params": [
        {key: REMOVED for key in PARAMS if key not in ("format", "model", "materials")},
        {key: None for key in PARAMS if key not in ("format", "model", "materials")},
        {f"receiver.{key}": None for key in PARAMS["receiver"]},
        {f"beam.{key}": None for key in PARAMS["beam"]},
        {"model": "coherent", "display.law": "power", "jitter.growth": "linear"},
        {"receiver.time_varied_gain": "40logR+alpha", "beam.elevation_pattern": "aperture", "beam.mirror_lobes": "main"},
        {"display.law": "soft_amplitude", "beam.azimuth_pattern": "gaussian", "beam.azimuth_table_db": REMOVED},
        {"source_level_db": -500, "receiver.gain_db": 500, "materials.default.gsab.A": 0, "receiver.looks": 1e6},
        {"receiver.looks": 0.5, "receiver.diffuse_share": 0.999},
        {"materials.default.gsab.D": 100, "materials.default.gsab.F_deg": 1000, "mirror.wall.loss_db": 0},
        {"beam.transmit_even_deg": 90, "beam.transmit_end_deg": 90, "beam.azimuth_taper": 0, "pulse.length_m": 0},
        {"water.temperature_c": -4, "water.salinity_ppt": 0, "water.ph": 14, "water.depth_m": 12000},
        {"mirror": {}, "receiver.noise_taper_db": [], "display.db_max": 60.001},
    ],
    "recording": [
        {key: REMOVED for key in RECORDING if key not in ("format", "sonar", "image", "frames")},
        {key: None for key in RECORDING if key not in ("format", "sonar", "image", "frames")},
        {f"sonar.{key}": None for key in RECORDING["sonar"] if not key.startswith("range_") and key != "beam_azimuth_deg"},
        {f"image.{key}": None for key in RECORDING["image"] if key not in ("layout", "bits")},
        {f"frames.0.{key}": None for key in RECORDING["frames"][0] if key != "file"},
        {"comment": "x", "sonar.comment": 1, "image.comment": [], "water.comment": None, "frames.0.comment": {}},
        {"frames.0.world_from_sonar.comment": 1, "frames.0.settings.comment": 1, "image.settings.comment": 1},
        {"image.bits": 16, "image.full_scale": 65535, "image.quantity": "power"},
        {"image.bits": 32, "image.full_scale": 1e12, "image.settings": {}},
        {"sonar.range_bins": 100.0, "sonar.range_min_m": 0, "sonar.azimuth_beam_width_deg": 0},
        {"sonar.pings.period_s": None, "sonar.pings.first_s": REMOVED, "frames.0.motion": {}},
        {"frames.0.motion.velocity_m_per_s": None, "sonar.pings.comment": 1, "frames.0.motion.comment": 1},
        {"frames.0.file": ".hidden.png", "details": [], "notes": [], "frames.0.time_s": -1.5},
    ],
    "poses": [
        {"poses.0.time_s": None},
        {"poses.0.time_s": REMOVED},
        {"poses.0.world_from_sonar.quaternion_wxyz": [0.7071, 0, 0, -0.7071]},
        {"poses.0.world_from_sonar.position_m": [-1e9, 1e9, 0]},
    ],
    "fit_config": [
        {key: REMOVED for key in FIT_CONFIG if key != "format"},
        {key: None for key in FIT_CONFIG if key != "format"},
        {"pose_prior": {}, "held_out": [], "fixed": [], "bounds": {}, "priors": {}},
        {"pose_prior.position_m": None, "pose_prior.angle_deg": None, "held_out": [0.0]},
        {"priors": {"materials": "none", "jitter.*": [0, 1e-9]}},
    ],
    "materials": [
        {"materials": {}},
        {f"materials.tank floor.{key}": REMOVED for key in ("level_db", "comment", "origin")},
        {f"materials.tank floor.{key}": None for key in ("level_db", "comment", "origin")},
        {"materials.tank floor.model": "paper", "materials.tank floor.level_db": -1e9},
        {"materials.tank floor.frequency_hz": [900000, 900000], "materials.tank floor.gsab.D.centre": 0},
    ],
}

# What the complete documents need where all numbers stand at their lower or upper limits: relations must
# hold.
AT_LIMITS = {
    ("params", "lower"): {"display.db_max": -499},
    ("params", "upper"): {"display.db_min": 499},
    ("recording", "lower"): {
        "sonar.range_max_m": 0.001,
        "sonar.beam_azimuth_deg": [-180, -179],
        "image.db_max": -999,
        "image.db_span": 1,
        "frames.0.world_from_sonar.quaternion_wxyz": [-1.001, 0, 0, 0],
    },
    ("recording", "upper"): {
        "sonar.range_min_m": 0,
        "sonar.beam_azimuth_deg": [179, 180],
        "sonar.range_bins": 33554432,
        "sonar.pings.of_beam": [0, 1],
        "image.full_scale": 255,
        "image.db_min": 0,
        "frames.0.world_from_sonar.quaternion_wxyz": [1.001, 0, 0, 0],
    },
    ("poses", "lower"): {
        "poses.0.world_from_sonar.quaternion_wxyz": [0, -1.001, 0, 0],
        "poses.0.candidates.0.world_from_sonar.quaternion_wxyz": [0, -1.001, 0, 0],
    },
    ("poses", "upper"): {
        "poses.0.world_from_sonar.quaternion_wxyz": [0, 0, 1.001, 0],
        "poses.0.candidates.0.world_from_sonar.quaternion_wxyz": [0, 0, 1.001, 0],
    },
    ("fit_config", "lower"): {},
    ("fit_config", "upper"): {},
    ("materials", "lower"): {},
    ("materials", "upper"): {},
}

# Relations between values, which no schema states: the reader alone refuses them.
RELATIONS = {
    "params": [
        {"display.db_max": 60},
        {"beam.transmit_end_deg": 9},
        {"beam.azimuth_table_db": [-20, 0, -20, -30]},
    ],
    "recording": [
        {"sonar.range_max_m": 1},
        {"sonar.beam_azimuth_deg": [0.5, -0.5]},
        {"sonar.beam_taper": [1]},
        {"sonar.pings.of_beam": [0, 1, 2]},
        {"sonar.pings.of_beam": [0, 2]},
        {"sonar.range_bins": 67108864},
        {"image.db_max": 0},
        {"image.db_span": 81},
        {"frames.0.world_from_sonar.quaternion_wxyz": [0.5, 0, 0, 0]},
    ],
    "poses": [{"poses.0.world_from_sonar.quaternion_wxyz": [0.9, 0, 0, 0]}],
    "fit_config": [{"bounds": {"noise": [2, 1]}}],
    "materials": [
        {"materials.tank floor.frequency_hz": [900000, 700000]},
        {"materials": {"sand:medium": MATERIALS["materials"]["tank floor"]}},
    ],
}

# Further damage that both refuse: rules that depend on another value, and words with a meaning of their own.
REFUSED = {
    "params": [{"beam.azimuth_table_db": REMOVED}, {"beam.azimuth_table_db": None}, {"display.db_min": True}],
    "recording": [
        {"image.layout": "fan"},
        {"image.full_scale": 256},
        {"image.bits": 16, "image.full_scale": 65536},
        {"frames.0.file": ""},
        {"frames.0.file": ".."},
        {"frames.0.file": "folder/frame.png"},
        {"frames.0.file": "folder\\frame.png"},
        {"image.valid": "c:valid.png"},
    ],
    "poses": [],
    "fit_config": [{"priors": {"noise": [1, 0]}}, {"priors": {"noise": None}}, {"bounds": {"noise": [1, None]}}],
    "materials": [
        {"materials.tank floor.gsab.A": {"centre": 0.1, "sigma": 0.1}},
        {"materials.tank floor.gsab.D": {"centre": 2, "factor": 1.1}},
    ],
}


def validator_of(name):
    """Validates documents; the schemas refer to each other as files of one folder."""
    schema = SCHEMAS[f"{name}.schema.json"]
    folder = (REFERENCE / "schemas").as_uri()
    store = {f"{folder}/{file}": other for file, other in SCHEMAS.items()}
    resolver = jsonschema.RefResolver(f"{folder}/{name}.schema.json", schema, store=store)
    return jsonschema.Draft202012Validator(schema, resolver=resolver)


def alternatives(name, schema):
    """(name of the file, schema) of a schema and of all that it refers to or combines."""
    if not isinstance(schema, dict):
        return
    yield name, schema
    if "$ref" in schema:
        file, _, place = schema["$ref"].partition("#")
        of = file.removesuffix(".schema.json") if file else name
        target = SCHEMAS[f"{of}.schema.json"]
        for key in place.split("/")[1:]:
            target = target[key]
        yield from alternatives(of, target)
    for part in schema.get("allOf", []) + schema.get("anyOf", []) + schema.get("oneOf", []):
        yield from alternatives(name, part)
    for key in ("then", "else"):
        yield from alternatives(name, schema.get(key))


def undescribed(value, schemas, path=""):
    """Paths of keys that none of the schemas has a property or pattern for."""
    schemas = [each for name, schema in schemas for each in alternatives(name, schema)]
    if isinstance(value, list):
        items = [(name, schema["items"]) for name, schema in schemas if "items" in schema]
        return sum((undescribed(item, items, f"{path}[]") for item in value), [])
    if not isinstance(value, dict):
        return []
    missing = []
    for key, member in value.items():
        of_key = []
        for name, schema in schemas:
            if key in schema.get("properties", {}):
                of_key.append((name, schema["properties"][key]))
            for pattern, described in schema.get("patternProperties", {}).items():
                if re.search(pattern, key):
                    of_key.append((name, described))
            if isinstance(schema.get("additionalProperties"), dict):
                of_key.append((name, schema["additionalProperties"]))
        missing += undescribed(member, of_key, f"{path}.{key}") if of_key else [f"{path}.{key}"]
    return missing


def property_names(schema):
    """Names of all properties below a schema."""
    if isinstance(schema, list):
        return set().union(*(property_names(item) for item in schema))
    if not isinstance(schema, dict):
        return set()
    names = set()
    for key, value in schema.items():
        if key == "properties":
            names |= set(value)
            names |= property_names(list(value.values()))
        elif key not in ("const", "enum", "default", "examples"):
            names |= property_names(value)
    return names


def check_pages():
    """Each property stands in backticks in the reference page of its schema, which links the schema."""
    for name, page in PAGES.items():
        schema = SCHEMAS[f"{name}.schema.json"]
        jsonschema.Draft202012Validator.check_schema(schema)
        text = (REFERENCE / page).read_text(encoding="utf-8")
        assert f"schemas/{name}.schema.json" in text, f"{page} does not link its schema"
        text = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
        words = {word for code in re.findall(r"`([^`\n]+)`", text) for word in re.findall(r"[A-Za-z0-9_]+", code)}
        missing = property_names(schema) - words
        assert not missing, f"{page} does not name {sorted(missing)} in backticks"


def changed(document, changes):
    """A copy with values set, or removed, at paths such as "frames.0.file"."""
    document = copy.deepcopy(document)
    for path, value in changes.items():
        *above, last = [int(key) if key.isdigit() else key for key in path.split(".")]
        place = document
        for key in above:
            place = place[key]
        if value is REMOVED:
            del place[last]
        else:
            place[last] = value
    return document


def merged(name, schema):
    """A schema with what it refers to, its own keywords first; its first alternative."""
    whole = {}
    for _, part in alternatives(name, schema):
        for key, value in part.items():
            whole.setdefault(key, value)
    return whole


def wrong_values(name, schema, value):
    """Values for the place of `value`, each of which breaks one rule of the schema."""
    schema = merged(name, schema)
    if "const" in schema or "enum" in schema:
        yield "nonsense"
        return
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    if "minimum" not in schema and "exclusiveMinimum" not in schema:
        yield 7 if types[0] == "string" else "text"
    if "null" not in types:
        yield None
    if "minimum" in schema:
        yield schema["minimum"] - (1 if types[0] == "integer" else 1e-3 * max(1, abs(schema["minimum"])))
    if "exclusiveMinimum" in schema:
        yield schema["exclusiveMinimum"]
    if "maximum" in schema:
        yield schema["maximum"] + (1 if types[0] == "integer" else 1e-3 * max(1, abs(schema["maximum"])))
    if types[0] == "integer":
        yield value + 0.5
    if "minItems" in schema:
        yield value[: schema["minItems"] - 1]
    if "maxItems" in schema:
        yield value + value[-1:]
    if types[0] == "array" and value:
        for wrong in wrong_values(name, schema["items"], value[0]):
            yield [wrong] + value[1:]
    if types[0] == "object":
        yield []
        if schema.get("additionalProperties") is False:
            yield {**value, "unknown_key": 1}
            lacking = set(schema.get("properties", value)) - set(value)
            assert not lacking, f"the complete document lacks {lacking}"
        for key in schema.get("required", []):
            yield {other: member for other, member in value.items() if other != key}
        if schema.get("minProperties"):
            yield {}
        if "maxProperties" in schema:
            first = next(iter(value.values()))
            yield {f"member_{i}": first for i in range(schema["maxProperties"] + 1)}
        for key, member in value.items():
            of_key = schema.get("properties", {}).get(key, schema.get("additionalProperties"))
            for wrong in wrong_values(name, of_key, member):
                yield {**value, key: wrong}


def at_limit(name, schema, value, side):
    """A value with each number that has a limit on this side moved there."""
    schema = merged(name, schema)
    if isinstance(value, dict):
        described = schema.get("properties", {})
        return {
            key: at_limit(name, described.get(key, schema.get("additionalProperties")), member, side)
            for key, member in value.items()
        }
    if isinstance(value, list):
        return [at_limit(name, schema["items"], item, side) for item in value]
    if side == "lower" and "exclusiveMinimum" in schema:
        return schema["exclusiveMinimum"] + 1e-9
    return schema.get("minimum" if side == "lower" else "maximum", value)


def without_optional(name, schema, value):
    """A value without the optional numbers and words of each object."""
    schema = merged(name, schema)
    if isinstance(value, list):
        return [without_optional(name, schema["items"], item) for item in value]
    if not isinstance(value, dict):
        return value
    described, required = schema.get("properties"), schema.get("required", [])
    return {
        key: without_optional(name, described[key] if described else schema["additionalProperties"], member)
        for key, member in value.items()
        if not described or key in required or isinstance(member, (dict, list))
    }


class World:
    """A small sonar in the paper's tank, and what commands make of it."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.count = 0

    def write(self, name, document):
        """Writes a JSON file."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(document), encoding="utf-8")
        return path

    def read(self, name):
        """Reads a JSON file."""
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    def end_of(self, command):
        """Runs a command, given as a text or a list of words."""
        words = command.split() if isinstance(command, str) else command
        return subprocess.run(
            [SONARCAL] + words, cwd=self.folder, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )

    def run(self, command, status=0):
        """Runs a command that must end with a status."""
        ended = self.end_of(command)
        assert ended.returncode == status, f"{command}: ended with {ended.returncode}\n{ended.stdout}{ended.stderr}"

    def make(self):
        """Runs one command of each kind that writes a file with a schema."""
        run = self.run
        run("scenes --only tank --out paper")
        self.write("sonar.json", {
            "sonar": {
                "name": "small",
                "frequency_hz": 900000,
                "beam_azimuth_deg": [-11.5 + beam for beam in range(24)],
                "azimuth_beam_width_deg": 1,
                "elevation_beam_width_deg": 20,
                "range_min_m": 0.62,
                "range_max_m": 7.02,
                "range_bins": 96,
                "beam_forming": "array",
            },
            "water": WATER,
        })
        turning = self.read("sonar.json")
        turning["sonar"]["pings"] = {"of_beam": [beam % 4 for beam in range(24)], "period_s": 0.01}
        self.write("turning_input/sonar.json", turning)
        poses = self.read("paper/poses_tank.json")
        turned = {f"poses.{i}.motion": {"turn_rate_deg_per_s": [0, 0, 40]} for i in range(len(poses["poses"]))}
        self.write("turning_poses.json", changed(poses, turned))
        self.write("repeated.json", changed(poses, {"poses.1.world_from_sonar": poses["poses"][0]["world_from_sonar"]}))
        away = {"poses.0.world_from_sonar.quaternion_wxyz": [0, 0, 0, 1]}  # from the mockup
        self.write("away.json", changed(POSES, away))
        self.write("acoustic.json", {
            "format": "sonar-parameters/1",
            "model": "acoustic",
            "display": {"db_min": 60, "db_max": 120},
            "materials": {"default": {"gsab": GSAB, "prior": "silt"}},
            "receiver": {"noise_db": 75},
        })
        self.write("config.json", FIT_CONFIG)
        world = "--scene paper/tank.gltf --sonar sonar.json"
        repeated = f"{world} --params acoustic.json --poses repeated.json --rays 48x60"
        paper = f"{world} --params paper/params.json --poses paper/poses_tank.json --rays 48x40"
        run(f"simulate {paper} --noise --seed 1 --out recorded")
        run(f"simulate {paper} --expected --out expected")
        run(f"simulate {repeated} --noise --frozen-speckle --out frozen")
        run("simulate --scene paper/tank.gltf --sonar turning_input/sonar.json --params acoustic.json "
            "--poses turning_poses.json --rays 48x60 --noise --out turning")
        run(f"simulate {world} --params paper/params.json --poses away.json --rays 24x8 --out away")
        run("convert recorded --frames 0:2 --out converted")
        self.compare()
        self.fit()
        self.transfer()

    def compare(self):
        """Files metrics.json with all that they may hold."""
        pair = "compare --real recorded --sim expected --pictures 0"
        run = self.run
        run(f"{pair} --object mockup --scene paper/tank.gltf --out compared")
        run(f"{pair} --against compared/metrics.json --sweep-steps 0 --out against")
        run("compare --real frozen --sim frozen --pictures 0 --frames 0:1 --params acoustic.json --out drawn")
        for method in ("otsu", "fixed_threshold", "local_contrast", "os_cfar"):
            run(f"{pair} --frames 0:1 --sweep-steps 2 --segmentation {method} --out {method}")
        run(f"{pair} --frames 0:1 --segmentation local_contrast --contrast-db 3 --out contrast")
        run(f"{pair} --frames 0:1 --simulated-object echoes --region-margin 1 --out echoes")

    def fit(self):
        """Files fit.json, params.json and poses.json of each kind of fit."""
        run = self.run
        quick = "--starts 1 --max-iterations 2"
        paper = f"--scene paper/tank.gltf --params paper/params.json {quick}"
        run(f"fit --real recorded {paper} --rays 48x40 --held-out 3 --out fitted")
        acoustic = f"fit --real frozen --scene paper/tank.gltf --params acoustic.json --rays 48x60 {quick}"
        run(f"{acoustic} --held-out 3 --choose looks --out chosen")
        run(f"{acoustic.replace('frozen', 'turning')} --held-out 3 --pings ignore --out pings")
        run(f"{acoustic} --held-out 2,3 --free receiver.noise_db,pose.mount.z_m --trust-all --out moved")
        run("fit --real frozen --noise-only --find-background --out noise")
        run("fit --real frozen --still --out still")
        run(f"fit --real away {paper} --free material.mockup.* --rays 24x8 --out unusable", status=3)
        run("compare --real frozen --sim frozen --frames 0:1 --pictures 0 --segmentation likelihood_ratio "
            "--background-params noise/params.json --out likelihood_ratio")

    def transfer(self):
        """Files transfer.json, with intervals and without. Masks are bright where only the mock-up echoes."""
        curve = {"A": 0, "B_deg": 4, "C": 0, "D": 1, "E": 0, "F_deg": 10}
        self.write("mask.json", {
            "format": "sonar-parameters/1",
            "model": "paper",
            "display": {"db_min": 0, "db_max": 1},
            "materials": {"default": {"gsab": curve}, "mockup": {"gsab": {**curve, "C": 100}}},
        })
        run = self.run
        world = "--scene paper/tank.gltf --sonar sonar.json --poses paper/poses_tank.json --rays 48x40"
        run(f"simulate {world} --params paper/params.json --noise --seed 2 --out trained")
        run(f"simulate {world} --params mask.json --expected --out masks")
        for name in ("recorded", "masks"):
            run(f"convert {name} --frames 0:2 --out two_{name}")
        run("transfer --train trained --object mockup --test recorded --test-masks masks --out transferred")
        run("transfer --train trained --object mockup --test two_recorded --test-masks two_masks --out transferred_two")
        run("export --to materials --fit fitted/fit.json --recording recorded --out exported.json")

    def check_written(self):
        """Validates every JSON file in the folder. Returns how many there were of each schema."""
        counts = dict.fromkeys(PAGES, 0)
        for path in sorted(self.folder.rglob("*.json")):
            document = json.loads(path.read_text(encoding="utf-8"))
            written_as = document.get("format")
            if written_as in WITHOUT_SCHEMA or path.name == "sonar.json":
                continue
            where = path.relative_to(self.folder)
            assert written_as in BY_FORMAT, f"{where} has the format {written_as}"
            name = BY_FORMAT[written_as]
            error = jsonschema.exceptions.best_match(validator_of(name).iter_errors(document))
            assert error is None, f"{where}: {error.json_path}: {error.message}"
            missing = sorted(set(undescribed(document, [(name, SCHEMAS[f"{name}.schema.json"])])))
            assert not missing, f"{where}: {name}.schema.json does not describe {missing}"
            counts[name] += 1
        return counts

    def refused_recordings(self, documents):
        """Whether the program refuses each recording.json."""
        folders = []
        for document in documents:
            self.count += 1
            folders.append(f"read/{self.count}")
            self.write(f"read/{self.count}/recording.json", document)
        errors = self.end_of(["inspect"] + folders).stderr
        return [f"{folder}/recording.json:" in errors for folder in folders]

    def refused(self, name, documents):
        """Whether the program refuses each document."""
        if name == "recording":
            return self.refused_recordings(documents)
        files = []
        for document in documents:
            self.count += 1
            files.append(self.write(f"read/{self.count}.json", document).relative_to(self.folder))
        if name == "metrics":
            compare = "compare --real recorded --sim expected --frames 0:1 --sweep-steps 0 --pictures 0"
            errors = "".join(self.end_of(f"{compare} --against {file} --out {file}_out").stderr for file in files)
        else:
            # One process for all documents. The program calls the same readers.
            ended = subprocess.run([READ_DOCUMENTS, name] + files, cwd=self.folder, text=True, check=True,
                                   stdout=subprocess.PIPE)
            errors = ended.stdout
        return [f"{file}:" in errors for file in files]

    def check_readers(self):
        """Schema and reader refuse and accept the same documents. Returns how many there were."""
        count = 0
        for name, document in COMPLETE.items():
            wrong = list(wrong_values(name, first_form(name), document))
            wrong += [changed(document, changes) for changes in REFUSED[name]]
            right = [document] + [changed(document, changes) for changes in ACCEPTED[name]]
            right.append(without_optional(name, first_form(name), document))
            for side in ("lower", "upper"):
                right.append(changed(at_limit(name, first_form(name), document, side), AT_LIMITS[name, side]))
            related = [changed(document, changes) for changes in RELATIONS[name]]
            if name == "poses":
                right.append(POSES["poses"])
                wrong += [[], POSES["poses"] + [1], "text"]
            count += self.check_verdicts(name, wrong, right, related)
        metrics = self.read("compared/metrics.json")
        wrong = [{}, [], changed(metrics, {"format": "sonar-metrics/2"}), changed(metrics, {"macro": REMOVED})]
        count += self.check_verdicts("metrics", wrong, [metrics, changed(metrics, {"later": 1, "macro.later": 1})], [])
        return count

    def check_verdicts(self, name, wrong, right, related):
        """Compares what schema and reader say of each document."""
        validator = validator_of(name)
        documents = wrong + right + related
        expected = [True] * len(wrong) + [False] * len(right) + [True] * len(related)
        for number, (document, by_reader) in enumerate(zip(documents, self.refused(name, documents))):
            is_valid = validator.is_valid(document)
            verdict = "accepts" if is_valid else "refuses"
            assert is_valid == (number >= len(wrong)), f"{name}.schema.json {verdict} {document}"
            verdict = "refuses" if by_reader else "accepts"
            assert by_reader == expected[number], f"the program {verdict} {document}"
        return len(documents)


def first_form(name):
    """The schema of a whole document; of poses, which may be a list alone, that of the object."""
    schema = SCHEMAS[f"{name}.schema.json"]
    return schema["oneOf"][0] if "oneOf" in schema else schema


def check_fit_schema(world):
    """fit.json is read by no strict reader: damaged documents are refused by the schema alone."""
    document = world.read("fitted/fit.json")
    validator = validator_of("fit")
    for changes in (
        {"format": "sonar-fit/2"},
        {"parameters.0.status": "open"},
        {"parameters.0.truth": REMOVED},
        {"termination": REMOVED},
        {"timing_s.trace": "1 s"},
        {"metrics_after.macro": REMOVED},
        {"curves.0.sigma_db": 1},
        {"model_choice": []},
        {"model_choice": [{}]},
    ):
        accepted = changes == {"model_choice": []}
        assert validator.is_valid(changed(document, changes)) == accepted, changes


def check_transfer_schema(world):
    """transfer.json is read by no reader: damaged documents are refused by the schema alone."""
    document = world.read("transferred/transfer.json")
    two = world.read("transferred_two/transfer.json")
    assert document["difference"]["iou"]["ci"] and two["difference"]["iou"]["ci"] is None, "with and without intervals"
    validator = validator_of("transfer")
    for changes in (
        {"format": "sonar-transfer/2"},
        {"training": "trained"},
        {"test_frames": 1},
        {"object_share": 1.5},
        {"difference": REMOVED},
        {"trained_on_training.iou": 0.5},
        {"trained_on_training.iou.value": -0.1},
        {"trained_on_test_blocks.recall.ci": [0.1]},
        {"difference.precision.ci": REMOVED},
        {"curves.trained_on_training.recall": [2]},
        {"curves.trained_on_test_blocks": REMOVED},
        {"difference.precision.value": -1},
        {"later": 1},
    ):
        accepted = changes in ({"difference.precision.value": -1}, {"later": 1})
        assert validator.is_valid(changed(document, changes)) == accepted, changes


def main():
    """The test."""
    check_pages()
    with tempfile.TemporaryDirectory() as temporary:
        world = World(sys.argv[3] if len(sys.argv) > 3 else temporary)
        world.make()
        counts = world.check_written()
        assert all(counts.values()), counts
        check_fit_schema(world)
        check_transfer_schema(world)
        read = world.check_readers()
    print("ok:", ", ".join(f"{count} {name}" for name, count in counts.items()), f"written; {read} read")


if __name__ == "__main__":
    main()
