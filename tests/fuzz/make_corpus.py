#!/usr/bin/env python3
"""Writes corpus/: small inputs for every fuzz target, by the published layouts and not by the program's code.

  tests/fuzz/make_corpus.py

What is found by scripts/fuzz.sh and mended goes beside them by hand, under a name that says what it was.
"""

import base64
import json
import pathlib
import sqlite3
import struct
import zlib

ROOT = pathlib.Path(__file__).parent / "corpus"


def put(target, name, data):
    folder = ROOT / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())


def fields(size, *values):
    """`size` bytes of zeros with (offset, struct format, value) written into them."""
    data = bytearray(size)
    for offset, form, value in values:
        struct.pack_into("<" + form, data, offset, value)
    return bytes(data)


def png(rows, cols, pixels, bits=8, colour=0):
    channels = {0: 1, 2: 3}[colour]
    row_bytes = cols * channels * bits // 8
    raw = b"".join(b"\0" + pixels[i * row_bytes:(i + 1) * row_bytes] for i in range(rows))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", cols, rows, bits, colour, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b"")


def tiff(rows, cols, bits, is_float):
    pixels = struct.pack(f"<{rows * cols}f", *range(rows * cols)) if is_float else bytes(rows * cols * bits // 8)
    tags = [(256, 4, cols), (257, 4, rows), (258, 3, bits), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1),
            (278, 4, rows), (279, 4, len(pixels)), (339, 3, 3 if is_float else 1)]
    entries = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags)
    return (b"II*\0" + struct.pack("<I", 8 + len(pixels)) + pixels + struct.pack("<H", len(tags)) + entries +
            bytes(4))


def aris(frames, samples=3, beams=64, sorted_by_beam=1, dark_ping=None):
    magic = 0x05464444
    data = fields(1024, (0, "I", magic), (4, "I", frames))
    for k in range(frames):
        data += fields(1024, (0, "I", k), (4, "Q", 1371198079122519 + k), (12, "I", magic), (52, "f", 0.75),
                       (56, "f", 0.15), (68, "I", 18), (224, "f", 12.5), (436, "I", 6), (444, "I", 15),
                       (452, "I", 10), (460, "f", 6.5), (464, "f", 1500.0), (468, "I", samples), (476, "I", 1000),
                       (484, "I", 1), (516, "I", sorted_by_beam), (520, "I", 35))
        data += bytes(0 if i % 4 == dark_ping else i % 256 for i in range(samples * beams))
    return data


def ddf(version, frames=1):
    sizes = {3: (512, 256), 4: (1024, 1024)}[version]
    data = fields(sizes[0], (3, "B", version), (4, "i", frames), (8, "i", 10), (12, "i", 0), (16, "i", 48),
                  (24, "i", 512), (40, "i", version - 3), (44, "i", 200))
    data = b"DDF" + data[3:]
    for _ in range(frames):
        head = fields(sizes[1], *[(20 + 4 * i, "i", v) for i, v in enumerate((2016, 7, 19, 22, 12, 56, 47))],
                      (52, "i", 5), (56, "i", 1), (68, "i", 40))
        data += head + bytes(48 * 512)
    return data


def oculus(version, bytes_per_sample=1, gains=False, ranges=5, beams=4):
    result = 89 if version == 2 else 53
    sizes = result + (72 if version == 2 else 44)
    offsets = result + (101 if version == 2 else 57)
    bearings = offsets + 12
    image = bearings + 2 * beams + 6
    row = beams * bytes_per_sample + (4 if gains else 0)
    whole = image + row * ranges
    sound = (result + 56, "d", 1490.0) if version == 2 else (result + 32, "d", 1490.0)
    head = fields(image, (0, "H", 0x4F53), (6, "H", 0x23), (8, "H", 2 if version == 2 else 0), (10, "I", whole - 16),
                  (16, "B", 2), (19, "B", 127), (20, "B", 0x09 | (4 if gains else 0)), (21, "d", 2.0),
                  (29, "d", 50.0), (45, "d", 0.5), (result, "I", 77), (result + 8, "d", 2.1e6),
                  (result + 16, "d", 11.5), (result + 24, "d", 1.2), sound, (sizes, "B", bytes_per_sample - 1),
                  (sizes + 1, "d", 0.01), (sizes + 9, "H", ranges), (sizes + 11, "H", beams), (offsets, "I", image),
                  (offsets + 4, "I", row * ranges), (offsets + 8, "I", whole),
                  *[(bearings + 2 * i, "h", 180 * i - 270) for i in range(beams)])
    gain = struct.pack("<I", 7) if gains else b""
    return head + (gain + bytes(range(1, beams * bytes_per_sample + 1))) * ranges


