"""A bag of ROS 1 as rosbag's own Python library reads it, by the definitions that the bag itself holds, as JSON.

    read_bag.py FILE
"""

import json
import sys

import genpy.dynamic
import rosbag


def plain(value):
    """A message as lists, dictionaries and numbers."""
    if hasattr(value, "__slots__") and hasattr(value, "_type"):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if hasattr(value, "secs"):
        return [value.secs, value.nsecs]
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, (list, tuple)):
        return [plain(member) for member in value]
    return value


with rosbag.Bag(sys.argv[1]) as bag:
    messages = [
        {"topic": topic, "type": message._type, "logged": [time.secs, time.nsecs], "message": plain(message)}
        for topic, message, time in bag.read_messages()
    ]
    # The MD5 that the bag says, and the one that the definitions in it make.
    sums = {}
    for connection in bag._get_connections():
        types = genpy.dynamic.generate_dynamic(connection.datatype, connection.msg_def)
        sums[connection.topic] = [connection.md5sum, types[connection.datatype]._md5sum]
    json.dump({"messages": messages, "md5": sums}, sys.stdout)
