"""Where along a query's path each method recognizes it (section 4.4 of the paper)."""
import csv
import math

NEAR_TURN_M = 3  # of the path, before and after a turn: about the width of a corridor
TURN_DEG = 60  # between headings this far apart


def positions(data, query):
    """x, y and heading of each frame; none without poses."""
    path = data.description.parent / query["poses"] if "poses" in query else None
    if path is None or not path.exists():
        return []
    with path.open() as file:
        return [(float(row["x"]), float(row["y"]), float(row["heading"])) for row in csv.DictReader(file)]


def frames_of_places(data, query):
    """The query frames of each place on the path, by its index."""
    truth = query["place_ground_truth"]
    frames = {}
    if truth.get("format") != "pairs":
        return frames
    with (data.description.parent / truth["path"]).open() as file:
        for row in csv.DictReader(file):
            if row.get("label", "same") == "same":
                frames.setdefault(row["reference"], []).append(int(row["query"]))
    return frames


def marked_places(path):
    """The places in a file of marked places that are on the path."""
    with path.open() as file:
        return {(row["sequence"], row["train"]) for row in csv.DictReader(file) if row["query"]}


def near_turns(poses):
    """For each frame, whether the path turns by more than TURN_DEG within NEAR_TURN_M before or after it."""
    way = [0.0] if poses else []
    for (x, y, _), (next_x, next_y, _) in zip(poses, poses[1:]):
        way.append(way[-1] + math.hypot(next_x - x, next_y - y))
    headings = [math.radians(heading) for _, _, heading in poses]
    near, first, last = [], 0, 0
    for i, here in enumerate(way):
        while way[first] < here - NEAR_TURN_M:
            first += 1
        while last + 1 < len(way) and way[last + 1] <= here + NEAR_TURN_M:
            last += 1
        turned = [abs(math.remainder(headings[k] - headings[i], 2 * math.pi)) for k in (first, last)]
        near.append(max(turned) > math.radians(TURN_DEG))
    return near


def per_cent(frames):
    return round(100 * sum(frames) / len(frames), 1) if frames else 0.0


def parts(frames):
    """Lengths of the runs of recognized frames."""
    lengths, length = [], 0
    for is_recognized in [*frames, False]:
        if is_recognized:
            length += 1
        elif length:
            lengths.append(length)
            length = 0
    return lengths


def compare(data, query, recognized):
    """Measures of two methods, from whether each recognizes each frame correctly."""
    found = {}
    poses = positions(data, query)
    turns = near_turns(poses)
    fps = data.content.get("fps", 1)
    for title, frames in recognized.items():
        if len(turns) == len(frames):
            for where, here in (("near turns", True), ("on straight stretches", False)):
                found[f"{title} percent {where}"] = per_cent(
                    [frame for frame, turn in zip(frames, turns) if turn == here])
        third = len(frames) // 3
        for where, part in (("first", frames[:third]), ("middle", frames[third:-third]),
                            ("last", frames[-third:])):
            found[f"{title} percent of the {where} third"] = per_cent(part)
        lengths = parts(frames)
        found[f"{title} longest part in seconds"] = round(max(lengths, default=0) / fps, 1)
        found[f"{title} mean part in seconds"] = round(
            sum(lengths) / len(lengths) / fps, 1) if lengths else 0.0
    if "place_ground_truth" in query:
        places = frames_of_places(data, query)
        passed = [{title for title, frames in recognized.items() if any(frames[i] for i in shown)}
                  for shown in places.values()]
        found["places on the path"] = len(places)
        found["places by both"] = sum(len(methods) == len(recognized) for methods in passed)
        for title in recognized:
            found[f"places by {title} only"] = sum(methods == {title} for methods in passed)
    return found
