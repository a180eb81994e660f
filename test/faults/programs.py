"""Runs programs with a fault at one of their file calls."""
import dataclasses
import os
import pathlib
import re
import struct
import subprocess

# In the order of faults.h.
FAULTS = ["none", "kill", "torn", "interrupt", "eintr", "eio", "dead", "enospc", "shorten",
          "power", "power_off"]


@dataclasses.dataclass(frozen=True)
class Call:
    name: str
    failed: bool
    path: str

    def __str__(self):
        return re.sub(r"(partial-)\w+-\w+", r"\1*", f"{self.name} {self.path}".strip())


@dataclasses.dataclass(frozen=True)
class Run:
    status: int  # exit code; below 0: the signal that ended it
    stdout: str
    stderr: str
    calls: list


def parse_calls(text):
    return [Call(name, mark == "!", path)
            for name, mark, path in re.findall(r"^(\w+)([ !])(.*)$", text, re.MULTILINE)]


class Programs:
    """The programs of a build, each loaded once."""

    def __init__(self, binaries, shim):
        self.binaries = pathlib.Path(binaries)
        self.environment = {**os.environ, "LD_PRELOAD": str(shim), "VPR_FAULTS": "1",
                            "LD_BIND_NOW": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.servers = {}

    def server(self, program):
        if program not in self.servers:
            self.servers[program] = subprocess.Popen(
                [self.binaries / program], env=self.environment, stdin=subprocess.PIPE,
                stdout=subprocess.PIPE)
        return self.servers[program]

    def run(self, line, folder, fault="none", number=0, plain=False):
        """Runs a command line in `folder`; among the calls below folder/out, call `number` (from 1)
        has the fault. `plain`: renames have no flags."""
        words = [*line.split(), "--threads", "1"]
        texts = [folder, "out", FAULTS.index(fault), number, int(plain), *words]
        request = b"".join(str(text).encode() + b"\0" for text in texts)
        server = self.server(words[0])
        server.stdin.write(struct.pack("=I", len(request)) + request)
        server.stdin.flush()
        status, size = struct.unpack("=iI", server.stdout.read(8))
        notes = server.stdout.read(size).decode(errors="replace")
        text = [(pathlib.Path(folder) / name).read_text(errors="replace")
                for name in ("stdout", "stderr")]
        return Run(os.waitstatus_to_exitcode(status), *text, parse_calls(notes))

    def close(self):
        for server in self.servers.values():
            server.stdin.close()
            server.wait()
            server.stdout.close()
