#!/bin/bash
# Builds published programs from clones that you name, compares them with vpr-toolkit in one run, and
# writes the tables of docs/benchmarks/peers.md.
usage='Usage: scripts/peers/run.sh [OPTIONS] -o PAGE

Builds published programs and compares them with vpr-toolkit. The page has what was named.

  --fastable DIR      clone of github.com/LRMPUT/FastABLE
  --openable DIR      clone of github.com/roberto-arroyo/OpenABLE
  --openfabmap DIR    clone of github.com/arrenglover/openfabmap
  --seqslam DIR       clone of github.com/TimQuelch/seqslam (CPU part)
  --localizer DIR     clone of github.com/ovysotska/image_sequence_localizer
  --vpr-methods DIR   clone of github.com/gmberton/VPR-methods-evaluation (its counting of recall)
  --data DIR          folder with corridor, nordland, loop and tower (scripts/fetch-data.sh);
                      default: $VPR_TEST_DATA/data. Without it, only times of FastABLE, OpenABLE and
                      OpenFABMAP are measured
  --bin DIR           programs of a release build of vpr-toolkit (default: build/release/bin)
  --work DIR          folder for builds and intermediate files (default: a temporary folder)
  --seconds N         time of each measurement in seconds (default: 1)
  --rounds N          interleaved rounds; the page has medians (default: 5)
  -o PAGE             page to write

Needs cmake, g++, OpenCV 4, numpy; libboost-filesystem-dev for FastABLE;
libeigen3-dev and libfmt-dev for seqslam; libgoogle-glog-dev, libprotobuf-dev and protobuf-compiler for
the localizer. Clones are not changed. LDB of FastABLE and OpenABLE (GPL) is neither built nor read:
codes come from vpr-train or are random. Nothing else should run meanwhile: about 6 minutes.'
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "$1" >&2; exit 2; }

declare -A clone=()
data=${VPR_TEST_DATA:+$VPR_TEST_DATA/data} bin=$here/../../build/release/bin
work='' page='' seconds=1 rounds=5
while [ $# -gt 0 ]; do
  case $1 in
    -h | --help) echo "$usage"; exit ;;
  esac
  [ $# -gt 1 ] || fail "$1 needs a value. Use --help to list the options."
  case $1 in
    --fastable | --openable | --openfabmap | --seqslam | --localizer | --vpr-methods)
      git -C "$2" rev-parse HEAD > /dev/null 2>&1 || fail "$2: not a git clone. Clone the program first (--help)."
      clone[${1#--}]=$(realpath "$2") ;;
    --data) data=$(realpath "$2") ;;
    --bin) bin=$(realpath "$2") ;;
    --work) mkdir -p "$2"; work=$(realpath "$2") ;;
    --seconds) seconds=$2 ;;
    --rounds) rounds=$2 ;;
    -o) page=$(realpath "$2") ;;
    *) fail "$1: unknown option. Use --help to list the options." ;;
  esac
  shift 2
