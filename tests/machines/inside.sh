#!/bin/bash
# Runs inside a machine that tests/machines.sh made, as root: gives it what the way says, then the commands of the README.
# Arguments: way, tests (a regular expression of ctest's, "all" or "none"). What happened goes line by line into
# /results/steps, as "step status seconds", and the words of the commands into /results/STEP.log.
set -uo pipefail
export LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive

way=$1 tests=$2
tree=/srv/slope
runner=()

# step NAME COMMAND...: its log, status and seconds
step() {
  local name=$1 began=$SECONDS status=0
  shift
  "$@" >"/results/$name.log" 2>&1 </dev/null || status=$?
  echo "$name $status $((SECONDS - began))" >>/results/steps
  return "$status"
}

install() { apt-get -qq update && apt-get -qq -y -o Dpkg::Use-Pty=0 --no-install-recommends install "$@"; }

readme_commands() {
  local began
  cd "$tree" || return 1
  began=$(date +%s)
  step demo "${runner[@]}" tools/demo.sh || return 1
  # the source of LAMMPS is put there at the end of set-up
  echo "set-up 0 $(($(stat -c %Y .lammps) - began))" >>/results/steps
  step report test -s build/demo/report.html
  case $tests in
    none) ;;
    short) step tests "${runner[@]}" tests/run.sh ;;
    all) step tests "${runner[@]}" tests/run.sh --all ;;
    *) step tests "${runner[@]}" tests/run.sh -R "$tests" ;;
  esac
}

# build/: a .deb and a .tar.gz, to be installed on another machine
packages() {
  step cpack "${runner[@]}" cmake --build "$tree/build" --target package && cp "$tree"/build/slope-*.{deb,tar.gz} /results/
}

# the demo's case with what was installed: lmp, slope and dump2vtk as the arguments name them
installed_commands() {
  local lmp=$1 slope=$2 dump2vtk=$3 inputs=$4
  mkdir -p /root/case && cd /root/case || return 1
  cp -r "$inputs/20_embankment" . && cd 20_embankment || return 1
  step demo "$slope" study in.embankment --set d=2.5 --set rolling=0,0.05,0.10 --road road.csv --local -o out &&
    step report "$slope" report out --reference reference.yaml --pictures &&
    step ranks env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
      mpirun -np 2 --bind-to none "$lmp" -in in.embankment -var d 4 -var duration 1 -var rolling 0.05 &&
    step film "$dump2vtk" embankment.*.dump --deposit embankment -o film && [[ -s out/report.html && -s film.pvd ]]
}

case $way in
  bare) ;;
  user)
    step given install sudo || exit 1
    useradd --create-home --shell /bin/bash somebody
    echo "somebody ALL=(ALL) NOPASSWD: ALL" >/etc/sudoers.d/somebody
    chown -R somebody: "$tree"
    [[ -z ${CCACHE_DIR:-} ]] || chown -R somebody: "$CCACHE_DIR"
    runner=(runuser -u somebody -- env HOME=/home/somebody) ;;
  paraview) step given install paraview python3-paraview || exit 1 ;;
  yade) step given install yade || exit 1 ;;
  deb)
    step given install /packages/slope-*.deb || exit 1
    installed_commands slope-lmp slope dump2vtk /opt/slope/share/slope/inputs
    exit ;;
  tar)
    tar -xzf /packages/slope-*.tar.gz -C /root || exit 1
    at=$(echo /root/slope-*)
    # shellcheck disable=SC2046 # words
    step given install $(cat "$at/share/slope/needs.txt") || exit 1
    installed_commands "$at/bin/lmp" "$at/bin/slope" "$at/bin/dump2vtk" "$at/share/slope/inputs"
    exit ;;
esac
if [[ -n ${CCACHE_DIR:-} ]]; then # headers that are compiled ahead are told apart by what is in them
  step ccache install ccache || exit 1
  export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache CXXFLAGS=-fpch-preprocess
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime CCACHE_MAXSIZE=2G
fi
readme_commands
if [[ $way == bare && -x $tree/build/lmp ]]; then packages; fi
