"""Common functions of the tests of programs and scripts.   NAME.py SOURCE BIN"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

source, programs = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
temporary = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
folder = pathlib.Path(temporary.name)
sys.dont_write_bytecode = True

sys.path.append(str(source / "test"))
import served  # noqa: E402

served_programs = served.Served(programs)


def call(*words, **more):
    """Runs one of our programs, or another one, in the folder."""
    ours = str(words[0]).startswith("vpr-")
    if ours and not more.keys() - {"cwd"}:
        return served_programs.call(words, more.get("cwd", folder))
    program = programs / words[0] if ours else words[0]
    return subprocess.run([program, *map(str, words[1:])], **{"cwd": folder, "text": True, "capture_output": True, **more})


def refused(code, part, *words):
    done = call(*words)
    text = " ".join(done.stderr.split())
    assert done.returncode == code and part in text, (words, done.returncode, done.stderr)
    assert len(done.stderr) < 1000, len(done.stderr)


def ok(done):
    assert done.returncode == 0, (done.args, done.returncode, done.stdout[-2000:], done.stderr[-4000:])
    return done


def run(*words, **more):
    """The output of a program, which must succeed."""
    return ok(call(*words, **more)).stdout


def read_json(name):
    return json.loads((folder / name).read_text())


def write(name, content):
    """Writes a text, or the JSON of anything else. Returns the name."""
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(content if isinstance(content, str) else json.dumps(content))
    return name


def stub(path, script):
    """An executable script of a shell, in place of a program."""
    path.write_text(f"#!/bin/bash\n{script}\n")
    path.chmod(0o755)


def with_path(first, **more):
    """The environment, in which programs of the folder `first` precede others."""
    return {**os.environ, "PATH": f"{first}:{os.environ['PATH']}", **more}


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)
