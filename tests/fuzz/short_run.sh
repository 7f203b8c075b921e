#!/usr/bin/env bash
# Builds the fuzz targets with Clang and runs each over its committed inputs, then for some seconds from there. What breaks
# one is kept in build/fuzz/found. Ends with 125 where there is no Clang with libFuzzer. Usage: short_run.sh [SECONDS]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-10}
log=$(mktemp)
trap 'rm -rf "$log" "$log.d"' EXIT

clang=$(compgen -c | grep -Ex 'clang\+\+(-[0-9]+)?' | sort -V | head -1 || true)
mkdir "$log.d"
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' >"$log.d/probe.cpp"
if [ -z "$clang" ] || ! "$clang" -fsanitize=fuzzer,address "$log.d/probe.cpp" -o "$log.d/probe" 2>"$log"; then
    echo "SKIPPED: no Clang with libFuzzer (packages clang and libclang-rt-dev)"
    exit 125
fi

{ cmake --preset fuzz && cmake --build --preset fuzz; } >"$log" 2>&1 || { cat "$log" >&2; exit 1; }
export ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=0 # leaks of libraries on broken files are theirs
export OPENIMAGEIO_OPTIONS=threads=1,exr_threads=-1
mkdir -p build/fuzz/found
for target in matrix planes scene schemes; do
    mkdir "$log.d/$target"
    echo "fuzz_$target, $seconds s"
    build/fuzz/fuzz_$target -artifact_prefix=build/fuzz/found/$target- -max_total_time="$seconds" -timeout=120 \
        -max_len=8192 -rss_limit_mb=4096 -malloc_limit_mb=100000 "$log.d/$target" tests/fuzz/corpus/$target \
        >"$log" 2>&1 || { tail -60 "$log" >&2; exit 1; }
    tail -1 "$log"
done
