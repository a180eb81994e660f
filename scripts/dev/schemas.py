#!/usr/bin/env python3
"""Writes docs/schemas/*.schema.json from docs/schemas/*.txt.

A line "KEY: TYPE  DESCRIPTION" is a key of the object above it, by indentation; "KEY?" may be missing.
"schema KIND/VERSION  TITLE" and "define NAME: TYPE  DESCRIPTION" start at the margin. Definitions below
a schema belong to it; the others are common.

  string number integer count bool object null   count: an integer from 0 on
  number>=0<=1 number>0 string~PATTERN           bounds
  A|B    A or B                                  any of these types; "|" for simple ones
  'a'|'b'    =0                                  one of these strings; this value
  [A] [A]*2 [A]*1.. [A]*0..5 [A]!                a list; its length; without repetitions
  {A} {~PATTERN: A} {A}*1..                      an object with any keys; keys of this pattern; how many
  {} {+}                                         an object with the keys below; other keys as well
  @NAME @A+@B @NAME{} @NAME{+}                   definitions, extended by the keys below

"+ JSON" adds to the schema of the object, "include NAME" the lines of a definition or of "lines NAME". "settings NAME" defines
settings, each of which may be missing; in @stored_NAME none is, except for "KEY?"."""
import json
import pathlib
import re

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs/schemas"
NAMES = {"string": {"type": "string"}, "number": {"type": "number"}, "integer": {"type": "integer"},
         "count": {"type": "integer", "minimum": 0}, "bool": {"type": "boolean"},
         "object": {"type": "object"}, "null": {"type": "null"}}
BOUNDS = {">=": "minimum", "<=": "maximum", ">": "exclusiveMinimum"}


class Type:
    """The schema of a type. `block` has the keys below it; `refer` returns the reference to a definition."""

    def __init__(self, text, block, refer):
        self.text, self.at, self.block, self.refer = text, 0, block, refer
        self.schema = self.any_of()
        if self.at != len(text) or self.block:
            raise ValueError(f"{text}: cannot read {text[self.at:] or self.block}")

    def accept(self, pattern):
        found = re.compile(pattern).match(self.text, self.at)
        if found:
            self.at = found.end()
        return found

    def keys_below(self):
        block, self.block = self.block, {}
        return block

    def size(self, unit):
        found = self.accept(r"\*(\d+)(\.\.(\d*))?")
        if not found:
            return {}
        least, most = found[1], found[3] if found[2] else found[1]
        return ({f"min{unit}": int(least)} if least != "0" else {}) | ({f"max{unit}": int(most)} if most else {})

    def any_of(self):
        parts = [self.union()]
        while self.accept(" or "):
            parts.append(self.union())
        return parts[0] if len(parts) == 1 else {"anyOf": parts}

    def union(self):
        parts = [self.one()]
        while self.accept(r"\|"):
            parts.append(self.one())
        if len(parts) == 1:
            return parts[0]
        if all("const" in part for part in parts):
            return {"enum": [part["const"] for part in parts]}
        merged = {key: value for part in parts for key, value in part.items()}
        return merged | {"type": [part["type"] for part in parts]}

    def one(self):
        if found := self.accept(r"'([^']*)'"):
            return {"const": found[1]}
        if found := self.accept(r"=(\w+)"):
            return {"const": json.loads(found[1])}
        if self.accept(r"\["):
            schema = {"type": "array", "items": self.any_of()}
            self.accept(r"\]")
            return schema | self.size("Items") | ({"uniqueItems": True} if self.accept("!") else {})
        if found := self.accept(r"\{(\+?)\}"):
            closed = {} if found[1] else {"additionalProperties": False}
            return {"type": "object"} | self.keys_below() | closed | self.size("Properties")
        if found := self.accept(r"\{(~(\S+): )?"):
            values = self.any_of()
            self.accept(r"\}")
            keys = {"patternProperties": {found[2]: values}, "additionalProperties": False}
            return {"type": "object"} | (keys if found[1] else {"additionalProperties": values}) | \
                self.keys_below() | self.size("Properties")
        if found := self.accept(r"@\w+(\+@\w+)*"):
            names = [{"$ref": self.refer(name)} for name in found[0].replace("@", "").split("+")]
            schema = names[0] if len(names) == 1 else {"allOf": names}
            if extended := self.accept(r"\{(\+?)\}"):
                schema |= self.keys_below() | ({} if extended[1] else {"unevaluatedProperties": False})
            return schema
        schema = dict(NAMES[self.accept(r"[a-z]*")[0]])
        while found := self.accept(r"(>=|<=|>)(-?[0-9.]+)"):
            schema[BOUNDS[found[1]]] = json.loads(found[2])
        if found := self.accept(r"~(\S+?)(?=\]*$)"):
            schema["pattern"] = found[1]
        return schema


