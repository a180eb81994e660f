"""The commands that write, with the outputs that they replace and their readers."""
import dataclasses
import pathlib

WORLD = """{"schema": "vpr.world/3", "name": "two corridors", "seed": 3, "fps": 1,
 "image_width": 160, "image_height": 120, "format": "png", "resemblance": 0,
 "same_place_m": 1, "ignore_m": 1,
 "floors": [{"name": "ground", "rooms": [{"x": 0, "y": 0, "width": 14, "depth": 2.5},
                                         {"x": 0, "y": 6, "width": 14, "depth": 2.5}]}],
 "places": [{"name": "end", "floor": "ground", "x": 10, "y": 1.25, "headings": [0]}],
 "walks": [
  {"name": "one", "use": "train", "floor": "ground", "path": [[1, 1.25], [11, 1.25]]},
  {"name": "two", "use": "train", "floor": "ground", "path": [[1, 7.25], [11, 7.25]]},
  {"name": "pre", "use": "pretrain", "floor": "ground", "path": [[11, 7.25], [1, 7.25]]},
  {"name": "back", "use": "query", "floor": "ground", "path": [[2, 1.25], [10, 1.25]],
   "conditions": {"lamps": 0.66, "noise": 5}}]}
"""
TINY_WORLD = """{"schema": "vpr.world/3", "name": "%s", "seed": 3, "fps": 1,
 "image_width": 64, "image_height": 48, "format": "png", "resemblance": 0,
 "floors": [{"name": "ground", "rooms": [{"x": 0, "y": 0, "width": 6, "depth": 2.5}]}],
 "places": [{"name": "end", "floor": "ground", "x": 4, "y": 1.25, "headings": [0]}],
 "walks": [
  {"name": "%s", "use": "train", "floor": "ground", "path": [[1, 1.25], [4, 1.25]], "frames": 2},
  {"name": "back", "use": "query", "floor": "ground", "path": [[4, 1.25], [2, 1.25]],
   "frames": 1}]}
"""

LISTS = {  # from other programs: name in the folder "in" -> content
    "loops1.csv": "query,match,score\n6,1,0.5\n8,2,0.4\n",
    "loops2.csv": "query,match,score\n6,1,0.5\n8,3,0.4\n",
    "pairs1.txt": "00000.png 00001.png 0.5\n00001.png 00002.png 0.5\n00002.png 00003.png 0.9\n",
    "pairs2.txt": "00000.png 00002.png 0.5\n00001.png 00002.png 0.5\n00002.png 00004.png 0.8\n",
}
SEQUENCES = "fastable --c-l 3"
INPUTS = [  # inputs of the commands, made once, in this order
    "vpr-synth in/world.json -o in/walks",
    f"vpr-train {SEQUENCES} --train in/walks/one --train in/walks/two -o in/s.vprdb",
    f"vpr-train {SEQUENCES} --train in/walks/one -o in/one.vprdb",
    "vpr-train fabmap --pretrain in/walks/pre --train in/walks/one --words 8 -o in/f.vprdb",
    "vpr-train fabmap --pretrain in/walks/pre --train in/walks/two --words 8 -o in/f2.vprdb",
    "vpr-query in/s.vprdb --query in/walks/back --c-l 3 --t-r 0.6 -o in/r.json "
    "--save-matrix in/r.npy",
    "vpr-query in/s.vprdb --query in/walks/back --c-l 3 --t-r 0.4 -o in/r2.json",
    "vpr-query in/one.vprdb --query in/walks/two --c-l 3 --t-r 0.6 -o in/n.json "
    "--save-matrix in/n.npy",
    "vpr-query in/one.vprdb --query in/walks/one --c-l 3 --t-r 0.6 -o in/n2.json "
    "--save-matrix in/n2.npy",
    "vpr-query in/f.vprdb --query in/walks/back --t-p 0.3 -o in/f.json",
    "vpr-eval in/r.json --dataset in/walks/dataset.json -o in/e.json",
    "vpr-eval in/r2.json --dataset in/walks/dataset.json -o in/e2.json",
    "vpr-bench describe --frames 1 --features orb --seconds 0.001 -o in/b.json",
    "vpr-bench describe --frames 2 --features orb --seconds 0.001 -o in/b2.json",
]


@dataclasses.dataclass(frozen=True)
class Reader:
    """A command that reads outputs: it must refuse outputs of different runs."""
    reads: tuple
    command: str


@dataclasses.dataclass(frozen=True)
class Writer:
    """`command` has {word}s, which are words[word][0] for the old outputs, words[word][1] for the
    new. `main` is the output that is renamed last. `start` lists the files before the first run:
    (name in out, file to copy)."""
    name: str
    command: str
    main: str
    words: dict
    readers: tuple = ()
    start: tuple = ()
    has_times: bool = False

    def line(self, is_new):
        return self.command.format(**{word: both[is_new] for word, both in self.words.items()})

    @property
    def program(self):
        return self.command.split()[0]


