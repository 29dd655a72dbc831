#!/bin/bash
# The two commands of the README, tools/demo.sh and tests/run.sh, on machines that have nothing: for each release and way a
# chroot is made by mmdebstrap from the mirror that this machine's apt uses, the tree's last commit is copied into it, and the
# commands run there. Then a table. Needs root, mmdebstrap and 6 GB of disk; a machine is removed when its row is printed.
#
#   tests/machines.sh [--release RELEASE]... [--way WAY]... [--tests REGEX] [--ccache] [--keep] [-o DIR] [TREE]
#
# --release  debian-12, debian-13, debian-sid, ubuntu-22.04, ubuntu-24.04, see machines/releases.txt (default: the first two)
# --way      bare       nothing but the release's smallest system (default)
#            user       the same, by a user who has sudo instead of root, as in WSL
#            paraview   with paraview and python3-paraview, which exclude python3-vtk9
#            yade       with yade
#            deb, tar   the packages that cpack made in "bare", installed on a machine that has no checkout
# --tests    for tests/run.sh: a regular expression of ctest's names, "short" (the short run, half an hour and more), "all"
#            (with --all, hours), or "none"; default unit
# --ccache   keep what the compiler makes in DIR/cache: the second build of a release takes a minute
# --keep     keep the machines in DIR/RELEASE-WAY
# --mirror   URI of the mirror, for a distribution that this machine's apt does not have
# --list     print the releases and ways, and whether there is a mirror
# -o DIR     output folder: logs, the packages, the cache (default: build/machines)
# TREE       the checkout (default: this one)
# JOBS=<n>   number of compilers, and of tests, at a time (default 2)
#
# Exit status: 0 if all went well, 1 if not, 2 for wrong arguments or a machine that cannot do this.
set -euo pipefail
export LC_ALL=C

top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tree=$top out=$top/build/machines tests=unit mirror='' ccache='' keep='' list=''
all_ways=(bare user paraview yade deb tar)
releases=() ways=()

die() { echo "machines: $*" >&2; exit 2; }

# --- table of releases ---

# lookup RELEASE: its fields as variables; fails for a release that the table does not have
lookup() {
  local line
  line=$(sed 's/#.*//' "$top/tests/machines/releases.txt" | awk -v name="$1" '$1 == name')
  [[ -n $line ]] || return 1
  read -r _ distribution suite components keyring tried <<<"$line"
}
mapfile -t known < <(sed 's/#.*//' "$top/tests/machines/releases.txt" | awk 'NF { print $1 }')

# uri SUITE-REGEX: of the first entry of this distribution, in apt's own list, whose suite is so
uri() {
  # shellcheck disable=SC2016 # apt expands these
  apt-get indextargets --format '$(ORIGIN) $(CODENAME) $(REPO_URI)' 'Created-By: Packages' |
    awk -v origin="$distribution" -v suite="$1" '$1 == origin && $2 ~ suite { print $3; exit }'
}

# mirrors: lines for the sources.list of the release that was looked up
mirrors() {
  local main=${mirror:-$(uri '^[a-z]*$')} security
  security=$(uri '-security$')
  [[ -n $main ]] || return 1
  local what="deb [signed-by=/usr/share/keyrings/${keyring#*/}.gpg]"
  if [[ $suite == sid ]]; then # has no updates but itself, and of a mirror's copy the day does not matter
    echo "${what/]/ check-valid-until=no]} $main $suite ${components//,/ }"
    return
  fi
  echo "$what $main $suite ${components//,/ }"
  echo "$what $main $suite-updates ${components//,/ }"
  [[ -z $security || -n $mirror ]] || echo "$what $security $suite-security ${components//,/ }"
}

# --- arguments ---

while (($#)); do
  case $1 in
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "${BASH_SOURCE[0]}"; exit ;;
    --release | --way | --tests | --mirror | -o)
      (($# > 1)) || die "$1: value is missing"
      case $1 in
        --release) lookup "$2" || die "--release must be one of ${known[*]}, got $2"
                   releases+=("$2") ;;
        --way) [[ " ${all_ways[*]} " == *" $2 "* ]] || die "--way must be one of ${all_ways[*]}, got $2"
               ways+=("$2") ;;
        --tests) tests=$2 ;;
        --mirror) mirror=$2 ;;
        -o) out=$2 ;;
      esac
      shift 2 ;;
    --ccache) ccache=1; shift ;;
    --keep) keep=1; shift ;;
    --list) list=1; shift ;;
    -*) die "unknown option $1, see --help" ;;
    *) tree=$1; shift ;;
  esac
