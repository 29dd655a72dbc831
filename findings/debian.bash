# Sourced by findings, at their first line: a temporary folder, and packages of Debian 12 unpacked into it, not installed.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# unpack PACKAGE VERSION: with all that it needs; sets version, usr, lib. Ends with status 77 if it cannot be had
# shellcheck disable=SC2034 # version is for those that source this
unpack() {
  version=$2 usr=$tmp/root/usr lib=$tmp/root/usr/lib/x86_64-linux-gnu libc=$tmp/root/lib/x86_64-linux-gnu
  mkdir -p lists/partial debs/partial root && : >status
  local mirror deb apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::State::Lists="$tmp/lists" -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp"
    -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
  # shellcheck disable=SC2016 # apt expands these
  mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
    sed -n '/security/d; s/^Debian //p' | head -n 1)
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
  { apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install "$1=$2"
  } >apt.log 2>&1 || { echo "Debian's $1 $2 cannot be had" >&2; exit 77; }
  for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done
}

# run PROGRAM ...: one of them, with their own libraries
run() {
  "$libc/ld-linux-x86-64.so.2" --library-path "$lib:$libc:$lib/blas:$lib/lapack" "$usr/bin/$1" "${@:2}"
}

# unpack_saga LIBRARY ...: SAGA with these of its tools, for saga TOOL ...
unpack_saga() {
  unpack saga 8.5.0+dfsg-2
  mkdir tools
  local one
  for one; do ln -s "$lib/saga/lib$one.so" tools; done
}
saga() {
  SAGA_TLB=$tmp/tools run saga_cmd --flags=s --cores=1 "$@" >>saga.log 2>&1 || { cat saga.log >&2; exit 1; }
}
