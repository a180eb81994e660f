#!/usr/bin/env python3
"""Checks that every property of the schemas in docs/ has a description, and validates JSON files
against them: check_schemas.py FILE..."""
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("SKIPPED: needs python3-jsonschema")
    sys.exit(77)

docs = pathlib.Path(__file__).parent.parent / "docs"


def undescribed(node, path=""):
    """Properties without a description, wherever they stand in a schema."""
    if isinstance(node, list):
        for index, item in enumerate(node):
            yield from undescribed(item, f"{path}/{index}")
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key == "properties" and isinstance(value, dict):
            for name, schema in value.items():
                if not schema.get("description", ""):
                    yield f"{path}/{name}"
        yield from undescribed(value, f"{path}/{key}")


bad = 0
for file in sorted(docs.glob("*.schema.json")):
    for place in undescribed(json.loads(file.read_text())):
        print(f"{file.name}: {place} has no description: what it is, its unit, when it is absent")
        bad = 1
for name in sys.argv[1:]:
    instance = json.loads(pathlib.Path(name).read_text())
    kind = instance["schema"].removeprefix("vpr.").rsplit("/", 1)[0]
    schema = json.loads((docs / f"{kind}.schema.json").read_text())
    for error in jsonschema.Draft202012Validator(schema).iter_errors(instance):
        print(f"{name}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
        bad = 1
sys.exit(bad)