def oculus_log(messages):
    data = fields(48, (0, "I", 0x11223344), (4, "I", 48), (24, "H", 1))
    for compressed, message in messages:
        payload = struct.pack(">I", len(message)) + zlib.compress(message) if compressed else message
        data += fields(40, (0, "I", 0xAABBCCDD), (4, "I", 40), (8, "H", 10), (16, "d", 1.5e9),
                       (24, "H", 1 if compressed else 0), (28, "I", len(message)), (32, "I", len(payload))) + payload
    return data


# 60 x 70 grey pixels with a fan, by a common encoder (baseline, quality 60).
JPEG = base64.b64decode(
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAA0JCgsKCA0LCgsODg0PEyAVExISEyccHhcgLikxMC4pLSwzOko+MzZGNywtQFdBRkxO"
    "UlNSMj5aYVpQYEpRUk//wAALCAA8AEYBAREA/8QAGgABAAMBAQEAAAAAAAAAAAAAAAUGBwMCBP/EADIQAAEDAwMCAwcCBwAAAAAA"
    "AAEAAgMEBRESITEGQTJRYQcTFSIjQoEUFlJVYnKRo9L/2gAIAQEAAD8AzBF0ggmqZmw08UksrvCyNpc499gFLwdJX+ohbKy2yBru"
    "BI9rHfkOIIXT9mdRfy//AHR/9LjU9K36ljD5bbK4E4xERIf8NJP5URIx8Ujo5WOY9hLXNcMFpHIIXlEWidNdGWmotsFdWSurDPGH"
    "BjXaWMyBkfKckg5HP4VzgghpoWw08UcUTfCyNoa0d9gF0RFwraKluFOaetgjmiP2vGcHGMjyO53G6ofWHSduttvkuNFO6ANIaKd5"
    "1B5JAw0k541Hv+MKjorx7Ory9lU+0TyOMcgL6cE50uG7gNu4yecbeZWhoiIst68vL6+8PoopHfpaQ6NOdnSDxHGO3h78HHKqyL1G"
    "98UjZInuY9hDmuacFpHBBW0WC6MvFngrG6Q9w0ytH2vHIxk48xnsQpFEUD1nePhNjk90/TU1H0osHBGeXcg7DuOCQsiREVl6GvLL"
    "VeDFUyNZS1Q0Pc44DXDwknHqR2HzZPC1ZF5keyKN0kr2sYwFznOOA0DkkrHeqbt8Zvk1Sw5gZ9OH+wcHgHc5O/GcdlEIiItb6MvY"
    "u9nayV7nVdKAyYkH5udLsnOcgb+oPorAqf7Qb2KS3/C4HuFRUgF5AI0xZPf1IxjfbOeyzREREUr01eDZLxHVlrnxEFkrG4y5p8s+"
    "RAPbjGVrtXX01JbZLhJI11OyP3mprgdQxtg5wc7Y88hYzdq+S6XSorpRh0z8hv8ACOAOBnAAGfRfGiIiIp+rvFZN0bRUL3/SFRIw"
    "nJ1OawMLQd9wNfH9LfJQCIi//9k=")


