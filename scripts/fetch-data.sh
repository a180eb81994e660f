#!/usr/bin/env bash
# Fetches published data sets from their authors' addresses, and unpacks them.
#   scripts/fetch-data.sh [NAME ...] [--to DIR]
# Names: put-mc-floor1 vpr-bench nordland loop tower gardens-point st-lucia sfu (default: all). DIR: data/downloads.
# Resumes interrupted downloads. Unpacks an archive only if its size is correct.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

declare -A address=(
  [put-mc-floor1]=http://lrm.put.poznan.pl/files/Preludium/SP_PUT_CM_1.tar.gz
  [vpr-bench]=https://surfdrive.surf.nl/files/index.php/s/sbZRXzYe3l0v67W/download
  [nordland]=https://github.com/TimQuelch/seqslam/archive/HEAD.tar.gz
  [loop]=https://github.com/introlab/rtabmap/archive/HEAD.tar.gz
  [tower]=https://github.com/JSebastianIEU/ie-tower-visual-place-recognition/archive/HEAD.tar.gz
  [gardens-point]=https://www.tu-chemnitz.de/etit/proaut/datasets/GardensPoint_Walking.zip
  [st-lucia]=https://www.tu-chemnitz.de/etit/proaut/datasets/StLucia_small.zip
  [sfu]=https://www.tu-chemnitz.de/etit/proaut/datasets/SFU.zip
)
target=$root/data/downloads
names=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --to) [[ $# -ge 2 ]] || { echo "fetch-data: --to needs a folder" >&2; exit 2; }; target=$2; shift ;;
    -h | --help) sed -n '2,5s/^# //p' "$root/scripts/fetch-data.sh"; exit 0 ;;
    *) [[ -n ${address[$1]:-} ]] || { echo "fetch-data: unknown data set $1; choose one of ${!address[*]}" >&2; exit 2; }
       names+=("$1") ;;
  esac
  shift
done
[[ ${#names[@]} -gt 0 ]] || names=(put-mc-floor1 vpr-bench nordland loop tower gardens-point st-lucia sfu)
for tool in curl tar unzip python3; do
  command -v "$tool" >/dev/null || { echo "fetch-data: $tool is missing; install it and try again" >&2; exit 3; }
done

# The size stated by the server, or nothing.
stated_size() {
  curl --silent --fail --location --head --connect-timeout 20 "$1" |
    tr -d '\r' | awk 'tolower($1) == "content-length:" { size = $2 } END { print size }'
}

# Downloads one address to a file, and checks that it is complete.
download() {
  local url=$1 file=$2 size have
  size=$(stated_size "$url") || size=
  [[ -n $size ]] || echo "fetch-data: the server does not state the size of $url; it is not checked" >&2
  have=$(stat -c %s "$file" 2>/dev/null || echo 0)
  [[ -n $size && $have == "$size" ]] && return 0
  [[ -n $size && $have -lt $size ]] || rm -f "$file" # too long, or of unknown size: start again
  local fetch=(curl --fail --location --connect-timeout 20 --retry 3 --output "$file") code=0
  "${fetch[@]}" --continue-at - "$url" || code=$?
  if [[ $code == 33 ]]; then # the server cannot resume
    rm -f "$file"
    code=0
    "${fetch[@]}" "$url" || code=$?
  fi
  [[ $code == 0 ]] || return 1
  [[ -z $size || $(stat -c %s "$file") == "$size" ]] && return 0
  echo "fetch-data: $file has $(stat -c %s "$file") bytes, the server states $size" >&2
  return 1
}

# Unpacks next to the final folder, describes, then renames: an existing folder is complete.
unpack() {
  local name=$1 archive=$2 folder=$3
  rm -rf "$folder.part"
  mkdir "$folder.part"
  case $archive in
    *.tar.gz) tar -xzf "$archive" -C "$folder.part" || return 1 ;;
    *) unzip -q "$archive" -d "$folder.part" || return 1 ;;
  esac
  if [[ $name == put-mc-floor1 ]]; then describe_floor1 "$folder.part" || return 1; fi
  mv "$folder.part" "$folder"
}

# The sequences in the archive of the first floor, which has no ground truth. Each folder of images in the
# test folder, or the test folder itself, is a query. The paper's has 320 frames: the nearest is "query".
describe_floor1() {
  python3 - "$1" <<'PYTHON'
import json, pathlib, sys
folder = pathlib.Path(sys.argv[1])


def sequences(name):
    """The folders that contain images, with the number of these."""
    folders = [path for top in folder.glob(f"**/{name}") for path in (top, *top.glob("**/")) if path.is_dir()]
    counts = {path: sum(file.suffix.lower() in (".jpg", ".jpeg", ".png", ".bmp", ".pgm", ".ppm")
                        for file in path.iterdir()) for path in sorted(set(folders))}
    return {path: count for path, count in counts.items() if count > 0}


train, queries = sequences("SP_PUT_CM_1_train"), sequences("SP_PUT_CM_1_test")
if not train or not queries:
    sys.exit(f"fetch-data: {folder} has no images in SP_PUT_CM_1_train and SP_PUT_CM_1_test")
paper = min(queries, key=lambda path: abs(queries[path] - 320))
relative = lambda path: str(path.relative_to(folder))
(folder / "dataset.json").write_text(json.dumps({
    "schema": "vpr.dataset/3", "name": "PUT MC, first floor", "fps": 10,
    "train": [{"name": path.name, "sequence": relative(path)} for path in train],
    "queries": [{"name": "query" if path == paper else path.name, "sequence": relative(path)}
                for path in queries]}, indent=2) + "\n")
print(f"put-mc-floor1: {len(train)} training sequences of {sum(train.values())} frames (paper: 14 of 2127), "
      f"query {relative(paper)} of {queries[paper]} frames (paper: 320)")
PYTHON
}

mkdir -p "$target"
failed=()
for name in "${names[@]}"; do
  folder=$target/$name
  [[ -d $folder ]] && { echo "$name: is in $folder"; continue; }
  archive=$target/$name.zip
  [[ ${address[$name]} == *.tar.gz ]] && archive=$target/$name.tar.gz
  echo "$name: from ${address[$name]}"
  if ! download "${address[$name]}" "$archive"; then
    failed+=("$name: incomplete download from ${address[$name]}; run this again to resume it, or download it manually to $archive")
  elif ! unpack "$name" "$archive" "$folder"; then
    failed+=("$name: $archive differs from the description of its authors; check $folder.part, or delete it and run this again")
  else
    echo "$name: is in $folder"
  fi
done
[[ ${#failed[@]} == 0 ]] && exit 0
printf 'fetch-data: %s\n' "${failed[@]}" >&2
exit 3