done
[ -n "$page" ] || fail 'No page to write. Name it with -o, as in -o docs/benchmarks/peers.md.'
[ ${#clone[@]} -gt 0 ] || fail 'No clone to build. Name at least one, as in --fastable FastABLE.'
[ -x "$bin/vpr-bench" ] || fail "$bin/vpr-bench: not found. Build vpr-toolkit, or name its programs with --bin."
if [ -z "$work" ]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi

named() { [ -n "${clone[$1]:-}" ]; }
opencv=$(pkg-config --cflags opencv4)

# A copy of FastABLE or OpenABLE that its own CMake file builds, with our main file and an empty LDB.
# Debian's OpenCV has no xfeatures2d; neither program needs it for binary codes.
build_able() { # clone, folder, main file, flags
  rm -rf "${work:?}/$2"
  mkdir -p "$work/$2"
  git -C "${clone[$1]}" archive HEAD -- . ':!lib' | tar x -C "$work/$2"
  cd "$work/$2"
  mkdir -p lib/ldb lib/d_ldb
  cat > lib/ldb/ldb.h << 'END'
#pragma once
struct LDB { void compute(const cv::Mat&, std::vector<cv::KeyPoint>&, cv::Mat&) {} };
END
  cp lib/ldb/ldb.h lib/ldb/Ldb.h
  cat > lib/d_ldb/D_Ldb.h << 'END'
#pragma once
struct D_Ldb {
  explicit D_Ldb(char*) {}
  void compute_disparity(const cv::Mat&, const cv::Mat&) {}
  cv::Mat get_color_disparity_map() { return {}; }
};
END
  sed -i 's|opencv2/xfeatures2d.hpp|opencv2/opencv.hpp|; s/private:/public:/' src/OpenABLE.h
  sed -i '/using namespace cv::xfeatures2d/d; /BriefDescriptorExtractor/d; /brief->/d; /FREAK::/d
          /freak->/d; /SURF::/d; /surf->/d; s/HOGDescriptor hog(.*/HOGDescriptor hog;/' src/OpenABLE.cpp
  sed -i "/[lL]db\.cpp/d; s/system filesystem thread/filesystem/; s/-O3 -Wall/-O3 -w $4/" CMakeLists.txt
  cp "$here/fastable_driver.cpp" "$3"
  cp "$here/timing.h" .
  cmake -S . -B build -DCMAKE_POLICY_VERSION_MINIMUM=3.5 > cmake.log 2>&1 &&
    cmake --build build -j2 > build.log 2>&1 || fail "$work/$2: cannot build. See cmake.log and build.log there."
}
compile() { # output, arguments of g++
  mkdir -p "$(dirname "$1")"
  # shellcheck disable=SC2086
  g++ -w -O3 -DNDEBUG $opencv -o "$@" -lopencv_core -lopencv_imgproc -lopencv_imgcodecs ||
    fail "$1: cannot build. Install the libraries that --help lists."
}

if named fastable; then
  build_able fastable fastable FastABLE_vs_OpenABLE.cpp ''
  build_able fastable fastable-native FastABLE_vs_OpenABLE.cpp -march=native
fi
if named openable; then build_able openable openable Test_OpenABLE.cpp -DOPENABLE; fi
if named openfabmap; then
  source=${clone[openfabmap]}
  compile "$work/openfabmap" -fopenmp -I "$source/include" "$source"/src/{fabmap,inference}.cpp \
    "$here/openfabmap_driver.cpp"
fi
if named seqslam; then # without OpenCL
  mkdir -p "$work/seqslam-source"
  cp "${clone[seqslam]}"/{include/*.h,src/seqslam.cpp,src/utils.cpp} "$work/seqslam-source"
  cd "$work/seqslam-source"
  sed -i '/clutils.h/d; /namespace opencl {/,/namespace opencl$/d' seqslam.h seqslam.cpp
  compile "$work/seqslam" -std=c++17 -march=native -I . -isystem "${EIGEN3_INCLUDE_DIR:-/usr/include/eigen3}" \
    seqslam.cpp utils.cpp "$here/seqslam_driver.cpp" -lfmt
fi
if named localizer; then
  source=${clone[localizer]}/src
  mkdir -p "$work/protos"
  protoc -I "$source" --cpp_out="$work/protos" "$source/localization_protos.proto" ||
    fail 'protoc does not work. Install protobuf-compiler.'
  cd "$source/localization"
  compile "$work/localizer" -std=c++20 -I . -I "$work/protos" "$work/protos/localization_protos.pb.cc" \
    online_localizer/{online_localizer,path_element}.cpp successor_manager/{successor_manager,node}.cpp \
    relocalizers/default_relocalizer.cpp tools/timer/timer.cpp "$here/localizer_driver.cpp" \
    -lglog -lprotobuf -lpthread
fi

cd "$work"
for name in "${!clone[@]}"; do
  echo "$name ${clone[$name]} $(git -C "${clone[$name]}" rev-parse --short=7 HEAD)"
done > clones.txt
/usr/bin/python3 "$here/compare.py" --work "$work" --bin "$bin" --data "$data" --seconds "$seconds" \
  --rounds "$rounds" -o "$page"
