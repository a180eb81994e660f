#!/usr/bin/env python3
"""Installs the library for C++, builds examples/ against it, and compares its output with the programs; a shared library
that links it has no other symbols of it.   library.py SOURCE BIN BUILD CMAKE CXX [FLAGS]"""
import csv
import re
import shutil
import sys

from support import call, folder, ok, programs, read_json, run, source

build, cmake, compiler = sys.argv[3:6]
prefix = folder / "prefix"
ok(call(cmake, "--install", build, "--prefix", prefix, "--component", "development"))
files = {str(path.relative_to(prefix)) for path in prefix.rglob("*") if path.is_file() and "doc" not in path.parts}
(library,) = prefix.rglob("libvpr.a")
package = library.parent.relative_to(prefix) / "cmake/vpr"
assert {"include/vpr/vpr.h", str(library.relative_to(prefix)), f"{package}/vprConfig.cmake"} <= files, files
assert all(name.startswith(f"{package}/vpr") for name in files - {"include/vpr/vpr.h", str(library.relative_to(prefix))}), files
assert str(source) not in "".join((prefix / name).read_text() for name in files if name.endswith(".cmake"))

# The installed copy of the example, as C++17 with all warnings, and the same code as a shared library.
(example,) = prefix.rglob("examples")
shutil.copytree(example, folder / "example")
with (folder / "example/CMakeLists.txt").open("a") as text:
    text.write("add_library(wrapper SHARED recognize.cpp)\ntarget_link_libraries(wrapper PRIVATE vpr::vpr)\n")
ok(call(cmake, "-G", "Ninja", "-S", "example", "-B", "built", f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_CXX_COMPILER={compiler}",
        f"-DCMAKE_CXX_FLAGS={' '.join(sys.argv[6:])} -Wall -Wextra -Wpedantic -Wshadow -Werror", "-DCMAKE_CXX_STANDARD=17",
        "-DCMAKE_BUILD_TYPE=Release"))
ok(call(cmake, "--build", "built"))
# GCC exports specializations of variable templates, whatever their visibility.
symbols = [line for line in run("nm", "--dynamic", "--defined-only", "--demangle", "built/libwrapper.so").splitlines()
           if "vpr::kEnumNames<" not in line]
assert any(line.endswith(" main") for line in symbols)
assert not [line for line in symbols if re.search(r"\bvpr::(?!api::)", line) and "std::" not in line], symbols
assert not [line for line in symbols if re.search(r"\b(cv|tbb|dlib)::", line)], symbols

shutil.copytree(source / "data/example", folder / "data")
run("vpr-train", "images", "--train", "data/monday", "-o", "m.vprdb", "--quiet")
for frames in "", "@0:35":
    query, truth = "data/tuesday" + frames, "data/pairs.csv" + frames
    run("vpr-query", "m.vprdb", "--query", query, "-o", "r.json", "--quiet", "--force")
    sentences = " ".join(run("vpr-eval", "r.json", "--ground-truth", truth, "--tolerance", 2, "-o", "e.json", "--outcomes-csv",
                             "o.csv", "--force").split())
    report = read_json("e.json")
    *matches, summary, numbers = run("built/recognize", "data/monday", query, truth).splitlines()
    with (folder / "o.csv").open() as table:
        recognized = [row for row in csv.DictReader(table) if row["recognition"] not in ("", "none")]
    assert len(recognized) == report["localization"]["recognized"] > 20
    assert matches == [f"query frame {row['frame']}: frame {row['train_frame']} of monday, score {int(row['score']) / 1024:.3f}, "
                       f"margin {float(row['margin']):.3f}" for row in recognized], (matches[:3], recognized[:3])
    assert sentences.startswith(summary), (sentences, summary)
    path, recall = report["localization"], report["metrics"]["recall_at"]["1"]
    assert numbers == (f"{path['correct']} of {path['frames_with_match']} frames correct, {path['incorrect']} incorrect, "
                       f"R@1 {recall:.6g}"), (numbers, path, recall)