PAIRS = "--ground-truth in/walks/back.ground_truth.csv"
ALIGNED = "--ground-truth aligned --tolerance 2"  # of databases with one sequence
SEQUENCE_RESULT = ("r.json", "r.npz")
FABMAP_RESULT = ("f.json", "f.npz", "p.npy")
TRAIN = {"train": ("in/walks/one", "in/walks/two")}
QUERY = {"query": ("in/walks/two", "in/walks/back")}
INFO = (Reader(("d.vprdb",), "vpr-train info out/d.vprdb"),)

WRITERS = [
    Writer("train fastable", f"vpr-train {SEQUENCES} --train {{train}} -o out/d.vprdb",
           "d.vprdb", TRAIN, INFO),
    Writer("train fabmap", "vpr-train fabmap --pretrain in/walks/pre --train {train} --words 8 "
           "-o out/d.vprdb", "d.vprdb", TRAIN, INFO),
    Writer("train add", "vpr-train add in/one.vprdb --train {train} -o out/d.vprdb", "d.vprdb",
           {"train": ("in/walks/two", "in/walks/back")}, INFO),
    Writer("train add, in place", "vpr-train add out/d.vprdb --train in/walks/two -o out/d.vprdb",
           "d.vprdb", {}, INFO, (("d.vprdb", "in/one.vprdb"),)),
    Writer("train add, fabmap in place",
           "vpr-train add out/d.vprdb --train in/walks/two -o out/d.vprdb", "d.vprdb", {}, INFO,
           (("d.vprdb", "in/f.vprdb"),)),
    Writer("train export", "vpr-train export {database} --descriptors out/x.npy", "x.npy",
           {"database": ("in/one.vprdb", "in/s.vprdb")},
           (Reader(("x.npy",), "vpr-train descriptors --train out/x.npy --bits --c-l 3 -o read/d.vprdb"),)),
    Writer("query", "vpr-query in/s.vprdb --query {query} --c-l 3 --t-r 0.6 -o out/r.json "
           "--save-matrix out/m.npy", "r.json", QUERY,
           (Reader(SEQUENCE_RESULT + ("m.npy",), f"vpr-eval out/r.json {PAIRS}"),
            Reader(SEQUENCE_RESULT + ("m.npy",),
                   f"vpr-eval out/r.json --matrix out/m.npy {PAIRS}"))),
    Writer("query, zscore", "vpr-query in/s.vprdb --query {query} --c-l 3 --score "
           "zscore --t-r=-1 -o out/r.json --save-matrix out/m.png", "r.json", QUERY,
           (Reader(SEQUENCE_RESULT + ("m.png",), f"vpr-eval out/r.json {PAIRS}"),)),
    Writer("query fabmap", "vpr-query {database} --query in/walks/back --t-p 0.3 -o out/f.json "
           "--save-posteriors out/p.npy", "f.json", {"database": ("in/f2.vprdb", "in/f.vprdb")},
           (Reader(FABMAP_RESULT, f"vpr-eval out/f.json {ALIGNED}"),)),
    Writer("tune fastable", "vpr-tune fastable in/s.vprdb --dataset in/walks/dataset.json "
           "--c-l {lengths} --t-r 0.3:0.6:0.1 -o out/s.json --heat-map out/h.png "
           "--plot out/plots --save-config out/best.json", "s.json", {"lengths": ("3", "2")},
           (Reader(("best.json",), "vpr-query in/s.vprdb --query in/walks/back --config "
                   "out/best.json"),)),
    Writer("tune fabmap", "vpr-tune fabmap in/f.vprdb --query in/walks/back "
           f"{ALIGNED} --c-w 1,2 --t-p {{grid}} -o out/s.json --heat-map out/h.png "
           "--plot out/plots --save-config out/best.json", "s.json",
           {"grid": ("0.3:0.5:0.01", "0.305:0.505:0.01")},
           (Reader(("best.json",), "vpr-query in/f.vprdb --query in/walks/back --config "
                   "out/best.json"),)),
    Writer("tune threshold", "vpr-tune threshold in/s.vprdb --c-l {length} -o out/t.json",
           "t.json", {"length": ("3", "2")}),
    Writer("tune threshold --write", "vpr-tune threshold out/d.vprdb --c-l 2 --write -o out/t.json",
           "t.json", {}, INFO, (("d.vprdb", "in/s.vprdb"),)),
    Writer("tune fastable, two buildings", "vpr-tune fastable in/s.vprdb --dataset "
           "in/walks/dataset.json --dataset in/walks/dataset.json --c-l {lengths} "
           "--t-r 0.3:0.6:0.1 -o out/s.json", "s.json", {"lengths": ("3", "2")}),
    Writer("eval", "vpr-eval {result} --dataset in/walks/dataset.json --query back -o out/e.json "
           "--html out/e.html --plot out/plots --map out/map --outcomes-csv out/o.csv "
           "--recognitions-csv out/r.csv", "e.json", {"result": ("in/r2.json", "in/r.json")},
           (Reader(("e.json",), "vpr-eval compare in/e.json out/e.json"),)),
    Writer("eval fabmap", "vpr-eval in/f.json --ground-truth aligned --tolerance {tolerance} "
           "-o out/e.json --html out/e.html --plot out/plots", "e.json",
           {"tolerance": ("1", "2")}),
    Writer("eval several", f"vpr-eval {{results}} {PAIRS} -o out/e.json --outcomes-csv out/o.csv "
           "--recognitions-csv out/r.csv", "e.json",
           {"results": ("in/r2.json in/r.json", "in/r.json in/r2.json")}),
    Writer("eval --scores", f"vpr-eval matrix {{scores}} --distance {ALIGNED} -o out/e.json "
           "--html out/e.html", "e.json", {"scores": ("in/n2.npy", "in/n.npy")}),
    Writer("eval --expect --update", "vpr-eval {result} --dataset in/walks/dataset.json --expect "
           "out/x.json --update --junit out/j.xml --save-trajectory out/f.tum -o out/e.json", "e.json",
           {"result": ("in/r2.json", "in/r.json")},
           (Reader(("x.json",), "vpr-eval compare in/e.json out/x.json"),)),
    Writer("eval --scores --expect --update", "vpr-eval matrix in/n2.npy --distance "
           "--ground-truth aligned --tolerance {tolerance} --expect out/x.json --update --junit "
           "out/j.xml --pairs out/p.txt --top-k {most} -o out/e.json", "e.json",
           {"tolerance": ("2", "1"), "most": ("2", "3")}),
    Writer("eval --predictions", f"vpr-eval matrix {{pairs}} --similarity {ALIGNED} "
           "--query in/walks/two --train in/walks/one -o out/e.json --pairs out/p.txt "
           "--outcomes-csv out/o.csv", "e.json", {"pairs": ("in/pairs1.txt", "in/pairs2.txt")},
           (Reader(("p.txt",), f"vpr-eval matrix out/p.txt --query in/walks/two --train "
                   f"in/walks/one {ALIGNED}"),)),
    Writer("eval --loops", "vpr-eval loops {loops} --poses in/walks/one/poses.csv --radius 2 "
           "--gap 3 --similarity -o out/l.json --plot out/plots --html out/l.html", "l.json",
           {"loops": ("in/loops1.csv", "in/loops2.csv")}),
    Writer("eval compare", "vpr-eval compare {reports} -o out/c.json --html out/c.html", "c.json",
           {"reports": ("in/e2.json in/e.json", "in/e.json in/e2.json")}),
    *[Writer(f"eval convert to {name}", f"vpr-eval convert aligned --to {kind} --tolerance "
             f"{{tolerance}} --query in/walks/two --train in/walks/one -o out/{name}", name,
             {"tolerance": ("0", "1")},
             (Reader((name,), f"vpr-eval in/n.json --ground-truth out/{name}"),))
      for kind, name in (("pairs", "g.csv"), ("matrix", "g.npy"), ("matrix", "g.npz"))],
    Writer("eval check", "vpr-eval check in/walks/back.ground_truth.csv --result in/r.json "
           "--tolerance {tolerance} -o out/c.json", "c.json", {"tolerance": ("0", "1")}),
    Writer("bench", "vpr-bench describe --frames {frames} --features orb --seconds 0.001 "
           "-o out/b.json --plot out/plots", "b.json", {"frames": ("1", "2")},
           (Reader(("b.json",), "vpr-bench compare out/b.json out/b.json"),), has_times=True),
    Writer("bench compare", "vpr-bench compare {benches} --factor 1e9 -o out/c.json", "c.json",
           {"benches": ("in/b2.json in/b2.json", "in/b.json in/b.json")}),
    Writer("synth", "vpr-synth {world} -o out/walks", "walks",
           {"world": ("in/tiny1.json", "in/tiny2.json")},
           (Reader(("walks",), "vpr-train fastable --dataset out/walks/dataset.json --c-l 2 "
                   "-o read/d.vprdb"),)),
]


def make_inputs(folder, run):
    """Makes the inputs of all commands in `folder`/in; `run` runs a command line there."""
    inputs = pathlib.Path(folder) / "in"
    inputs.mkdir()
    (inputs / "world.json").write_text(WORLD)
    (inputs / "tiny1.json").write_text(TINY_WORLD % ("first", "a"))
    (inputs / "tiny2.json").write_text(TINY_WORLD % ("second", "b"))
    for name, content in LISTS.items():
        (inputs / name).write_text(content)
    for line in INPUTS:
        done = run(line)
        if done.status != 0:
            raise SystemExit(f"faults: {line}: {done.stderr}")