class Message:
    """Fields of a ROS message one after the other: packed (ROS 1), or aligned behind a CDR head (ROS 2)."""

    def __init__(self, cdr):
        self.cdr = cdr
        self.data = b""

    def put(self, form, *values):
        for value in values:
            size = struct.calcsize("<" + form)
            if self.cdr:
                self.data += bytes(-len(self.data) % size)
            self.data += struct.pack("<" + form, value)
        return self

    def text(self, text):
        raw = text.encode() + (b"\0" if self.cdr else b"")
        self.put("I", len(raw))
        self.data += raw
        return self

    def blob(self, raw):
        self.put("I", len(raw))
        self.data += raw
        return self

    def stamped(self):
        if not self.cdr:
            self.put("I", 1)  # seq
        return self.put("I", 50, 0).text("sonar")

    def done(self):
        return (b"\0\1\0\0" if self.cdr else b"") + self.data


def projected_sonar_image(cdr, beams=3, ranges=2):
    message = Message(cdr).stamped().put("f", 9e5, 1480.0)
    for width in (0.3, 0.01):
        message.put("I", beams).put("f", *[width] * beams)
    message.put("I", beams)
    for beam in range(beams):
        message.put("d", 0.0, 0.1 * (beam - 1), 1.0)
    message.put("I", ranges).put("f", *[1.0 + 0.5 * i for i in range(ranges)])
    return message.put("B", 0).put("I", 0, beams).blob(bytes(range(beams * ranges))).done()


def oculus_interfaces_ping(data, ranges=5, beams=4):
    message = Message(True).stamped().put("I", 77, 5).put("d", 2.0, 50.0, 2.1e6, 1490.0, 0.01, 11.5, 1.2)
    message.put("B", 2, 0).put("H", ranges, beams).put("I", beams).put("B", 1)
    message.put("I", beams).put("h", *[180 * i - 270 for i in range(beams)])
    return message.blob(data).done()


def oculus_stamped_ping(data):
    message = Message(True).stamped().stamped()
    message.put("H", *[0] * 5).put("I", 0).put("H", 0).put("B", *[0] * 5).put("d", *[0.0] * 4)
    message.put("I", 77, 0).put("d", *[0.0] * 4).put("I", 0).put("B", 0).put("d", 0.01).put("H", 5, 4).put("I", 0, 0, 0)
    return message.blob(data).done()


def pose_fields(message):
    """Position and quaternion, x, y, z, w."""
    return message.put("d", 1, 2, 0.5, 0, 0, 0, 1)


def odometry(cdr):
    return pose_fields(Message(cdr).stamped().text("base_link")).put("d", *[0] * (36 + 6 + 36)).done()


def transforms(cdr):
    message = Message(cdr).put("I", 2)
    for parent, child in (("odom", "mast"), ("mast", "base_link")):
        if not cdr:
            message.put("I", 1)  # seq
        pose_fields(message.put("I", 50, 0).text(parent).text(child))
    return message.done()


def sonar_info():
    message = Message(True).stamped().text("m3").text("a calibration").put("I", 7, 8)
    message.put("I", 1).put("f", 2e-5).put("I", 1).put("f", 5e4).blob(b"\1")
    message.put("B", 3, 2, 2).put("f", 0.5, 40.0).put("B", 3).put("f", 250.0, 190.0).put("B", 1)
    message.put("I", 0, 0).put("B", 0).put("f", float("nan")).put("I", 1).put("f", 0.0).put("I", 1).put("f", -1.0)
    return message.done()


