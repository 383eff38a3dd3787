# shellcheck shell=bash
# What comparisons with other programs share, to be sourced: a peer is installed where that is allowed, else the
# comparison says why there is none, and passes.

peer_python=/usr/bin/python3 # of the packages, whatever else stands in PATH

skip() {
  echo "$(basename "$0" .sh): skipped: $1"
  exit 0
}

peer_install() {
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)
  [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || return 1
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends "$@"; } >/dev/null 2>&1 </dev/null
}

# peer_need FUNCTION PACKAGE...: the function fails, and says why, unless the packages are there and work.
peer_need() {
  local works=$1 why
  shift
  [ -x "$peer_python" ] || skip "there is no $peer_python"
  "$works" >/dev/null 2>&1 && return
  peer_install "$@" || skip "without $*, which could not be installed, there is no peer"
  why=$("$works" 2>&1) || skip "the peer does not work: ${why##*$'\n'}"
}
