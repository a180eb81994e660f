"""Arguments, errors and outputs of the converters. Exit codes are those of the programs."""
import argparse
import os
import pathlib
import sys
import tempfile

USAGE, FILES, DATA = 2, 3, 4


class Refusal(Exception):
    """An error message of one sentence, and the exit code."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def parser(description, source, output):
    """An argument parser with a source, -o and --force; `description` is the script's docstring."""
    found = argparse.ArgumentParser(description=description,
                                    formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("source", type=pathlib.Path, metavar=source)
    found.add_argument("-o", "--output", type=pathlib.Path, metavar=output, required=True)
    found.add_argument("--force", action="store_true", help="replace an existing output")
    return found


def need(module, package):
    """Import a module of a Debian package."""
    try:
        return __import__(module, fromlist=["*"])
    except ModuleNotFoundError:
        print(f"{pathlib.Path(sys.argv[0]).name}: needs {package}: apt-get install {package}", file=sys.stderr)
        sys.exit(USAGE)


def write(arguments, content):
    """Write bytes or text to the output under a temporary name, then rename it."""
    if isinstance(content, str):
        content = content.encode()
    folder = arguments.output.absolute().parent
    handle, partial = tempfile.mkstemp(prefix=".vpr-partial-", dir=folder)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            os.fsync(file.fileno())
        os.chmod(partial, 0o644)
        os.replace(partial, arguments.output)
    except BaseException:
        os.unlink(partial)
        raise


def run(arguments, convert):
    """Call convert(arguments); on failure, print one sentence and exit with its code."""
    script = pathlib.Path(sys.argv[0]).name
    try:
        if arguments.output.exists() and not arguments.force:
            raise Refusal(USAGE, f"{arguments.output} exists; use --force to replace it")
        if arguments.output.exists() and arguments.output.samefile(arguments.source):
            raise Refusal(USAGE, f"{arguments.output} is the source; choose another output")
        convert(arguments)
    except Refusal as refusal:
        print(f"{script}: {refusal}", file=sys.stderr)
        sys.exit(refusal.code)
    except OSError as error:
        print(f"{script}: {error.filename or arguments.source}: {error.strerror or error}",
              file=sys.stderr)
        sys.exit(FILES)
    except MemoryError:
        print(f"{script}: {arguments.source}: does not fit in memory", file=sys.stderr)
        sys.exit(FILES)
