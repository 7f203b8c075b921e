# SPDX-License-Identifier: Apache-2.0
#
# Shared by eval/run and tests/run: installs the packages of .ci/packages.txt that are missing (Debian, Ubuntu), then
# configures and builds a preset. Usage: build PRESET TARGET. Needs $root.

missing_packages() {
    local package
    sed -e 's/[[:space:]]*#.*//' -e '/^[[:space:]]*$/d' "$root/.ci/packages.txt" | while read -r package; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || echo "$package"
    done
}

install_packages() {
    command -v dpkg-query >/dev/null || return 0 # elsewhere CMake says what it misses
    local missing sudo=
    missing=$(missing_packages)
    [ -n "$missing" ] || return 0
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || { echo "missing packages: $missing" >&2; exit 1; }
        sudo=sudo
    fi
    echo "installing:" $missing >&2
    $sudo apt-get update -qq >&2
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2
}

build() (
    install_packages
    cd "$root" # presets are read from the working directory
    local log
    log=$(mktemp)
    # Configuring says nothing of interest unless it fails.
    cmake --preset "$1" >"$log" 2>&1 || { cat "$log" >&2; rm -f "$log"; exit 1; }
    rm -f "$log"
    cmake --build --preset "$1" --target "$2" >&2
)
