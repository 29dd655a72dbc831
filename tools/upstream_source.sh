# shellcheck shell=bash
# Sourced by tools/setup.sh, tests/matrix.sh and tests/tools/test_newer_lammps.py.

# reason LOG: why a command failed: its first line that is an error of apt, else its last one.
reason() {
  awk '/^E: / && !error { error = substr($0, 4) } NF { last = $0 }
    END { print error ? error : last ? last : "without a message" }' "$1"
}

# unpack_source ARCHIVE TMP: a LAMMPS archive, with or without a folder around it, into TMP/tree. Most of its size is examples
# and potentials, which stay behind. Fails with a line in TMP/log.
unpack_source() {
  local archive=$1 tmp=$2 found
  mkdir -p "$tmp/unpacked"
  tar -xf "$archive" -C "$tmp/unpacked" --no-same-owner --exclude='examples/*' --exclude='potentials/*' \
    --exclude='bench/*' --exclude='unittest/*' --exclude='doc/src/*' 2>"$tmp/log" || return 1
  found=("$tmp"/unpacked/cmake "$tmp"/unpacked/*/cmake)
  [[ -d ${found[0]} ]] || found=("${found[@]:1}")
  if [[ ! -e ${found[0]}/CMakeLists.txt ]]; then
    echo "E: no LAMMPS source tree in $archive" >"$tmp/log"
    return 1
  fi
  mv -T "$(dirname "${found[0]}")" "$tmp/tree"
}

# upstream_source PACKAGE TMP OPTION...: unpack the upstream archive of a Debian source package (NAME or NAME/SUITE), without
# Debian's patches, into TMP/tree. The options are apt's. apt checks the checksum. Fails with apt's words in TMP/log.
upstream_source() {
  local package=$1 tmp=$2 uri file sum
  shift 2
  apt-get "$@" source --print-uris "$package" >"$tmp/uris" 2>"$tmp/log" || return 1
  if ! read -r uri file _ sum < <(grep '\.orig\.tar' "$tmp/uris"); then
    echo "E: no upstream archive of $package" >"$tmp/log"
    return 1
  fi
  uri=${uri#\'}
  /usr/lib/apt/apt-helper "$@" download-file "${uri%\'}" "$tmp/$file" "$sum" >"$tmp/log" 2>&1 || return 1
  unpack_source "$tmp/$file" "$tmp"
}

# debian_source SUITE TARGET: the LAMMPS of a Debian release into the folder TARGET, unless it is there, from the mirror that
# this machine's apt uses, by apt with its state in a temporary folder. Fails with one line.
debian_source() (
  suite=$1 target=$2
  [[ -d $target ]] && exit
  mkdir -p "$(dirname "$target")"
  tmp=$(mktemp -d "$(dirname "$target")/tmp.XXXXXX")
  # shellcheck disable=SC2064 # this folder
  trap "rm -rf '$tmp'" EXIT
  fail() { echo "Debian $suite: $(reason "$tmp/log")" >&2; exit 1; }
  mkdir -p "$tmp/lists/partial" "$tmp/sources"

  # shellcheck disable=SC2016 # apt expands these
  mirror=$(apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
    sed -n 's/^Debian [a-z]* //p' | head -n 1)
  if [[ -z $mirror ]]; then
    echo "E: no Debian mirror among apt's sources (apt-get update may help)" >"$tmp/log"
    fail
  fi
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $suite main" \
    >"$tmp/sources/debian.list"

  apt=(-q -o Dir::State::lists="$tmp/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=
    -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any
    -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$tmp/sources")
  apt-get "${apt[@]}" update >"$tmp/log" 2>&1 || fail
  upstream_source "lammps/$suite" "$tmp" "${apt[@]}" || fail
  mv -T "$tmp/tree" "$target"
)
