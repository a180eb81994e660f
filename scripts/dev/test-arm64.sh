#!/usr/bin/env bash
# Builds for 64-bit ARM and tests under qemu's user mode: kernels and real images; then compares all
# bytes that the programs write with those of the native programs. Needs root and network access; not
# part of scripts/test.sh.
set -euo pipefail
cd "$(dirname "$0")/../.."
scripts/install-deps.sh --arm64

# The libraries that programs link, as unpacked ARM packages that are not installed.
root=build/arm64-root
if [[ ! -d $root ]]; then
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  mkdir -p build
  made=$(mktemp -d build/arm64-root.XXXXXX)
  trap 'rm -rf "$made"' EXIT
  find /etc/apt -name '*.sources' -exec cat {} + -o -name '*.list' -exec cat {} + |
    mmdebstrap --architectures=arm64 --variant=extract \
      --include="libc6-dev $(scripts/install-deps.sh --libraries)" "$release" "$made" -
  # Absolute links point outside the root, and the package scripts that select alternatives did not
  # run.
  find "$made" -type l -lname '/*' -printf '%P\0%l\0' | while IFS= read -r -d '' link && IFS= read -r -d '' target; do
    ln -sfnr "$made$target" "$made/$link"
  done
  libraries=$made/usr/lib/aarch64-linux-gnu
  for library in blas lapack; do
    ln -sf "$library/lib$library.so.3" "$libraries/lib$library.so"
    ln -sf "$library/lib$library.so.3" "$libraries/lib$library.so.3"
  done
  # dlib's package names its libraries by absolute paths.
  sed -i -E 's#([;"])/usr/(include|lib/[^;"]*\.so)#\1${CMAKE_SYSROOT}/usr/\2#g' "$libraries"/cmake/dlib/*.cmake
  rm -rf "$made/tmp" "$made/dev" # qemu would look there for this machine's
  chmod 755 "$made"
  mv "$made" "$root"
  trap - EXIT
fi

programs=(vpr-train vpr-query vpr-eval vpr-tune vpr-bench vpr-synth)
tests=(base recordings truth synth database match query evaluate fabmap tune loops golden)
cmake --preset arm64 >/dev/null
cmake --build --preset arm64 --target "${programs[@]}" "${tests[@]/#/test_}" test_real_data
ctest --preset arm64 -R "^($(IFS='|'; echo "${tests[*]}"))\$"
# Reports what it skips if the images are missing, and exits with 77.
qemu-aarch64-static -L "$root" build/arm64/bin/test_real_data "*corridor*,*the loop*" || [[ $? == 77 ]]
build/arm64/emulated/vpr-bench matching --databases 500 --c-l 20 --json | grep -o '"simd": "NEON"'

cmake --preset release >/dev/null
cmake --build --preset release --target "${programs[@]}"
test/cli/same_outputs.py build/release/bin build/arm64/emulated corridor loop surf
