#!/usr/bin/env python3
"""Validates JSON files against the schemas in docs/: check_schemas.py FILE..."""
import json
import pathlib
import sys

try:
    import jsonschema
except ImportError:
    print("SKIPPED: needs python3-jsonschema")
    sys.exit(77)

docs = pathlib.Path(__file__).parent.parent / "docs"
bad = 0
for name in sys.argv[1:]:
    instance = json.loads(pathlib.Path(name).read_text())
    kind = instance["schema"].removeprefix("vpr.").removesuffix("/1")
    schema = json.loads((docs / f"{kind}.schema.json").read_text())
    for error in jsonschema.Draft202012Validator(schema).iter_errors(instance):
        print(f"{name}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
        bad = 1
sys.exit(bad)
