#!/bin/bash
# Makes a Debian machine ready to build: installs what is missing of tools/packages.txt, then
# fetches the LAMMPS source of the running Debian release into .lammps/source.
# LAMMPS_SOURCE_DIR=<tree> in the environment: that tree is used, and none is fetched.
set -euo pipefail
export LC_ALL=C DEBIAN_FRONTEND=noninteractive

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source_dir=$top/.lammps/source

say() { echo "setup: $*"; }
die() { echo "setup: error: $*" >&2; exit 1; }
# a mirror may be slow for a moment
update() { "$@" update || { say "apt-get update failed, trying again"; sleep 5; "$@" update; }; }

# --- packages ---

mapfile -t packages < <(sed 's/#.*//' "$top/tools/packages.txt" | xargs -n1)
# dpkg-query fails when it does not know one of them: then that one is missing
installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null |
  sed -n 's/^installed //p') || true
mapfile -t missing < <(printf '%s\n' "${packages[@]}" | grep -vxF "$installed")

if ((${#missing[@]})); then
  as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "not root and no sudo, cannot install: ${missing[*]}"
    as_root=(sudo "DEBIAN_FRONTEND=$DEBIAN_FRONTEND")
  fi
  say "installing ${missing[*]}"
  # what failed may have nothing to do with us: install tells
  update "${as_root[@]}" apt-get -qq || say "apt-get update failed, trying to go on"
  "${as_root[@]}" apt-get -qq -y -o Dpkg::Use-Pty=0 --no-install-recommends install "${missing[@]}" ||
    die "apt-get could not install: ${missing[*]}"
else
  say "no package is missing"
fi

# --- LAMMPS source ---

if [[ -n ${LAMMPS_SOURCE_DIR:-} ]]; then
  [[ -e $LAMMPS_SOURCE_DIR/cmake/CMakeLists.txt ]] ||
    die "LAMMPS_SOURCE_DIR=$LAMMPS_SOURCE_DIR is no LAMMPS source tree"
  say "LAMMPS source: $LAMMPS_SOURCE_DIR, from LAMMPS_SOURCE_DIR; none is fetched"
  exit
fi
if [[ -d $source_dir ]]; then # is renamed to this when complete
  say "LAMMPS source: $source_dir"
  exit
fi

say "fetching the LAMMPS source package of this Debian release (80 MB)"
mkdir -p "$top/.lammps"
tmp=$(mktemp -d "$top/.lammps/tmp.XXXXXX")
trap 'rm -rf "$tmp"' EXIT
mkdir -p "$tmp/lists/partial" "$tmp/sources" "$tmp/work"

# apt with its state in $tmp: needs no root, and changes nothing on the machine. As root, apt
# would download as another user, who cannot write there.
apt_get() {
  apt-get -qq -o Dir::State::lists="$tmp/lists" -o Dir::Cache::pkgcache= \
    -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any "$@"
}

# "file:number" of each Debian entry in the machine's list of sources
debian_entries() {
  # shellcheck disable=SC2016 # apt expands these
  "$@" indextargets --format '$(ORIGIN) $(SOURCESENTRY)' 'Created-By: Packages' |
    sed -n 's/^Debian //p' | sort -u
}

entries=$(debian_entries apt-get)
if [[ -z $entries ]]; then # apt knows the origin only after an update
  update apt_get || say "apt-get update failed, trying to go on"
  entries=$(debian_entries apt_get)
fi
[[ -n $entries ]] || die "no Debian entry among apt's sources"

# The same entries, for source packages: mirror, key and options stay what they are. The number
# is that of a line in a .list, and of a stanza, comments not counted, in a .sources file.
while IFS=: read -r file number; do
  if [[ $file == *.sources ]]; then
    sed -e 's/\r$//' -e '/^#/d' "$file" |
      awk -v number="$number" 'BEGIN { RS = "" } /[^ \t\n]/ && ++n == number { print $0 "\n" }' |
      sed -E 's/^Types:.*/Types: deb-src/I' >>"$tmp/sources/debian.sources"
  else
    sed -n -E "${number}s/^[[:space:]]*deb([[:space:]])/deb-src\1/p" "$file" \
      >>"$tmp/sources/debian.list"
  fi
done <<<"$entries"

from_source=(-o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$tmp/sources")
update apt_get "${from_source[@]}" || die "apt-get update for source packages failed"
# apt checks the checksums, dpkg-source unpacks and applies Debian's patches
(cd "$tmp/work" && apt_get "${from_source[@]}" source lammps >"$tmp/log" 2>&1) ||
  die "apt-get source lammps failed: $(tail -n 1 "$tmp/log")"
mv -T "$tmp"/work/lammps-*/ "$source_dir"
say "LAMMPS source: $source_dir"