done
if [[ -n $list ]]; then
  for release in "${known[@]}"; do
    lookup "$release"
    printf '%-14s %-9s %-8s %s\n' "$release" "$suite" "$tried" "$(mirrors >/dev/null && echo "has a mirror" || echo "no mirror")"
  done
  exit
fi
((${#releases[@]})) || releases=(debian-12 debian-13)
((${#ways[@]})) || ways=(bare)

git -C "$tree" rev-parse --verify -q HEAD >/dev/null 2>&1 || die "TREE $tree is no git checkout with a commit"
((EUID == 0)) || die "must be root, for chroots: sudo tests/machines.sh ..."
command -v mmdebstrap >/dev/null || die "mmdebstrap is not there: apt-get install mmdebstrap"
unshare --mount --pid --fork true 2>/dev/null || die "this machine does not permit mount namespaces"
mkdir -p "$out/cache"
out=$(realpath "$out")
space=$(df --output=avail -BG "$out" | tr -dc 0-9)
((space >= 6)) || die "needs 6 GB of disk in $out, there are $space"

# --- a machine ---

current=
# shellcheck disable=SC2317 # trap calls it
clean() { [[ -z $current ]] || rm -rf --one-file-system "$current"; }
trap clean EXIT
trap 'exit 130' INT TERM

# make RELEASE TARGET: the smallest system of a release, from a tarball if one was made before
make() {
  local tarball=$out/cache/$1.tar proxy options=()
  if [[ ! -e $tarball ]]; then
    while read -r proxy; do
      options+=(--aptopt "$proxy")
    done < <(apt-config dump | grep -iE '^Acquire::https?::Proxy ')
    mirrors >"$out/cache/$1.list"
    grep -q ' https:' "$out/cache/$1.list" && options+=(--include ca-certificates)
    mapfile -t lines <"$out/cache/$1.list"
    mmdebstrap --variant=minbase "${options[@]}" "$suite" "$tarball.part" "${lines[@]}" --format=tar || return 1
    mv "$tarball.part" "$tarball"
  fi
  mkdir -p "$2" && tar -xf "$tarball" -C "$2" --numeric-owner
}

# enter ROOT COMMAND...: in namespaces of its own, so that all mounts and processes end with it
enter() {
  local root=$1 debs=$out/cache/debs-$suite compiled=$out/cache/ccache-$suite
  shift
  mkdir -p "$debs/partial" "$compiled" "$root"/{results,packages,var/cache/compiled}
  # shellcheck disable=SC2016,SC2034 # expanded inside
  ROOT=$root DEBS=$debs COMPILED=$compiled PACKAGES=$out/packages-$suite \
    unshare --mount --pid --fork --kill-child bash -c '
      mount -t proc proc "$ROOT/proc" && mount --rbind /sys "$ROOT/sys" && mount --rbind /dev "$ROOT/dev" &&
        mount --bind "$DEBS" "$ROOT/var/cache/apt/archives" &&
        mount --bind "$COMPILED" "$ROOT/var/cache/compiled" || exit 1
      [ ! -d "$PACKAGES" ] || mount --bind "$PACKAGES" "$ROOT/packages"
      exec chroot "$ROOT" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
        HOME=/root TERM=dumb JOBS="${JOBS:-2}" ${CCACHE:+CCACHE_DIR=/var/cache/compiled} "$@"' enter "$@"
}

# --- a row of the table ---

row() { printf '%-13s %-9s %-8s %-7s %-22s %9s %9s %9s  %s\n' "$@" | tee -a "$out/table.txt"; }

# of STEP in this row's steps: status, or "-"; seconds, or "-"
status_of() { awk -v step="$1" '$1 == step { s = $2 } END { print s == "" ? "-" : s }' "$results/steps"; }
seconds_of() { awk -v step="$1" '$1 == step { s = $3 } END { print s == "" ? "-" : s }' "$results/steps"; }
word() { case $1 in -) echo - ;; 0) echo ok ;; *) echo FAILED ;; esac; }

# the counts of tests/run.sh's last line, or of ctest's
counts() {
  [[ -e $results/tests.log ]] || { echo -; return; }
  sed -nE 's/.*, ([0-9]+) tests failed out of ([0-9]+)/\2 tests, \1 failed/p; s/^([0-9]+) passed, ([0-9]+) failed.*/\1 passed, \2 failed/p' \
    "$results/tests.log" | tail -n 1 | grep . || echo "no count"
}

# one RELEASE WAY
one() {
  local release=$1 way=$2 status=0 set_up notes
  lookup "$release"
  results=$out/$release-$way.results
  rm -rf "$results"
  mkdir -p "$results"
  : >"$results/steps"
  if ! mirrors >/dev/null; then
    row "$release" "$way" untried - - - - - "no mirror of $distribution among apt's sources: --mirror URI"
    return 0
  fi
  if [[ ! -e /usr/share/keyrings/${keyring#*/}.gpg ]]; then
    row "$release" "$way" untried - - - - - "keys of $distribution are missing: apt-get install ${keyring%/*}"
    return 0
  fi
  if [[ $way == deb || $way == tar ]] && ! compgen -G "$out/packages-$suite/slope-*" >/dev/null; then
    row "$release" "$way" FAILED - - - - - "no packages of $suite: run --way bare first"
    return 1
  fi

  current=$out/$release-$way
  rm -rf --one-file-system "$current"
  if ! make "$release" "$current" >"$results/make.log" 2>&1; then
    row "$release" "$way" FAILED - - - - - "mmdebstrap: $(grep '^E:' "$results/make.log" | tail -n 1)"
    return 1
  fi
  cp /etc/resolv.conf "$current/etc/resolv.conf"
  echo force-unsafe-io >"$current/etc/dpkg/dpkg.cfg.d/machines" # nothing to lose if the power fails
  if [[ $way != deb && $way != tar ]]; then
    git clone -q --no-hardlinks "$tree" "$current/srv/slope"
    git -C "$current/srv/slope" remote remove origin
  fi
  cp "$top/tests/machines/inside.sh" "$current/root/inside.sh"
  CCACHE=$ccache enter "$current" bash /root/inside.sh "$way" "$tests" >"$results/inside.log" 2>&1 || status=1
  cp -r "$current/results/." "$results"
  if compgen -G "$results/slope-*" >/dev/null; then
    mkdir -p "$out/packages-$suite"
    rm -f "$out/packages-$suite"/*
    mv "$results"/slope-* "$out/packages-$suite"
  fi
  report_row "$release" "$way" "$status"
}

# report_row RELEASE WAY STATUS: what the steps say
report_row() {
  local release=$1 way=$2 status=$3 set_up=FAILED left_out='' notes
  if [[ $way == deb || $way == tar ]]; then
    set_up=$(word "$(status_of given)")
    sed -i 's/^given /set-up /' "$results/steps"
  elif grep -q '^setup: LAMMPS source: ' "$results/demo.log" 2>/dev/null; then
    left_out=$(sed -n 's/^setup: \([^ ]*\) is left out.*/\1/p' "$results/demo.log" | xargs)
    set_up=ok
  fi
  awk '$2 != 0 { bad = 1 } END { exit bad || NR == 0 }' "$results/steps" || status=1
  notes=${left_out:+without $left_out}
  ((status == 0)) || notes+="${notes:+; }$results: $(awk '$2 != 0 { print $1 ".log" }' "$results/steps" | xargs)"
  notes="$(du -xsm "$current" | cut -f 1) MB of disk${notes:+; $notes}"
  row "$release" "$way" "$set_up" "$(word "$(status_of demo)")" "$(counts)" \
    "$(seconds_of set-up)" "$(seconds_of demo)" "$(seconds_of tests)" "$notes"
  if [[ -z $keep ]]; then
    rm -rf --one-file-system "$current"
  fi
  current=
  return "$status"
}

# in one piece: the script may change while it runs
main() {
  local status=0 release way
  : >"$out/table.txt"
  row release way set-up demo tests set-up,s demo,s tests,s notes
  for release in "${releases[@]}"; do
    for way in "${ways[@]}"; do
      one "$release" "$way" || status=1
    done
  done
  exit "$status"
}
main
