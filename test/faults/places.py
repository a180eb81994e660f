"""The place of a case: a plain folder, a small disk, or a disk that loses power."""
import contextlib
import ctypes
import fcntl
import os
import pathlib
import shutil
import struct
import subprocess
import time

import outputs

SHUT_DOWN = 0x8004587D  # FS_IOC_SHUTDOWN
KEEP_LOG, LOSE_LOG = 1, 2  # flush or lose the journal's log
PAGE = 4096
IMAGE_BYTES = 16 << 20
MUCH = 64 << 20  # bytes of a disk that is not full
REMOUNT = 32  # MS_REMOUNT
libc = ctypes.CDLL(None, use_errno=True)


def check(done, path):
    if done != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()), str(path))


def mount_memory(folder, size, flags=0):
    folder = str(folder)
    check(libc.mount(b"none", folder.encode(), b"tmpfs", flags, f"size={size}".encode()), folder)


def unmount(folder):
    """Retries for some seconds: a process that another worker has just forked may still have files open
    there until it runs its program."""
    for _ in range(500):
        if libc.umount2(str(folder).encode(), 0) == 0:
            return
        time.sleep(0.01)
    check(-1, folder)


def pages_of(folder):
    """Pages used by the files in a folder."""
    return sum(-(-os.path.getsize(os.path.join(root, name)) // PAGE)
               for root, _, names in os.walk(folder) for name in names)


class Folder:
    """`out` in a working folder."""

    def __init__(self, work):
        self.work = pathlib.Path(work)
        self.out = self.work / "out"
        self.out.mkdir(exist_ok=True)

    @contextlib.contextmanager
    def case(self, old, fault, number):
        """A context in which `out` holds the old outputs."""
        outputs.clear(self.out)
        outputs.fill(self.out, old)
        yield

    def after_run(self, fault, number, run):
        """Called between the program's end and the check of its outputs."""


class SmallDisk(Folder):
    """`out` is a file system with room for `number` pages in addition to the old outputs."""

    @contextlib.contextmanager
    def case(self, old, fault, number):
        mount_memory(self.out, (pages_of(old) + number) * PAGE)
        try:
            outputs.fill(self.out, old)
            yield
        finally:
            unmount(self.out)

    def after_run(self, fault, number, run):
        mount_memory(self.out, MUCH, REMOUNT)


class FailingDisk(Folder):
    """`out` is a separate file system in a file, whose computer loses power."""

    def __init__(self, work):
        super().__init__(work)
        self.empty = self.work / "empty.img"
        self.image = self.work / "disk.img"
        with open(self.empty, "wb") as file:
            file.truncate(IMAGE_BYTES)
        subprocess.run(["mkfs.ext4", "-q", "-F", "-m", "0", "-O", "^resize_inode", self.empty],
                       check=True)

    def mount(self):
        subprocess.run(["mount", "-o", "loop", self.image, self.out], check=True)

    @contextlib.contextmanager
    def case(self, old, fault, number):
        shutil.copyfile(self.empty, self.image)
        self.mount()
        try:
            (self.out / "lost+found").rmdir()
            outputs.fill(self.out, old)
            os.sync()
            yield
        finally:
            unmount(self.out)

    def after_run(self, fault, number, run):
        """The disk goes down, if it has not yet, and comes back."""
        folder = os.open(self.out, os.O_RDONLY)
        how = LOSE_LOG if fault == "power_off" else KEEP_LOG
        with contextlib.suppress(OSError):
            fcntl.ioctl(folder, SHUT_DOWN, struct.pack("=I", how))
        os.close(folder)
        unmount(self.out)
        self.mount()


def why_not(kind, work):
    """The reason why this kind of place is not available, or None."""
    try:
        place = PLACES[kind](work)
        old = pathlib.Path(work) / "nothing"
        old.mkdir(exist_ok=True)
        with place.case(old, "power", 64):
            place.after_run("power", 64, None)
    except (OSError, subprocess.CalledProcessError) as error:
        return str(error)
    return None


PLACES = {"calls": Folder, "full": SmallDisk, "power": FailingDisk}
