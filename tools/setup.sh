#!/bin/bash
# Makes a Debian or Ubuntu machine ready to build: installs what is missing of tools/packages.txt, then
# fetches the LAMMPS source of the running release into .lammps/source. Removes no package; an optional
# package that cannot be installed is skipped with a message.
# LAMMPS_SOURCE_DIR=<tree> in the environment: that tree is used, and none is fetched.
set -euo pipefail
export LC_ALL=C DEBIAN_FRONTEND=noninteractive

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
source_dir=$top/.lammps/source

say() { echo "setup: $*"; }
die() { echo "setup: error: $*" >&2; exit 1; }
# shellcheck source=/dev/null
. "$top/tools/upstream_source.sh"
# a mirror may be slow for a moment
update() { "$@" update || { say "apt-get update failed, trying again"; sleep 5; "$@" update; }; }

# --- packages ---

# names [optional]: of tools/packages.txt, in this release; with "optional" those that set-up does without
# shellcheck source=/dev/null
suite=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
names() {
  sed 's/#.*//' "$top/tools/packages.txt" | awk -v suite="$suite" -v optional="${1:-}" '
    NF && (!optional || / without: /) {
      name = $1
      for (i = 2; i <= NF && $i != "without:"; i++)
        if (index($i, suite "=") == 1) name = substr($i, length(suite) + 2)
      if (name != "-") print name
    }'
}
# what is lost without a package
lost() {
  sed 's/#.*//' "$top/tools/packages.txt" | grep -E "(^|=)$1 " | sed -n 's/.* without: *//p' | sed 's/ *$//'
}
# not installed, of these; dpkg-query fails when it does not know one of them
absent() {
  local there
  there=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^installed //p') || true
  printf '%s\n' "$@" | grep -vxF "$there" || true
}
# whether apt-get can install these and remove nothing
possible() { apt-get -qq -s -o Debug::NoLocking=1 --no-remove --no-install-recommends install "$@" >/dev/null 2>&1; }

# why_not PACKAGE: in a few words
why_not() {
  local said removed excludes needs other
  said=$(apt-get -s -o Debug::NoLocking=1 --no-install-recommends install "$1" 2>&1) || true
  removed=$(sed -n 's/^Remv \([^ ]*\).*/\1/p' <<<"$said" | xargs)
  # " python3-paraview : Conflicts: python3-vtk9 but 9.1.0 is to be installed"
  excludes=$(sed -n -E 's/^ *([^ ]+) : (Conflicts|Breaks): ([^ ]+) .*/\1, which is installed, excludes \3/p;' <<<"$said" |
    head -n 1)
  # what it needs and does not get; and who is installed that excludes that
  needs=$(sed -n 's/.* Depends: \([^ ]*\).*/\1/p' <<<"$said" | head -n 1)
  other=$(dpkg-query -W -f '${db:Status-Status} ${Package}: ${Conflicts}, ${Breaks}\n' 2>/dev/null |
    sed -n 's/^installed //p' | grep -E "[:,] *${needs:-$1}( |,|$)" | head -n 1) || true
  if [[ -n $removed ]]; then
    echo "it would remove $removed"
  elif [[ -n $excludes ]]; then
    echo "$excludes"
  elif [[ -n $other ]]; then
    echo "${other%%:*}, which is installed, excludes ${needs:-$1}"
  elif [[ -n $needs ]]; then
    echo "$needs, which it needs, cannot be installed"
  else
    sed -n '/^E: /{s///p;q}' <<<"$said"
  fi
}

mapfile -t missing < <(mapfile -t all < <(names) && absent "${all[@]}")
mapfile -t optional < <(names optional)
is_optional() { [[ " ${optional[*]} " == *" $1 "* ]]; }

