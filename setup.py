"""Builds the Python module vpr by CMake, for pip install ."""

import os
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext


class CMakeBuild(build_ext):
    def run(self):
        source = os.path.dirname(os.path.abspath(__file__))
        build = os.path.abspath(self.build_temp)
        prefix = os.path.abspath(self.build_lib)
        subprocess.run(["cmake", "--preset", "release", "-S", source, "-B", build, "-DBUILD_TESTING=OFF",
                        "-DVPR_PYTHON_MODULE=ON", "-DVPR_PYTHON_DIR=.",
                        f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", build, "--parallel", str(os.cpu_count()), "--target",
                        "vpr_python"], check=True)
        subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", prefix],
                       check=True)


setup(license="MIT", ext_modules=[Extension("vpr._vpr", [])], packages=[], cmdclass={"build_ext": CMakeBuild})
