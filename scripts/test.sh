#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds, and tests: everything (dev), then reading, writing and validating alone (core-only).
#
# usage: test.sh [--all]     --all: also sanitizers, clang-tidy, desktop programs, fuzzing, benchmarks
#
# Goes on after a failure, so that one run tells all; the last line is the summary, and the exit status is its verdict.
set -uo pipefail
cd "$(dirname "$0")/.."

all=false
case "${1-}" in
  "") ;;
  --all) all=true ;;
  *) sed -n '3,7s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac

# Objects compiled for one preset serve the next: the cache must not see the build folder's name.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
export CTEST_PARALLEL_LEVEL=${CTEST_PARALLEL_LEVEL:-$(nproc)}

passed=() failed=() times=() closing=() failed_tests=()
step() {  # step NAME COMMAND...: runs it, remembers how it went
  local name=$1 begin=$SECONDS
  shift
  printf '\n== %s\n' "$name"
  if "$@"; then passed+=("$name"); else failed+=("$name"); fi
  times+=("$name $((SECONDS - begin)) s")
  printf '== %s: %d s\n' "$name" $((SECONDS - begin))
}
build() {  # build PRESET [cmake arguments]
  local preset=$1
  shift
  cmake --preset "$preset" "$@" && cmake --build --preset "$preset" -- --quiet
}
build_and_test() {  # build_and_test PRESET [ctest arguments]
  local preset=$1
  shift
  local result=0 begin=$SECONDS
  build "$preset" || return
  printf -- '-- %s built: %d s\n' "$preset" $((SECONDS - begin))
  # ctest's closing lines come again at the end, where they are looked for.
  ctest --preset "$preset" --no-tests=error "$@" 2>&1 | tee "build/$preset/ctest.log"
  result=${PIPESTATUS[0]}
  closing+=("$preset: $(grep 'tests passed' "build/$preset/ctest.log")")
  failed_tests+=("$(sed -n '/^The following tests FAILED/,$p' "build/$preset/ctest.log")")
  return "$result"
}

if $all; then step packages ./scripts/install-deps.sh --all; else step packages ./scripts/install-deps.sh; fi
# "desktop" needs programs with a window, "fuzz" and "slow" run for minutes: they belong to --all.
# The core profile of the conformance cases runs in core-only, whose command starts in a tenth of the time.
step dev build_and_test dev -LE 'desktop|fuzz|slow' -E '^conformance_core$'
step core-only build_and_test core-only -LE 'desktop|fuzz|slow'
step dependencies ./scripts/check_dependencies.py build/dev/bin/meso
step diagnostics-page diff docs/diagnostics.md <(./scripts/generate_diagnostics.py md)
if command -v clang-format-14 > /dev/null; then step format ./scripts/check_format.sh; fi

if $all; then
  step desktop ctest --preset dev -L 'desktop|fuzz|slow'
  step asan build_and_test asan -LE 'desktop|fuzz|slow'
  step tidy build tidy
  step benchmarks build release
  for bench in build/release/bin/*bench*; do
    if [[ -x $bench ]]; then step "$(basename "$bench")" "$bench"; fi
  done
fi

printf '\n'
for lines in "${failed_tests[@]}"; do
  if [[ -n $lines ]]; then printf '%s\n' "$lines"; fi
done
for line in "${closing[@]}"; do printf '%s\n' "$line"; done
printf '== times:'
printf ' %s;' "${times[@]}"
printf '\n== %d s; passed: %s' "$SECONDS" "${passed[*]-}"
if ((${#failed[@]} > 0)); then
  printf '; FAILED: %s\n' "${failed[*]}"
  exit 1
fi
printf '; nothing failed\n'