def ros1_bag(topic, kind, message):
    def record(head, data):
        packed = b"".join(struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
                          for name, value in head)
        return struct.pack("<I", len(packed)) + packed + struct.pack("<I", len(data)) + data

    def fields_of(*pairs):
        return b"".join(struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value for name, value in pairs)

    conn = struct.pack("<I", 0)
    connection = record([("op", b"\7"), ("conn", conn), ("topic", topic.encode())],
                        fields_of(("topic", topic.encode()), ("type", kind.encode()), ("md5sum", b"*"),
                                  ("message_definition", b"")))
    time = struct.pack("<II", 50, 0)
    chunk = connection + record([("op", b"\2"), ("conn", conn), ("time", time)], message)
    magic = b"#ROSBAG V2.0\n"
    chunk_record = record([("op", b"\5"), ("compression", b"none"), ("size", struct.pack("<I", len(chunk)))], chunk)
    index = record([("op", b"\4"), ("ver", struct.pack("<I", 1)), ("conn", conn), ("count", struct.pack("<I", 1))],
                   time + struct.pack("<I", len(connection)))
    head = record([("op", b"\3"), ("index_pos", struct.pack("<Q", 0)), ("conn_count", struct.pack("<I", 1)),
                   ("chunk_count", struct.pack("<I", 1))], b" " * 64)
    after = len(magic) + len(head) + len(chunk_record) + len(index)
    head = head.replace(struct.pack("<Q", 0), struct.pack("<Q", after), 1)
    return magic + head + chunk_record + index + connection


def ros2_bag(topic, kind, message):
    database = sqlite3.connect(":memory:")
    database.execute("PRAGMA page_size=512")
    database.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
                     "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    database.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                     "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    database.execute("INSERT INTO topics VALUES(1, ?, ?, 'cdr', '')", (topic, kind))
    database.execute("INSERT INTO messages VALUES(1, 1, 50000000000, ?)", (message,))
    database.commit()
    folder = ROOT / ".scratch"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "bag.db3"
    file.unlink(missing_ok=True)
    database.execute("VACUUM INTO ?", (str(file),))
    data = file.read_bytes()
    file.unlink()
    folder.rmdir()
    return data


def zstd(data):
    """A frame of one block that is not compressed, of 256 to 65791 bytes."""
    head = b"\x28\xb5\x2f\xfd\x60" + struct.pack("<H", len(data) - 256)
    return head + struct.pack("<I", len(data) << 3 | 1)[:3] + data


def mcap(topic, kind, message, compression="", with_index=True, in_chunk=True, more=()):
    def text(value):
        return struct.pack("<I", len(value)) + value.encode()

    def record(kind_of_record, content):
        return struct.pack("<BQ", kind_of_record, len(content)) + content

    schema = record(3, struct.pack("<H", 1) + text(kind) + text("ros2msg") + text(""))
    channel = record(4, struct.pack("<HH", 1, 1) + text(topic) + text("cdr") + struct.pack("<I", 0))
    time = 50_000_000_000
    records = schema + channel + record(5, struct.pack("<HIQQ", 1, 0, time, time) + message)
    for number, (other_topic, other_kind, other) in enumerate(more, start=2):
        records += record(3, struct.pack("<H", number) + text(other_kind) + text("ros2msg") + text(""))
        records += record(4, struct.pack("<HH", number, number) + text(other_topic) + text("cdr") + struct.pack("<I", 0))
        records += record(5, struct.pack("<HIQQ", number, 0, time, time) + other)
    data = b"\x89MCAP0\r\n" + record(1, text("ros2") + text(""))
    if in_chunk:
        # The frame of lz4 has one block that is not compressed.
        packed = {"": records, "zstd": zstd(records),
                  "lz4": b"\x04\x22\x4d\x18\x60\x40\x82" + struct.pack("<I", 1 << 31 | len(records)) + records + bytes(4)
                  }[compression]
        data += record(6, struct.pack("<QQQI", time, time, len(records), zlib.crc32(records)) + text(compression) +
                       struct.pack("<Q", len(packed)) + packed)
        if with_index:
            data += record(7, struct.pack("<HIQQ", 1, 16, time, len(schema) + len(channel)))
    else:
        data += records
    data += record(15, struct.pack("<I", zlib.crc32(data)))
    start = len(data)
    if with_index:
        data += schema + channel + record(11, struct.pack("<QHIIIIQQI", 1, 1, 1, 0, 0, 1, time, time, 0))
    footer = struct.pack("<BQQQ", 2, 20, start if with_index else 0, 0)
    return data + footer + struct.pack("<I", zlib.crc32(data[start:] + footer)) + b"\x89MCAP0\r\n"


