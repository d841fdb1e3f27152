# Sourced by demo, test and check: what Seampath needs from Debian 12, and how it is built. Not to be run by itself.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

build_packages=(g++ cmake ninja-build ccache libeigen3-dev nlohmann-json3-dev libcli11-dev zlib1g-dev libpng-dev
    libjpeg62-turbo-dev liblzf-dev libssl-dev libsqlite3-dev libjs-three libopencv-calib3d-dev libopencv-contrib-dev)
test_packages=(libgtest-dev libgmock-dev liborocos-kdl-dev chromium patch)
# Programs of others that our robot programs are held against. Many packages: without them their tests are skipped.
client_packages=(linuxcnc-uspace python3-geometry-msgs python3-trajectory-msgs python3-genpy)
check_packages=(clang clang-format clang-tidy)

say() { printf '%s\n' "$*" >&2; }
die() {
    say "$*"
    exit 2
}

# Prints those of the named packages that are not installed.
missing_packages() {
    local installed
    installed=" $(dpkg-query -W -f='${Package}:${db:Status-Status} ' "$@" 2>/dev/null || true)"
    for package in "$@"; do
        [[ $installed == *" $package:installed "* ]] || printf '%s ' "$package"
    done
}

# Installs what is missing of the named packages; does nothing, and needs no rights, when all are there.
install_packages() {
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
        die "setup: this machine has no apt-get; Seampath is built on Debian 12 from Debian's own packages"
    local missing
    read -ra missing <<<"$(missing_packages "$@")"
    ((${#missing[@]})) || return 0

    local as_root=()
    if ((EUID != 0)); then
        command -v sudo >/dev/null ||
            die "setup: these packages are missing: ${missing[*]}; there is no sudo here, so run as root:
    apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
        as_root=(sudo)
    fi
    as_root+=(env DEBIAN_FRONTEND=noninteractive)
    say "setup: installing ${missing[*]}"
    compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null || "${as_root[@]}" apt-get update -q >&2
    local install=("${as_root[@]}" apt-get install -y -q --no-install-recommends "${missing[@]}")
    # Package lists may be older than the archive: one more try with fresh ones.
    "${install[@]}" >&2 || { "${as_root[@]}" apt-get update -q >&2 && "${install[@]}" >&2; } ||
        die "setup: apt-get could not install: ${missing[*]}; its reason stands above"
}

# The same, but goes on without what can't be had.
try_packages() {
    (install_packages "$@") || say "setup: going on without: $*"
}

# What Debian has no package of, where there is npm: in FOLDER/npm, to which NODE_PATH leads from then on.
try_node_package() {
    local folder=$root/$1/npm package=$2
    if ! command -v npm >/dev/null; then
        say "setup: there is no npm; going on without $package"
        return 0
    fi
    npm install --prefix "$folder" --no-audit --no-fund --silent "$package" >&2 || say "setup: going on without $package"
    export NODE_PATH=$folder/node_modules
}

# As many compilers as there are cores, but each may need 1.2 GB.
build_jobs() {
    local cores available_kb by_memory
    cores=$(nproc)
    available_kb=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB$/\1/p' /proc/meminfo)
    by_memory=$((${available_kb:-1200000} / 1200000))
    ((by_memory >= 1)) || by_memory=1
    printf '%s' $((cores < by_memory ? cores : by_memory))
}

# build FOLDER TARGET [CMAKE_OPTION...]: configures FOLDER below the root and builds one target.
build() {
    local folder=$root/$1 target=$2
    shift 2
    cmake -S "$root" -B "$folder" -G Ninja --log-level=WARNING "$@" >&2
    ninja -C "$folder" -j "$(build_jobs)" "$target" >&2
}

# run_tests FOLDER: every test of a built folder; the last line is "N passed, N failed[, N skipped]".
run_tests() {
    local folder=$root/$1 summary=$root/$1/tests.xml status=0
    rm -f "$summary"
    ctest --test-dir "$folder" -j 2 --output-on-failure --output-junit "$summary" || status=$?
    [[ -s $summary ]] || die "test: ctest left no summary in $summary (exit status $status)"
    count() { sed -n "0,/$1=\"[0-9]*\"/s/.*$1=\"\([0-9]*\)\".*/\1/p" "$summary"; }
    local total failed skipped
    total=$(count tests)
    ((total > 0)) || die "test: ctest found no tests in $folder"
    failed=$(count failures)
    skipped=$(($(count skipped) + $(count disabled)))
    printf '%s passed, %s failed' $((total - failed - skipped)) "$failed"
    ((skipped == 0)) || printf ', %s skipped' "$skipped"
    printf '\n'
    return $((status != 0))
}
