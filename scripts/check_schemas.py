#!/usr/bin/env python3
"""check_schemas.py [--format] [FILE...]: checks the schemas in docs/schemas/, and validates JSON files.

Every property has a description, every reference points to a definition, every definition is used,
and files have the format that --format writes."""
import json
import pathlib
import sys

folder = pathlib.Path(__file__).resolve().parent.parent / "docs/schemas"
# Properties that need no description.
SELF_EVIDENT = {"lower_quartile_ms", "upper_quartile_ms", "command_line", "correct", "incorrect", "ignored"}


def depth(node):
    if isinstance(node, dict):
        return 1 + max(map(depth, node.values()), default=0)
    return max(map(depth, node), default=0) if isinstance(node, list) else 0


def formatted(node, indent=0, column=0):
    """JSON with two spaces of indentation. Objects of up to two levels are on one line if they fit
    in 100 columns."""
    line = json.dumps(node, ensure_ascii=False)
    if not isinstance(node, (dict, list)) or depth(node) <= 2 and column + len(line) < 100:
        return line
    pad = "  " * (indent + 1)
    if isinstance(node, dict):
        keys = [f"{pad}{json.dumps(key)}: " for key in node]
        items = [key + formatted(value, indent + 1, len(key)) for key, value in zip(keys, node.values())]
    else:
        items = [pad + formatted(value, indent + 1, len(pad)) for value in node]
    ends = "{}" if isinstance(node, dict) else "[]"
    return ends[0] + "\n" + ",\n".join(items) + "\n" + "  " * indent + ends[1]


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


schemas = {file.name: json.loads(file.read_text()) for file in sorted(folder.glob("*.schema.json"))}
every_node = {(name, path): node for name, schema in schemas.items() for path, node in nodes(schema)}
if sys.argv[1:2] == ["--format"]:
    for name, schema in schemas.items():
        (folder / name).write_text(formatted(schema) + "\n")
    sys.exit()

bad = 0


def complain(text):
    global bad
    bad = 1
    print(text)


used = set()
for (name, path), node in every_node.items():
    if isinstance(node.get("$ref"), str):
        place = target(name, node["$ref"])
        used.add(place)
        if place not in every_node:
            complain(f"{name}: {path}: {node['$ref']} is not defined")
    if not path.endswith("/properties") or path.count("/properties/properties"):
        continue
    for key, schema in node.items():
        described = schema.get("description") or "const" in schema or key in SELF_EVIDENT
        refinement = "$ref" in every_node[name, path.removesuffix("/properties")]
        if "$ref" in schema:
            described = described or every_node.get(target(name, schema["$ref"]), {}).get("description")
        if not described and not (refinement and set(schema) <= {"required", "not"}) and "/if" not in path:
            complain(f"{name}: {path}/{key} has no description: what it is, its unit, when it is absent")
for name, path in every_node:
    if path.startswith("/$defs/") and path.count("/") == 2 and (name, path) not in used:
        complain(f"{name}: {path} is not used")
for name, schema in schemas.items():
    if (folder / name).read_text() != formatted(schema) + "\n":
        complain(f"{name} is not formatted: run scripts/check_schemas.py --format")

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


definitions = {name: inlined(schema, name) for name, schema in schemas.items()}
for file in sys.argv[1:]:
    instance = json.loads(pathlib.Path(file).read_text())
    kind = instance["schema"].removeprefix("vpr.").rsplit("/", 1)[0]
    schema = {"$defs": definitions, "$ref": f"#/$defs/{kind}.schema.json"}
    for error in jsonschema.Draft202012Validator(schema).iter_errors(instance):
        complain(f"{file}: {'/'.join(map(str, error.path))}: {error.message[:200]}")
sys.exit(bad)