def gltf(buffer=None, **more):
    corners = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + struct.pack("<3H", 0, 1, 2)
    uri = buffer or "data:application/octet-stream;base64," + base64.b64encode(corners).decode()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0, 1, 2], "rotation": [0, 0, 0, 1], "scale": [1, 2, -1]}],
        "materials": [{"name": "floor"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0, "mode": 4}]}],
        "buffers": [{"byteLength": len(corners), "uri": uri}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    }
    document.update(more)
    return json.dumps(document), corners


def glb():
    text, corners = gltf()
    document = json.loads(text)
    del document["buffers"][0]["uri"]
    head = json.dumps(document).encode()
    head += b" " * (-len(head) % 4)
    corners += bytes(-len(corners) % 4)
    body = struct.pack("<I4s", len(head), b"JSON") + head + struct.pack("<I4s", len(corners), b"BIN\0") + corners
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def pickled(protocol, arrays):
    """A pickled dict from names to (shape, type, bytes), as NumPy has it with protocol 2, 4 or 5."""
    def text(value):
        raw = value.encode()
        return b"X" + struct.pack("<I", len(raw)) + raw if protocol == 2 else b"\x8c" + bytes([len(raw)]) + raw

    def function(module, name):
        return f"c{module}\n{name}\n".encode() if protocol == 2 else text(module) + text(name) + b"\x93"

    def raw_bytes(raw):
        if protocol == 2:
            return function("_codecs", "encode") + text(raw.decode("latin1")) + text("latin1") + b"\x86R"
        return b"B" + struct.pack("<I", len(raw)) + raw

    def array(shape, kind, raw):
        lengths = b"(" + b"".join(b"M" + struct.pack("<H", length) for length in shape) + b"t"
        dtype = (function("numpy", "dtype") + text(kind) + b"\x89\x88\x87R(K\x03" + text("<") + b"NNN" +
                 b"J\xff\xff\xff\xff" * 2 + b"K\0tb")
        if protocol == 5:
            return (function("numpy.core.numeric", "_frombuffer") + b"(\x96" + struct.pack("<Q", len(raw)) + raw +
                    dtype + lengths + text("C") + b"tR")
        return (function("numpy.core.multiarray", "_reconstruct") + function("numpy", "ndarray") + b"K\0\x85" +
                raw_bytes(b"b") + b"\x87R(K\x01" + lengths + dtype + b"\x89" + raw_bytes(raw) + b"tb")

    items = b"".join(text(name) + array(*value) for name, value in arrays.items())
    return b"\x80" + bytes([protocol]) + b"}(" + items + b"u."