if ((${#missing[@]})); then
  as_root=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || die "not root and no sudo, cannot install: ${missing[*]}"
    as_root=(sudo "DEBIAN_FRONTEND=$DEBIAN_FRONTEND")
  fi
  say "packages that are missing: ${#missing[@]}; apt-get installs them${as_root:+, and sudo may ask for your password}." \
    "On a bare machine, with the LAMMPS source and the build: about 0.9 GB (Debian 12) or 1 GB (Debian 13)" \
    "to download, 3.8 or 4.1 GB of disk"
  # the failure may concern other packages only: the installation below will show
  update "${as_root[@]}" apt-get -qq || say "apt-get update failed, trying to continue"

  # as many as can be had: first what all need, then one by one what set-up does without
  wanted=("${missing[@]}")
  if ! possible "${wanted[@]}"; then
    wanted=()
    for package in "${missing[@]}"; do
      is_optional "$package" || wanted+=("$package")
    done
    if ((${#wanted[@]})) && ! possible "${wanted[@]}"; then
      for package in "${wanted[@]}"; do
        possible "$package" || die "apt-get cannot install $package: $(why_not "$package")"
      done
      die "apt-get can install each of these, but not all: ${wanted[*]}"
    fi
    for package in "${missing[@]}"; do
      if ! is_optional "$package"; then
        continue
      elif possible "${wanted[@]}" "$package"; then
        wanted+=("$package")
      else
        say "$package is left out, $(why_not "$package"): $(lost "$package")"
      fi
    done
  fi
  if ((${#wanted[@]})); then
    # "Need to get 1 MB of archives." "After this operation, 2 MB of additional disk space will be used."
    sizes=$(apt-get -o Debug::NoLocking=1 --assume-no --no-install-recommends install "${wanted[@]}" 2>/dev/null |
      sed -n -E 's/^Need to get ([^/]*\/)?(.* [kMG]?B) of archives.*/\2 to download/p
        s/^After this operation, (.* [kMG]?B) of additional.*/\1 on disk/p' | paste -sd, | sed 's/,/, /') || true
    say "installing ${wanted[*]}${sizes:+ ($sizes)}"
    status=0
    "${as_root[@]}" apt-get -qq -y -o Dpkg::Use-Pty=0 -o Acquire::Retries=3 --no-remove --no-install-recommends \
      install "${wanted[@]}" || status=$?
    mapfile -t failed < <(absent "${wanted[@]}")
    for package in "${failed[@]}"; do
      is_optional "$package" || die "apt-get could not install: ${failed[*]} (status $status;" \
        "$((${#wanted[@]} - ${#failed[@]})) of ${#wanted[@]} are installed)." \
        "Run it again; if it says the same: dpkg --configure -a, apt-get -f install"
    done
    for package in "${failed[@]}"; do
      say "$package could not be installed (apt-get ended with status $status): $(lost "$package")"
    done
    ((status == 0 || ${#failed[@]})) || say "apt-get ended with status $status, but all of these are installed"
  fi
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

say "fetching the LAMMPS source package of this release (80 MB)"
mkdir -p "$top/.lammps"
tmp=$(mktemp -d "$top/.lammps/tmp.XXXXXX")
trap 'rm -rf "$tmp"' EXIT
mkdir -p "$tmp/lists/partial" "$tmp/sources" "$tmp/work"

# apt with its state in $tmp: needs no root, and changes nothing on the machine. As root, apt
# would download as another user, who cannot write there.
apt_options=(-qq -o Dir::State::lists="$tmp/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=
  -o APT::Sandbox::User=root -o APT::Update::Error-Mode=any)
apt_get() { apt-get "${apt_options[@]}" "$@"; }

# "file:number" of each Debian or Ubuntu entry in the machine's list of sources
entries() {
  # shellcheck disable=SC2016 # apt expands these
  "$@" indextargets --format '$(ORIGIN) $(SOURCESENTRY)' 'Created-By: Packages' |
    sed -n -E 's/^(Debian|Ubuntu) //p' | sort -u
}

entries=$(entries apt-get)
if [[ -z $entries ]]; then # apt knows the origin only after an update
  update apt_get || say "apt-get update failed, trying to continue"
  entries=$(entries apt_get)
fi
[[ -n $entries ]] || die "no entry of Debian or Ubuntu among apt's sources"

# The same entries, for source packages: mirror, key and options stay what they are. The number
# is that of a line in a .list, and of a stanza, comments not counted, in a .sources file.
while IFS=: read -r file number; do
  if [[ $file == *.sources ]]; then
    sed -e 's/\r$//' -e '/^#/d' "$file" |
      awk -v number="$number" 'BEGIN { RS = "" } /[^ \t\n]/ && ++n == number { print $0 "\n" }' |
      sed -E 's/^Types:.*/Types: deb-src/I' >>"$tmp/sources/own.sources"
  else
    sed -n -E "${number}s/^[[:space:]]*deb([[:space:]])/deb-src\1/p" "$file" \
      >>"$tmp/sources/own.list"
  fi
done <<<"$entries"

from_source=(-o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$tmp/sources")
update apt_get "${from_source[@]}" || die "apt-get update for source packages failed"
# apt checks the checksums, dpkg-source unpacks and applies Debian's patches
if (cd "$tmp/work" && apt_get "${from_source[@]}" source lammps >"$tmp/log" 2>&1); then
  mv -T "$tmp"/work/lammps-*/ "$source_dir"
else
  # a mirror that lost a file of the package may still have LAMMPS' own archive
  why=$(reason "$tmp/log")
  say "apt-get source lammps failed ($why), trying the upstream archive alone, without Debian's patches"
  upstream_source lammps "$tmp" "${apt_options[@]}" "${from_source[@]}" ||
    die "apt-get source lammps failed: $why; the upstream archive: $(reason "$tmp/log")"
  mv -T "$tmp/tree" "$source_dir"
fi
say "LAMMPS source: $source_dir"
