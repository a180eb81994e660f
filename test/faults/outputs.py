"""The contents of a folder of outputs, in a form that is equal for two runs of one command."""
import hashlib
import json
import os
import pathlib
import re
import shutil

HIDDEN = (".vpr-partial-", ".vpr-old")  # names that only temporaries have


def without_numbers(value):
    if isinstance(value, dict):
        return {key: without_numbers(item) for key, item in value.items()}
    if isinstance(value, list):
        return [without_numbers(item) for item in value]
    return 0 if isinstance(value, (int, float)) else value


def normal(path, content, has_times):
    """Removes times, machines and paths from JSON, and times from images. Incomplete JSON does not
    change, and differs from all others."""
    if path.endswith(".json"):
        try:
            value = json.loads(content)
        except ValueError:
            return content
        frames = value.get("settings", {}).get("frames")  # differs between the old and the new benchmark
        for key in ("machine", "timing"):
            value.pop(key, None)
        return json.dumps([without_numbers(value), frames] if has_times else value).encode()
    if has_times and content.endswith((b"</svg>\n", b"IEND\xaeB`\x82")):
        return re.sub(rb"\d+", b"0", content)
    return content


def snapshot(folder, has_times=False):
    """Output below a folder (a file or a whole folder in it) -> checksum of its content, and the
    names of temporaries."""
    outputs, hidden = {}, []
    for entry in sorted(os.listdir(folder)):
        path = os.path.join(folder, entry)
        if entry.startswith(HIDDEN):
            hidden.append(entry)
            continue
        parts = {}
        if os.path.isdir(path):
            for root, _, files in os.walk(path):
                for file in files:
                    name = os.path.join(root, file)
                    parts[os.path.relpath(name, path)] = pathlib.Path(name).read_bytes()
        else:
            parts[""] = pathlib.Path(path).read_bytes()
        sums = [(name, hashlib.sha256(normal(entry + name, content, has_times)).hexdigest())
                for name, content in sorted(parts.items())]
        outputs[entry] = hashlib.sha256(repr(sums).encode()).hexdigest()[:16]
    return outputs, hidden


def clear(folder, keep_hidden=False):
    for entry in os.scandir(folder):
        if keep_hidden and entry.name.startswith(HIDDEN):
            continue
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path)
        else:
            os.unlink(entry.path)


def fill(folder, saved):
    shutil.copytree(saved, folder, dirs_exist_ok=True)
