# Sourced by the scripts in tools/: set-up of a fresh Debian 12, and the frame in which a script runs its stages.
# Sourcing it goes to the root of the source tree.

set -euo pipefail
readonly started_in=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Where ccache is installed, a second checkout profits from what was compiled in the first.
export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1

script_name=$(cd "$started_in" && realpath --relative-to="$OLDPWD" "$0")
readonly script_name
advice="read the lines above."
trap 'end_of_script $?' EXIT

# What is printed last when the script failed: one sentence that says what to do. A script may define before_end to
# say more before it.
end_of_script() {
  local status=$1
  if declare -F before_end >/dev/null; then before_end; fi
  if ((status != 0)); then echo "${script_name}: failed in '${stage:-start}': ${advice}" >&2; fi
}

# stage <name> <advice>: what runs from here on, and what to do when it fails.
stage() {
  stage=$1
  advice=$2
  printf '\n== %s (%ds)\n' "$stage" "$SECONDS"
}

# The page of study reports is built with npm. Where npm is not Debian's, Debian's could not be installed beside it.
report_packages=()
command -v npm >/dev/null || report_packages=(npm)
readonly build_packages=(
  g++ cmake ninja-build libtbb-dev libhwy-dev libcli11-dev nlohmann-json3-dev libfmt-dev
  libboost-dev zlib1g-dev liblzma-dev libzstd-dev "${report_packages[@]}")
readonly test_packages=(libgtest-dev libeigen3-dev librapidcheck-dev libbenchmark-dev libbullet-dev)
readonly fuzz_packages=(clang-14 libclang-rt-14-dev llvm-14)

# install_packages <package>...: asks apt for those that are missing, and for nothing when none is.
install_packages() {
  stage "set-up" "install the packages that are named above by hand, then run it again."
  local package missing=()
  if ! command -v apt-get >/dev/null; then
    echo "no apt-get here: taking it that what these packages hold is installed: $*"
    return
  fi
  local architecture
  architecture=$(dpkg --print-architecture)
  for package in "$@"; do
    # It may be there for other architectures, too.
    if ! dpkg-query --show --showformat='${Architecture} ${db:Status-Status}\n' "$package" 2>/dev/null |
      grep -xE "($architecture|all) installed" >/dev/null; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then
    echo "all packages are installed"
    return
  fi
  echo "installing ${missing[*]}"
  local as_root=()
  if ((EUID != 0)); then
    advice="become root or install sudo, then run it again."
    command -v sudo >/dev/null
    as_root=(sudo)
    advice="install the packages that are named above by hand, then run it again."
  fi
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends "${missing[@]}" \
    >/dev/null
}

# build <preset> [<option>...]: configures, with options for cmake, and builds.
build() {
  cmake --preset "$1" --log-level=WARNING "${@:2}"
  cmake --build --preset "$1" -j "$(nproc)"
}