def main():
    put("recording_file", "aris", aris(2))
    put("recording_file", "aris_cut_short", aris(2)[:-1])
    put("recording_file", "aris_empty_ping", aris(2, dark_ping=1))
    put("recording_file", "aris_unsorted", aris(2, sorted_by_beam=0))
    put("recording_file", "ddf3", ddf(3))
    put("recording_file", "ddf4", ddf(4))
    for version in (1, 2):
        put("recording_file", f"oculus{version}", oculus(version))
    put("recording_file", "oculus_gains_16_bits", oculus(2, bytes_per_sample=2, gains=True))
    put("recording_file", "oculus_two_pings", oculus(1) + oculus(1))
    put("recording_file", "oculus_log", oculus_log([(False, oculus(2)), (True, oculus(2))]))

    kind = "marine_acoustic_msgs/ProjectedSonarImage"
    put("recording_file", "ros1_bag", ros1_bag("/sonar", kind, projected_sonar_image(cdr=False)))
    for name, options in {"plain": {}, "lz4": {"compression": "lz4"}, "zstd": {"compression": "zstd"},
                          "no_index": {"with_index": False}, "no_chunk": {"in_chunk": False}}.items():
        data = mcap("/sonar", kind.replace("/", "/msg/"), projected_sonar_image(cdr=True), **options)
        put("mcap", name + ".mcap", data)
        put("recording_file", "mcap_" + name, data)
    put("recording_file", "mcap_oculus_ping", mcap(
        "/oculus", "oculus_interfaces/msg/Ping", oculus_interfaces_ping(bytes(range(20))), with_index=False))
    put("recording_file", "mcap_oculus_own_message", mcap(
        "/oculus", "oculus_interfaces/msg/Ping", oculus_interfaces_ping(oculus(2)), with_index=False))
    put("recording_file", "mcap_oculus_stamped_ping", mcap(
        "/oculus", "oculus_interfaces/msg/OculusStampedPing", oculus_stamped_ping(oculus(1)), with_index=False))
    put("recording_file", "mcap_sonar_info", mcap(
        "/sonar", kind.replace("/", "/msg/"), projected_sonar_image(cdr=True), with_index=False,
        more=[("/sonar_info", "marine_interfaces/msg/SonarInfo", sonar_info())]))
    put("mcap", "cut_off.mcap", data[:data.rindex(b"\x0f\x04")])
    bag = ros2_bag("/sonar", kind.replace("/", "/msg/"), projected_sonar_image(cdr=True))
    put("recording_file", "ros2_bag", bag)
    put("recording_file", "ros2_bag_zstd", zstd(bag))
    put("recording_file", "ros2_bag_zstd_messages",
        ros2_bag("/sonar", kind.replace("/", "/msg/"), zstd(projected_sonar_image(cdr=True, ranges=80))))

    sonar = {"name": "small", "frequency_hz": 9e5, "beam_azimuth_deg": [-1, 1], "range_min_m": 1, "range_max_m": 2,
             "range_bins": 3, "sound_speed_m_per_s": 1480}
    pose = {"position_m": [0, 0, 1], "quaternion_wxyz": [1, 0, 0, 0]}
    water = {"temperature_c": 15, "salinity_ppt": 0.5, "ph": 7, "depth_m": 1}
    put("recording_folder", "recording.json", json.dumps({
        "format": "sonar-recording/1", "sonar": sonar, "water": water, "source_level_db": 200,
        "image": {"layout": "polar", "bits": 8, "db_min": 0, "db_max": 80}, "synthetic": True,
        "frames": [{"file": "frame_0000.png", "time_s": 0.0, "world_from_sonar": pose}]}))
    put("didson_settings", "ping.json", json.dumps({
        "num_beams": 96, "num_bins": 512, "min_range": 2.25, "max_range": 11.25, "fov": 0.5, "psf": [0.01] * 96,
        "taper": [1.0] * 96, "noise": 1e-4, "rx_gain": 40}))

    put("picture", "grey8.png", png(3, 2, bytes(range(6))))
    put("picture", "grey16.png", png(3, 2, bytes(range(12)), bits=16))
    put("picture", "colour.png", png(2, 2, bytes(range(12)), colour=2))
    put("picture", "grey8.tiff", tiff(3, 2, 8, False))
    put("picture", "float.tiff", tiff(3, 2, 32, True))

    rows, cols = 30, 32

    def fan_pictures(*pictures, is_lossy=False):
        lit = [is_lit(x, y) for is_lit in pictures for y in range(rows) for x in range(cols)]
        first = rows - 1 + 64 * (len(pictures) == 4) + 128 * is_lossy
        return bytes([first, cols - 1]) + bytes(
            sum(bit << i for i, bit in enumerate(lit[start:start + 8])) for start in range(0, len(lit), 8))

    def in_fan(x, y):
        return abs(x - 16) * 7 < (rows - y) * 4 and (x - 16) ** 2 + (rows - y) ** 2 < 750

    def with_text(x, y):
        return in_fan(x, y) or y in (3, 9, 15) and x in (0, 1, 30, 31)

    put("fan_picture", "fan", fan_pictures(in_fan))
    put("fan_picture", "fan_with_losses", fan_pictures(in_fan, is_lossy=True))
    put("fan_picture", "fan_with_text", fan_pictures(with_text))
    put("fan_picture", "fan_with_text_that_stays", fan_pictures(
        *(lambda x, y, k=k: with_text(x, y) and (not in_fan(x, y) or (x + y) % 4 != k) for k in range(4))))
    put("fan_picture", "refused_triangle_on_its_base", fan_pictures(lambda x, y: abs(x - 16) * 2 < y))
    put("jpeg", "fan.jpg", JPEG)
    shown = {"format": "sonar-picture-geometry/1", "range_m": [0.69, 3], "name": "a sonar", "frequency_hz": 3e6,
             "sound_speed_m_per_s": 1480, "db_span": 80}
    put("picture_geometry", "found.json", json.dumps(shown))
    put("picture_geometry", "given.json", json.dumps(shown | {"fan": {
        "apex_px": [35, 60], "radius_px": [10, 55], "half_angle_deg": 29, "x_scale": 1.0, "beams": 12, "range_bins": 20}}))
    put("picture_geometry", "polar.json", json.dumps(shown | {"polar": {
        "azimuth_first_deg": -15, "azimuth_last_deg": 15, "nearest_row": "bottom"}}))

    put("gltf", "triangle.gltf", gltf()[0])
    put("gltf", "triangle.glb", glb())
    put("gltf", "refused_buffer_is_itself.gltf", gltf(buffer="scene.gltf")[0])
    put("gltf", "refused_buffer_outside.gltf", gltf(buffer="../../etc/passwd")[0])
    put("gltf", "refused_nodes_in_a_circle.gltf", gltf(nodes=[{"children": [1]}, {"children": [0], "mesh": 0}])[0])
    put("obj", "square.obj", "o square\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nusemtl floor\nf 1 2 3 4\nf -4//1 -3//1 -2//1\n")
    put("obj", "concave.obj", "v 0 0 0\nv 2 0 0\nv 1 0 0.5\nv 2 0 2\nv 0 0 2\nf 1/1 2/1 3/1 4/1 5/1\n")
    square = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)]
    vertex_head = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    face_head = "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    frame = {"PoseSensor": ((4, 4), "f4", struct.pack("<16f", 0, -1, 0, 1, 1, 0, 0, 2, 0, 0, 1, 3, 0, 0, 0, 1)),
             "ImagingSonar": ((3, 2), "u1", bytes(range(6)))}
    for protocol in (2, 4, 5):
        put("pickle", f"protocol_{protocol}.pkl", pickled(protocol, frame))
        put("neusis", f"protocol_{protocol}.pkl", pickled(protocol, frame))
    put("neusis", "floats.pkl", pickled(4, {"ImagingSonar": ((2, 2), "f8", struct.pack("<4d", 0, 0.5, 1, 2))}))
    put("pickle", "refused_call.pkl", b"cos\nsystem\n(Vtrue\ntR.")
    put("pickle", "refused_deep.pkl", b"N" + b"\x85" * 300 + b".")
    put("ply", "text.ply", "ply\nformat ascii 1.0\ncomment made by hand\n" + vertex_head + face_head +
        "".join(f"{x} {y} {z}\n" for x, y, z in square) + "4 0 1 2 3\n")
    for order, mark in (("little", "<"), ("big", ">")):
        put("ply", order + ".ply", f"ply\nformat binary_{order}_endian 1.0\n{vertex_head}{face_head}".encode() +
            b"".join(struct.pack(mark + "3f", *vertex) for vertex in square) + struct.pack(mark + "B4i", 4, 0, 1, 2, 3))
    put("stl", "text.stl", "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nendsolid s\n")
    put("stl", "binary.stl", bytes(80) + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, *range(9), 0))

    gsab = {"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}
    put("parameters", "paper.json", json.dumps({
        "format": "sonar-parameters/1", "model": "paper", "source_level_db": 200,
        "display": {"db_min": 80, "db_max": 190}, "materials": {"floor": {"gsab": gsab}},
        "jitter": {"sigma_range_m": 0.01, "sigma_azimuth_deg": 0.1, "growth": "root"}, "water": water}))
    put("parameters", "acoustic.json", json.dumps({
        "format": "sonar-parameters/1", "model": "acoustic", "source_level_db": 200,
        "display": {"db_min": 80, "db_max": 190, "law": "soft_log", "soft_db": 3},
        "materials": {"default": {"gsab": gsab}},
        "receiver": {"gain_db": 0, "time_varied_gain": "40logR+alpha", "noise_db": 94, "noise_taper_db": [0, 1], "looks": 1},
        "beam": {"azimuth_width_deg": 1, "azimuth_pattern": "table", "azimuth_table_db": [-20, 0, -20]},
        "pulse": {"length_m": 0.02}}))
    put("poses", "poses.json", json.dumps({
        "format": "sonar-poses/1", "poses": [{"time_s": 0.0, "world_from_sonar": pose}]}))
    put("poses", "list.json", json.dumps([{"world_from_sonar": pose}]))
    put("mount", "mount.json", json.dumps({"format": "sonar-mount/1", "body_from_sonar": pose}))
    put("marker_map", "map.json", json.dumps({
        "format": "sonar-markers/1", "dictionary": "DICT_4X4_50", "sigma": {"position_m": 0.002, "angle_deg": 0.5},
        "markers": [{"id": 3, "size_m": 0.15, "world_from_marker": pose}]}))
    put("camera", "opencv.yaml", """%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.5e+02, 0., 320., 0., 5.5e+02, 240., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ -0.1, 0.01, 0., 0., 0. ]
""")
    put("camera", "opencv.xml", """<?xml version="1.0"?>
<opencv_storage>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    550. 0. 320. 0. 550. 240. 0. 0. 1.</data></camera_matrix>
</opencv_storage>
""")
    put("trajectory", "tum.txt", "# time tx ty tz qx qy qz qw\n0 0 0 1 0 0 0 1\n0.5 1 0 1 0 0 0 1\n")
    put("trajectory", "euroc.csv", "#timestamp,x,y,z,qw,qx,qy,qz\n1403636579758555392,4.6,-1.7,0.5,1,0,0,0\n")
    put("trajectory", "named.csv", "time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n0,0,0,1,10,-5,0\n1,0,1,1,11,-5,0\n")
    put("bag_trajectory", "odometry.mcap", mcap("/odom", "nav_msgs/msg/Odometry", odometry(cdr=True), with_index=False))
    put("bag_trajectory", "pose.mcap", mcap("/odom", "geometry_msgs/msg/PoseStamped",
                                            pose_fields(Message(True).stamped()).done(), in_chunk=False))
    put("bag_trajectory", "transforms.mcap", mcap("/tf", "tf2_msgs/msg/TFMessage", transforms(cdr=True), with_index=False))
    put("bag_trajectory", "transforms.bag", ros1_bag("/tf", "tf2_msgs/TFMessage", transforms(cdr=False)))
    columns = ("FrameIndex,FrameTime,WindowStart,WindowLength,ReceiverGain,WaterTemp,PingMode,FrequencyHiLow,PulseWidth,"
               "SamplePeriod,FrameRate,SoundSpeed,SamplesPerBeam,SampleStartDelay,LargeLens,TheSystemType,Salinity\n")
    put("dfki_frames", "aris_frame_meta.csv",
        columns + "622,1695222665000000,0.7,0.02664,12,15.5,6,1,20,6,15.0,1480,6,1000,0,1,0\n")
    links = "".join(f"""  - frame_id: "setup/{child}"  # a comment
    parent_frame_id: "setup/{parent}"
    translation:
      x: 0.0
      y: 0.174
      z: -0.338
    rotation:
      x: 0.0
      y: 1.0
      z: 0.0
      w: 0.0
""" for parent, child in (("ar3", "aris"), ("aris", "sonar")))
    put("frame_tree", "transforms.yaml", "setup:\n" + links)
    put("comparison_part", "empty", bytes(308))  # a part without frames


if __name__ == "__main__":
    main()
