# SPDX-FileCopyrightText: The kilter authors
# SPDX-License-Identifier: BSD-3-Clause
# Shared by scripts/demo, scripts/fuzz, scripts/test and scripts/format; sourced, not run.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '%s\n' "== $*" >&2; }

stop() {
  printf '%s\n' "$*" >&2
  exit 2
}

# packages GROUP...: names of scripts/packages.txt that belong to one of the groups.
packages() {
  local group
  for group in "$@"; do
    awk -v group="$group" '$1 == group { print $2 }' "$root/scripts/packages.txt"
  done
}

# missing_packages NAME...: those that dpkg does not know as installed.
missing_packages() {
  local name
  for name in "$@"; do
    dpkg-query --show --showformat='${db:Status-Status}' "$name" 2>/dev/null | grep -qx installed || printf '%s\n' "$name"
  done
}

# install_packages GROUP...: installs what is missing with apt-get, quietly; its whole output is shown if it fails.
install_packages() {
  command -v dpkg-query >/dev/null || stop "This script sets up Debian and Ubuntu. Elsewhere install the counterparts of
scripts/packages.txt, then: cmake --workflow --preset release"
  local missing log as_root=()
  mapfile -t missing < <(missing_packages $(packages "$@"))
  [[ ${#missing[@]} -gt 0 ]] || return 0
  if [[ $(id -u) -ne 0 ]]; then
    command -v sudo >/dev/null || stop "These packages are missing, and only root can install them:
  apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing ${#missing[@]} packages: ${missing[*]}"
  log=$(mktemp)
  if ! "${as_root[@]}" apt-get -q update >"$log" 2>&1 ||
     ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends "${missing[@]}" \
       >>"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    stop "apt-get could not install what is missing; its own words are above."
  fi
  rm -f "$log"
}

# install_viewer: node and npm, from wherever they come; Debian's where there are none.
install_viewer() {
  command -v node >/dev/null && command -v npm >/dev/null || install_packages viewer
}

# install_browser: a Chromium to test the report with. Ubuntu has none as a package; those tests are skipped then.
install_browser() {
  local name
  for name in chromium chromium-browser google-chrome; do
    if command -v "$name" >/dev/null; then return 0; fi
  done
  if apt-cache show chromium 2>/dev/null | grep -q '^Filename'; then install_packages browser; fi
}

# warnings_of LOG: what CMake warned of, say that there will be no viewer.
warnings_of() { awk '/^CMake Warning/ { on = 1 } /^-- / { on = 0 } on' "$1"; }

# build PRESET [TARGET...]: configures and builds build/ or build-PRESET/; quiet unless something goes wrong.
build() {
  local preset=$1 log status=0
  shift
  say "building ($preset)"
  log=$(mktemp)
  if ! (cd "$root" && cmake --preset "$preset" && cmake --build --preset "$preset" ${1:+--target "$@"}) >"$log" 2>&1; then
    grep -E -A 20 'FAILED|CMake Error|error:' "$log" >&2 || cat "$log" >&2
    status=1
  else
    warnings_of "$log" >&2
  fi
  rm -f "$log"
  return $status
}

# fuzz_targets: the names of the readers that build-fuzz/ can fuzz.
fuzz_targets() {
  local target
  for target in "$root"/build-fuzz/fuzz/kilter_*_fuzz; do
    target=${target##*/kilter_}
    printf '%s\n' "${target%_fuzz}"
  done
}

# processor_seconds PID: what a process used so far, in user and system mode; fails once it is gone.
processor_seconds() {
  local stat
  read -r -a stat <"/proc/$1/stat" && echo $(((stat[13] + stat[14]) / $(getconf CLK_TCK)))
} 2>/dev/null

# fuzz_target NAME FOLDER RUNS SECONDS: throws mutated bytes at one reader of build-fuzz/, from its seeds with its
# dictionary, until it took RUNS inputs or SECONDS of its own processor time, so that a busy machine makes it no shorter.
# New inputs collect in FOLDER/corpus, libFuzzer's log and what it found in FOLDER. Fails if it found something. Leaves
# fuzz_runs, fuzz_cpu_seconds and fuzz_edges (of the program's control flow, seen so far).
fuzz_target() {
  local name=$1 folder=$2 runs=$3 seconds=$4 pid used status=0
  mkdir -p "$folder/corpus"
  "$root/build-fuzz/fuzz/kilter_${name}_fuzz" -dict="$root/fuzz/dictionaries/$name.dict" -runs="$runs" -timeout=10 \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$folder/" "$folder/corpus" "$root/fuzz/corpus/$name" \
    >"$folder/log" 2>&1 &
  pid=$!
  fuzz_cpu_seconds=0
  while used=$(processor_seconds $pid); do
    fuzz_cpu_seconds=$used
    # libFuzzer ends on this signal as it does after its last run: its numbers printed, status 0.
    if [[ $used -ge $seconds ]]; then kill -USR1 $pid; fi
    sleep 1
  done
  wait $pid || status=$?
  fuzz_runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$folder/log")
  fuzz_edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$folder/log" | tail -n 1)
  [[ $status -eq 0 ]] || tail -n 40 "$folder/log" >&2
  return $status
}