def tree(lines):
    """Lines as a list of (line, lines below), by their indentation."""
    roots, stack = [], []
    for line in filter(str.strip, lines):
        node = (line.strip(), [])
        del stack[(len(line) - len(line.lstrip())) // 2:]
        (stack[-1][1] if stack else roots).append(node)
        stack.append(node)
    return roots


def keys_of(lines):
    """The keys of an object: name, whether it may be missing, type and description, lines below."""
    for line, below in lines:
        if found := re.fullmatch(r"(\S+?)(\?)?: (.*)", line):
            yield found[1], bool(found[2]), found[3], below


class Definitions:
    """Definitions of one schema, or common ones."""

    def __init__(self, common=None):
        self.lines = {}
        self.fragments = {}  # of objects, for include
        self.common = common

    def refer(self, name):
        if name in self.lines or self.common is None:
            return f"#/$defs/{name}"
        return f"common.schema.json#/$defs/{name}"

    def included(self, name):
        if name in self.fragments:
            return self.fragments[name]
        return self.lines[name][1] if name in self.lines else self.common.included(name)

    def block(self, lines):
        """The schema of the keys of an object."""
        lines = [line for one in lines
                 for line in (self.included(one[0][8:]) if one[0].startswith("include ") else [one])]
        keys = list(keys_of(lines))
        block = {"properties": {key: self.schema(text, below) for key, _, text, below in keys}} if keys else {}
        block |= {"required": [key for key, is_optional, _, _ in keys if not is_optional]}
        for line, _ in lines:
            if line.startswith("+ "):
                more = json.loads(line[2:])
                block |= more | {"required": block["required"] + more.get("required", [])}
        return {key: value for key, value in block.items() if value}

    def schema(self, text, lines):
        kind, _, description = text.partition("  ")
        schema = Type(kind, self.block(lines), self.refer).schema
        return ({"description": description} if description else {}) | schema

    def all(self):
        return {name: self.schema(text, lines) for name, (text, lines) in self.lines.items()}


def stored(name, settings):
    """Settings in a file: all keys are present, each with the value that was used."""
    required = {key: [inner for inner, is_optional, _, _ in keys_of(lines) if not is_optional]
                for key, lines in settings.items()}
    properties = {}
    for key, _, text, _ in keys_of(settings[name]):
        kind = text.partition("  ")[0]
        if kind[1:] in settings:
            properties[key] = {"required": required[kind[1:]]}
        elif kind.endswith("|'auto'"):
            properties[key] = {"not": {"const": "auto"}}
    schema = {"$ref": f"#/$defs/{name}"} | ({"properties": properties} if properties else {})
    for line, _ in settings[name]:
        if line.startswith("stored + "):
            schema |= json.loads(line.removeprefix("stored + "))
    return schema | {"required": required[name], "unevaluatedProperties": False}


def generated():
    """All schemas, by file name."""
    common, settings, schemas = Definitions(), {}, {}
    roots = [(path, root) for path in sorted(FOLDER.glob("*.txt")) for root in tree(path.read_text().splitlines())]
    kinds, path_of_own, own = [], None, common
    for path, (line, lines) in roots:
        word, name, text = re.fullmatch(r"(\w+) ([\w/-]+):?(.*)", line).groups()
        if path != path_of_own:
            own = common
        if word == "schema":
            path_of_own, own = path, Definitions(common)
            kinds.append((name, text, lines, own))
        elif word == "lines":
            own.fragments[name] = lines
        elif word == "settings":
            settings[name] = common.fragments[name] = lines
            optional = [(re.sub(r"^(\w+)\??: ", r"\1?: ", inner), below) for inner, below in lines]
            common.lines[name] = (text[1:], optional)
        else:
            own.lines[name] = (text[1:], lines)
    start = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    for name, text, lines, own in kinds:
        kind, _, title = text.partition("  ")
        if kind:
            schema = own.schema(kind[1:], lines)
        else:
            own_key = (f"schema: 'vpr.{name}'  Kind and version of the file.", [])
            schema = own.schema("{}", [own_key, *lines])
        definitions = {"$defs": own.all()} if own.lines else {}
        schemas[f"{name.partition('/')[0]}.schema.json"] = start | {"title": title} | schema | definitions
    definitions = common.all()
    text = json.dumps([schemas, definitions])
    for name in settings:
        if f"/stored_{name}\"" in text:
            definitions[f"stored_{name}"] = stored(name, settings)
    return schemas | {"common.schema.json": start | {"title": "Definitions of several schemas", "$defs": definitions}}


def depth(node):
    children = node.values() if isinstance(node, dict) else node if isinstance(node, list) else []
    return 1 + max(map(depth, children), default=0) if isinstance(node, (dict, list)) else 0


def formatted(node, indent=0):
    """JSON with two spaces of indentation. Objects of up to two levels are on one line."""
    if depth(node) <= 2:
        return json.dumps(node, ensure_ascii=False)
    pad = "  " * (indent + 1)
    if isinstance(node, dict):
        items = [f"{pad}{json.dumps(key)}: {formatted(value, indent + 1)}" for key, value in node.items()]
    else:
        items = [pad + formatted(value, indent + 1) for value in node]
    ends = "{}" if isinstance(node, dict) else "[]"
    return ends[0] + "\n" + ",\n".join(items) + "\n" + "  " * indent + ends[1]


if __name__ == "__main__":
    for name, schema in generated().items():
        (FOLDER / name).write_text(formatted(schema) + "\n")
