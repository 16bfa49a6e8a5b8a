#!/bin/sh
# Installs from Debian's packages what Aureole needs and this machine lacks; does nothing when all is there.
#   docker/setup.sh build      compiler, libraries and esbuild: what ./run needs
#   docker/setup.sh test       the same, Catch2, gnuplot, Chromium and Node.js with the packages of web/: what ./test needs
#   docker/setup.sh runtime    only the shared libraries of a built aureole: what the Docker image needs
#   docker/setup.sh list WHAT  prints the names for build, test or runtime, one a line, and changes nothing
set -eu

# A word is a package; alternatives between bars are tried from the left (names differ between Debian releases).
build_packages="g++ cmake ninja-build pkg-config|pkgconf ccache esbuild \
 libbullet-dev libeigen3-dev libboost-dev libosmesa6-dev libgl-dev libturbojpeg0-dev libsodium-dev \
 nlohmann-json3-dev libflatbuffers-dev flatbuffers-compiler libcli11-dev libspdlog-dev libfmt-dev"
test_packages="catch2 libpng-dev procps chromium gnuplot-nox"
runtime_packages="libbullet3.24t64|libbullet3.24 libosmesa6 libturbojpeg0 libsodium23 libspdlog1.15|libspdlog1.10 libfmt10|libfmt9"

top=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)

say() { printf '%s\n' "set-up: $*" >&2; }
fail() { say "$*"; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

packages_for() {
  case "$1" in
    build) echo "$build_packages" ;;
    runtime) echo "$runtime_packages" ;;
    test)
      # Node.js often comes from elsewhere, and then has npm inside: Debian's npm would fight with it.
      node=
      have node || node="nodejs"
      have npm || node="$node npm"
      echo "$build_packages $test_packages $node"
      ;;
  esac
}

# Which of the words given have no installed package yet.
missing_of() {
  installed=" $(dpkg-query -W -f='${Package} ${db:Status-Status}\n' 2>/dev/null |
    awk '$2 == "installed" { printf "%s ", $1 }')"
  for word in "$@"; do
    found=
    rest=$word
    while [ -n "$rest" ]; do
      name=${rest%%|*}
      case "$installed" in *" $name "*) found=yes ;; esac
      case "$rest" in *'|'*) rest=${rest#*|} ;; *) rest= ;; esac
    done
    [ -n "$found" ] || printf '%s ' "$word"
  done
}

# The first alternative of each word that the package lists know; the last one if they know none.
names_of() {
  for word in "$@"; do
    rest=$word
    while :; do
      name=${rest%%|*}
      case "$rest" in *'|'*) rest=${rest#*|} ;; *) break ;; esac
      if [ -n "$(apt-cache show --no-all-versions "$name" 2>/dev/null)" ]; then break; fi
    done
    printf '%s ' "$name"
  done
}

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

apt() {
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=120 -o Acquire::Retries=3 \
    -o Dpkg::Use-Pty=0 -o Dpkg::Options::=--force-confold "$@" >>"$log" 2>&1
}

fail_with_log() {
  tail -n 12 "$log" >&2
  fail "$*"
}

install_packages() {
  what=$1
  have dpkg-query && have apt-get ||
    fail "this system has no apt; Aureole is set up on Debian 12 and 13. By hand you need: $(packages_for "$what")"
  # shellcheck disable=SC2046
  missing=$(missing_of $(packages_for "$what"))
  [ -n "$missing" ] || return 0

  system=$(. /etc/os-release 2>/dev/null && echo "${ID:-unknown} ${VERSION_ID:-}")
  case "$system" in
    'debian 12' | 'debian 13') ;;
    *) fail "Debian 12 or 13 is needed to install by itself, and this is '$system'. Install by hand and start again: $missing" ;;
  esac
  if [ "$(id -u)" != 0 ] && ! have sudo; then
    fail "packages are missing and there is no sudo. As root, run: apt-get install --no-install-recommends $missing"
  fi

  log=$(mktemp)
  trap 'rm -f "$log"' EXIT
  updated=
  if ! ls /var/lib/apt/lists/*_Packages* >/dev/null 2>&1; then
    say "fetching Debian's package lists"
    apt update || fail_with_log "Debian's package lists could not be fetched; is there a network?"
    updated=yes
  fi
  # shellcheck disable=SC2086
  names=$(names_of $missing)
  say "installing from Debian: ${names% }"
  say "(the first time this takes a few minutes)"
  # shellcheck disable=SC2086
  if ! apt install --no-install-recommends $names; then
    [ -z "$updated" ] || fail_with_log "apt-get install failed; the lines above say why. Missing: $names"
    say "that failed with the package lists at hand; fetching new ones"
    apt update || fail_with_log "Debian's package lists could not be fetched; is there a network?"
    # shellcheck disable=SC2086
    names=$(names_of $missing)
    # shellcheck disable=SC2086
    apt install --no-install-recommends $names ||
      fail_with_log "apt-get install failed; the lines above say why. Missing: $names"
  fi
  rm -f "$log"
}

# The browser tests' packages, exactly as the lock file names them; no browser is downloaded.
install_node_packages() {
  lock=$top/web/package-lock.json
  done_file=$top/web/node_modules/.package-lock.json
  [ -f "$lock" ] || return 0
  if [ -f "$done_file" ] && [ ! "$lock" -nt "$done_file" ]; then return 0; fi
  say "installing the packages of web/package-lock.json with npm"
  (cd "$top/web" && PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm ci --no-audit --no-fund --loglevel=error >&2) ||
    fail "npm ci failed in web/; is there a network to registry.npmjs.org?"
  touch "$done_file"
}

case "$*" in
  build | runtime) install_packages "$1" ;;
  test)
    install_packages test
    install_node_packages
    ;;
  'list build' | 'list test' | 'list runtime') packages_for "$2" | tr -s ' ' '\n' ;;
  *) fail "say build, test or runtime, or list and one of these (found '$*')" ;;
esac
