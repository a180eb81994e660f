#!/usr/bin/env python3
"""check_schemas.py [FILE...]: checks the schemas in docs/schemas/, and validates JSON files.

Every key has a description, and every reference points to a definition. That schemas fit the fields of structs
is a test (test/cli/schemas_test.cpp)."""
import json
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/schemas"


def nodes(node, path=""):
    """All objects and their paths."""
    if isinstance(node, dict):
        yield path, node
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        if isinstance(value, (dict, list)):
            yield from nodes(value, f"{path}/{key}")


schemas = {file.name.removesuffix(".schema.json"): json.loads(file.read_text()) for file in FOLDER.glob("*.json")}
bad = 0


def complain(text):
    global bad
    bad = 1
    print(text)


for kind, whole in schemas.items():
    every = dict(nodes(whole))
    used = {node["$ref"].removeprefix("#") for node in every.values() if isinstance(node.get("$ref"), str)}
    defined = {path for path in every if path.startswith("/$defs/") and path.count("/") == 2}
    for path in used ^ defined:
        complain(f"{kind}: {path} is {'not defined' if path in used else 'not used'}")
    for path, node in every.items():
        for key, schema in node.items() if path.endswith("/properties") else ():
            if not {"description", "const"} & set(schema):
                complain(f"{kind}: {path}/{key} has no description: what it is, its unit, when it is absent")

if len(sys.argv) > 1:
    try:
        import jsonschema
    except ImportError:
        print("SKIPPED: needs python3-jsonschema")
        sys.exit(bad or 77)
for file in sys.argv[1:]:
    instance = json.loads(pathlib.Path(file).read_text())
    kind = instance["schema"].removeprefix("vpr.").rsplit("/", 1)[0]
    for error in jsonschema.Draft202012Validator(schemas[kind]).iter_errors(instance):
        complain(f"{file}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
sys.exit(bad)
