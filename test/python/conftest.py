"""Two walks through a building of textures, as images and as descriptors of a network."""

import pathlib
import sys

import numpy as np
import pytest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))
import served  # noqa: E402

FRAMES = 60


def pytest_addoption(parser):
    parser.addoption("--programs", required=True)


@pytest.fixture(scope="session")
def run(request):
    programs = served.Served(request.config.getoption("--programs"))

    def run_program(name, *arguments, folder, code=0):
        done = programs.call((name, *arguments), folder)
        assert done.returncode == code, done.stderr
        return done
    return run_program


def write_walk(folder, wall, offsets, noise):
    folder.mkdir()
    for i, x in enumerate(offsets):
        image = wall[:, x:x + 96].astype(np.int64) + noise.integers(-6, 7, (64, 96))
        pixels = np.clip(image, 0, 255).astype(np.uint8)
        (folder / f"{i:04}.pgm").write_bytes(b"P5 96 64 255\n" + pixels.tobytes())


@pytest.fixture(scope="session")
def walks(tmp_path_factory):
    """A folder with the walks monday and tuesday as images, float32 vectors and bits."""
    folder = tmp_path_factory.mktemp("walks")
    random = np.random.default_rng(1)
    wall = np.kron(random.integers(0, 256, (16, 400)), np.ones((4, 4)))
    write_walk(folder / "monday", wall, range(0, 8 * FRAMES, 8), random)
    write_walk(folder / "tuesday", wall, range(2, 8 * FRAMES, 8), random)
    write_walk(folder / "other", np.fliplr(wall), range(0, 8 * FRAMES, 8), random)
    monday = random.standard_normal((200, 64)).astype(np.float32)
    tuesday = (monday + 0.4 * random.standard_normal(monday.shape)).astype(np.float32)
    np.save(folder / "monday.npy", monday)
    np.save(folder / "tuesday.npy", tuesday)
    np.save(folder / "monday_bits.npy", np.packbits(monday > 0, axis=1, bitorder="little"))
    np.save(folder / "tuesday_bits.npy", np.packbits(tuesday > 0, axis=1, bitorder="little"))
    return folder
