"""Programs that are loaded once and run their main in a child per run (faults/server.cpp): loading
their libraries takes most of the time of a short run."""
import os
import pathlib
import struct
import subprocess
import tempfile


class Served:
    def __init__(self, binaries):
        self.binaries = pathlib.Path(binaries).resolve()
        self.library = self.binaries / "vpr_faults.so"
        self.servers = {}

    def server(self, program):
        if program not in self.servers:
            environment = {**os.environ, "LD_PRELOAD": str(self.library), "VPR_SERVED": "1",
                           "LD_BIND_NOW": "1", "OPENBLAS_NUM_THREADS": "1"}
            self.servers[program] = subprocess.Popen([self.binaries / program], env=environment,
                                                     stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        return self.servers[program]

    def run(self, words, folder, stdout="stdout", stderr="stderr", fault=("", 0, 0, 0)):
        """The exit code (below 0: the signal that ended it) and the notes of the calls that count.
        `words`: program and arguments. `stdout`, `stderr`: files, relative to the folder."""
        texts = [folder, stdout, stderr, *fault, self.binaries / words[0], *words[1:]]
        request = b"".join(os.fsencode(str(text)) + b"\0" for text in texts)
        server = self.server(words[0])
        server.stdin.write(struct.pack("=I", len(request)) + request)
        server.stdin.flush()
        status, size = struct.unpack("=iI", server.stdout.read(8))
        return os.waitstatus_to_exitcode(status), server.stdout.read(size).decode(errors="replace")

    def call(self, words, folder):
        """The result of subprocess.run, with its output as text."""
        if not self.library.exists():
            return subprocess.run([self.binaries / words[0], *map(str, words[1:])], cwd=folder, text=True,
                                  capture_output=True)
        with tempfile.TemporaryDirectory() as printed:
            texts = [pathlib.Path(printed) / name for name in ("stdout", "stderr")]
            status, _ = self.run(words, folder, *texts)
            return subprocess.CompletedProcess(words, status, *(text.read_text() for text in texts))

    def close(self):
        for server in self.servers.values():
            server.stdin.close()
            server.wait()
            server.stdout.close()
