"""Decodes and encodes messages with rclpy. Each line of the input is a type and the message bytes in hexadecimal. For
each, prints the field values and the bytes that rclpy serializes."""

import importlib
import json
import math
import sys

from rclpy.serialization import deserialize_message, serialize_message


def plain(value):
    if hasattr(value, "get_fields_and_field_types"):
        names = value.get_fields_and_field_types()
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, bytes):
        return value[0]
    if isinstance(value, (bool, str)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if hasattr(value, "__iter__"):
        return [plain(part) for part in value]
    return int(value) if float(value).is_integer() and not hasattr(value, "dtype") else float(value)


for line in sys.stdin:
    name, digits = line.split()
    package, kind, type_name = name.split("/")
    type_ = importlib.import_module(f"{package}.{kind}")
    for part in type_name.split("_"):
        type_ = getattr(type_, part)
    message = deserialize_message(bytes.fromhex(digits), type_)
    print(json.dumps({"values": plain(message), "bytes": serialize_message(message).hex()}))
