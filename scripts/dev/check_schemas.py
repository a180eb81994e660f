#!/usr/bin/env python3
"""check_schemas.py [FILE...]: checks the schemas in docs/schemas/, and validates JSON files.

Schemas are those of the .txt files, every key has a description, every reference points to a definition, and
every definition is used."""
import json
import pathlib
import sys

import schemas

# Keys that need no description.
SELF_EVIDENT = {"lower_quartile_ms", "upper_quartile_ms", "command_line", "correct", "incorrect", "ignored"}


def nodes(node, path=""):
    """All objects and their paths."""
    if isinstance(node, dict):
        yield path, node
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        if isinstance(value, (dict, list)):
            yield from nodes(value, f"{path}/{key}")


def target(file, reference):
    """Name of the file and path of a definition."""
    name, path = reference.split("#")
    return name or file, path


every = schemas.generated()
every_node = {(name, path): node for name, schema in every.items() for path, node in nodes(schema)}
bad = 0


def complain(text):
    global bad
    bad = 1
    print(text)


for name in sorted({file.name for file in schemas.FOLDER.glob("*.json")} | set(every)):
    file = schemas.FOLDER / name
    if name not in every or not file.exists() or file.read_text() != schemas.formatted(every[name]) + "\n":
        complain(f"{name} differs from the .txt files: run scripts/generate.sh")
used = set()
for (name, path), node in every_node.items():
    if isinstance(node.get("$ref"), str):
        place = target(name, node["$ref"])
        used.add(place)
        if place not in every_node:
            complain(f"{name}: {path}: {node['$ref']} is not defined")
    if not path.endswith("/properties") or path.startswith("/$defs/stored_"):
        continue
    for key, schema in node.items():
        described = schema.get("description") or "const" in schema or key in SELF_EVIDENT
        if not described and "$ref" in schema:
            described = every_node.get(target(name, schema["$ref"]), {}).get("description")
        if not described and "/if" not in path:
            complain(f"{name}: {path}/{key} has no description: what it is, its unit, when it is absent")
for name, path in every_node:
    if path.startswith("/$defs/") and path.count("/") == 2 and (name, path) not in used:
        complain(f"{name}: {path} is not used")

if len(sys.argv) > 1:
    try:
        import jsonschema
    except ImportError:
        print("SKIPPED: needs python3-jsonschema")
        sys.exit(bad or 77)


def inlined(node, file):
    """A schema with the definitions of all files, to which its references point."""
    if isinstance(node, list):
        return [inlined(item, file) for item in node]
    if not isinstance(node, dict):
        return node
    node = {key: inlined(value, file) for key, value in node.items()}
    if isinstance(node.get("$ref"), str):
        name, path = target(file, node["$ref"])
        node["$ref"] = f"#/$defs/{name}{path}"
    return node


definitions = {name: inlined(schema, name) for name, schema in every.items()}
for file in sys.argv[1:]:
    instance = json.loads(pathlib.Path(file).read_text())
    kind = instance["schema"].removeprefix("vpr.").rsplit("/", 1)[0]
    schema = {"$defs": definitions, "$ref": f"#/$defs/{kind}.schema.json"}
    for error in jsonschema.Draft202012Validator(schema).iter_errors(instance):
        complain(f"{file}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
sys.exit(bad)
